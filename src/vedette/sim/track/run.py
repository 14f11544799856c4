"""Run one tracking mission in simulation, and others beside it, and say how they went."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from vedette.agent import FlightBehaviour
from vedette.agent.body import TICK
from vedette.domains.tracking.belief import Tracks
from vedette.domains.tracking.filter import nees, predict
from vedette.domains.tracking.sensors import SENSORS
from vedette.errors import InputError
from vedette.missions.track.options import COORDINATIONS
from vedette.missions.track.scenario import TrackScenario
from vedette.outcome import Outcome
from vedette.record.figures import Negotiated, RoundFigures, traffic
from vedette.record.summary import Timing
from vedette.record.track.log import Scene, TrackLog, TrackSink, TrackSnapshot, VehicleSample
from vedette.record.track.summary import (
    Quality,
    TrackSummary,
    dimensions,
    nees_band,
    squared_position_error,
)
from vedette.sim.track.simulation import TrackSetup, TrackSimulation, check_optimum


@dataclass(frozen=True, eq=False)
class TrackReport:
    """What a mission leaves: its figures and its log, and the logs of those it is compared with."""

    summary: TrackSummary
    timing: Timing
    log: TrackLog
    others: Mapping[str, TrackLog] = field(default_factory=dict)  # by coordination
    left_out: Mapping[str, str] = field(default_factory=dict)  # coordination: why it was not computed


def track(simulation: TrackSimulation, name: str, sinks: Sequence[TrackSink] = ()) -> TrackReport:
    """Run a mission to its end; ``sinks`` follow it, and ``simulation.stop`` ends it in good order."""
    observer = Observer(simulation, name, sinks)
    simulation.clock.start()
    outcome = simulation.run(observer.look, TICK)
    observer.finish()
    return TrackReport(observer.summary(outcome), simulation.clock.timing(simulation.now), observer.log)


def compared(
    report: TrackReport,
    scenario: TrackScenario,
    setup: TrackSetup,
    run: Callable[[TrackSimulation, str], TrackReport],
) -> TrackReport:
    """Return the report with the other ways of coordination beside it, on the same seed.

    The optimum is left out where it cannot be had. ``run(simulation, coordination)`` runs one of them; when
    one is interrupted, it and the rest are left out, and the mission as a whole counts as interrupted.
    """
    logs, left_out, outcome = {setup.coordination: report.log}, {}, report.summary.outcome
    for coordination in COORDINATIONS:
        other = replace(setup, coordination=coordination)
        if coordination == setup.coordination:
            continue
        if outcome is Outcome.INTERRUPTED:
            left_out[coordination] = "interrupted"
            continue
        try:
            if coordination == "optimum":
                check_optimum(scenario, other)
        except InputError as error:
            left_out[coordination] = str(error)
            continue
        ran = run(TrackSimulation(scenario, other), coordination)
        if ran.summary.outcome is Outcome.INTERRUPTED:
            outcome = Outcome.INTERRUPTED
            left_out[coordination] = "interrupted"
        else:
            logs[coordination] = ran.log
    comparison = {name: Quality.of(logs[name]) for name in COORDINATIONS if name in logs}
    completed = outcome is Outcome.COMPLETE
    summary = replace(report.summary, comparison=comparison, outcome=outcome, completed=completed)
    del logs[setup.coordination]
    return replace(report, summary=summary, others=logs, left_out=left_out)


class Observer:
    """Looks at a simulation from outside: it knows the truth, the agents do not."""

    def __init__(self, simulation: TrackSimulation, name: str, sinks: Sequence[TrackSink]) -> None:
        self._simulation = simulation
        self._next = 0  # step to log
        self.log = TrackLog(scene_of(simulation, name), sinks)

    def look(self) -> None:
        """Log a step at its last tick, when its evidence has had the most time to go round."""
        dt = self._simulation.scenario.step
        if self._simulation.now >= (self._next + 1) * dt - TICK - 1e-6:
            self._log()

    def finish(self) -> None:
        """Log at least one step, however soon the mission ended."""
        if not self.log.snapshots:
            self._log()

    def _log(self) -> None:
        self.log.add(self._snapshot(self._next))
        self._next += 1

    def _snapshot(self, step: int) -> TrackSnapshot:
        simulation = self._simulation
        holders = simulation.living or list(range(len(simulation.missions)))
        truth = simulation.targets.at(step)
        beliefs = [self._tracks(i, step) for i in holders]
        own = sum(model.d for model in beliefs[0].models)
        return TrackSnapshot(
            t=step * simulation.scenario.step,
            vehicles=tuple(self._vehicle(i, step) for i in range(len(simulation.missions))),
            holder=holders[0],
            truth=truth,
            means=beliefs[0].means,
            covariances=beliefs[0].covariances,
            entropy=float(np.mean([each.entropies.sum() for each in beliefs])),
            nees=float(np.mean([nees(each, truth).sum() / own for each in beliefs])),
            squared_error=float(np.mean([squared_position_error(each.means, truth) for each in beliefs])),
        )

    def _tracks(self, i: int, step: int) -> Tracks:
        known = self._simulation.missions[i].tracks()
        return predict(known, max(0, step - known.k0))

    def _vehicle(self, i: int, step: int) -> VehicleSample:
        simulation = self._simulation
        alive = bool(simulation.vehicles.alive[i])
        pose = simulation.targets.poses.get((step, i), np.array(simulation.pose(i)))
        behaviour = simulation.agents[i].behaviour
        assert isinstance(behaviour, FlightBehaviour)
        x, y, heading = pose.tolist()
        path = self._ahead(i, step, pose, behaviour) if alive else np.empty((0, 2))
        seen = simulation.targets.seen.get((step, i), ())
        return VehicleSample(x, y, heading, behaviour.state.value if alive else "dead", alive, path, seen)

    def _ahead(
        self,
        i: int,
        step: int,
        pose: np.ndarray[tuple[int], np.dtype[np.float64]],
        behaviour: FlightBehaviour,
    ) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        """Return where the flight takes a vehicle by the end of a plan that starts with the next step."""
        scenario = self._simulation.scenario
        ways = [pose]
        for k in range(step, step + scenario.horizon + 1):
            begin, end = k * scenario.step, (k + 1) * scenario.step
            ways.append(behaviour.flight.fly(ways[-1], scenario.vehicles[i].speed, begin, end))
        return np.array(ways)[:, :2]

    def summary(self, outcome: Outcome) -> TrackSummary:
        """Return the figures of the mission, in simulated time."""
        simulation, setup, names = self._simulation, self._simulation.setup, self._simulation.names
        rounds = Negotiated.by([RoundFigures.of(agent.rounds) for agent in simulation.agents])
        shares = self.log.in_view().tolist()
        return TrackSummary(
            completed=outcome is Outcome.COMPLETE,
            outcome=outcome,
            seed=setup.seed,
            scenario=self.log.scene.name,
            coordination=setup.coordination,
            scheme=setup.scheme,
            fusion=setup.fusion,
            objective=setup.objective or simulation.scenario.objective,
            continuous=setup.continuous,
            radio=None if setup.radio is None else str(setup.radio),
            faults=setup.faults_from,
            vehicles=len(names),
            targets=len(self.log.scene.targets),
            time_s=simulation.now,
            steps=len(self.log.snapshots),
            quality=Quality.of(self.log),
            nees_band=nees_band(dimensions(self.log)),
            in_view=dict(zip(self.log.scene.targets, shares, strict=True)),
            path_m=dict(zip(names, simulation.vehicles.travelled.tolist(), strict=True)),
            rounds=rounds.rounds,
            sweeps=rounds.sweeps,
            bound_ratio=rounds.bound_ratio,
            skipped=sum(mission.skipped for mission in simulation.missions),
            messages=traffic(names, simulation.network.messages_sent),
            bytes=traffic(names, simulation.network.bytes_sent),
            comparison={},
        )


def scene_of(simulation: TrackSimulation, name: str) -> Scene:
    """Return what stays the same all through a mission."""
    scenario, sensors = simulation.scenario, simulation.sensors
    kinds = {kind: word for word, kind in SENSORS.items()}
    return Scene(
        name=name,
        area=scenario.area,
        vehicles=tuple(simulation.names),
        ranges=tuple(sensor.range for sensor in sensors),
        views=tuple(sensor.view for sensor in sensors),
        sensors=tuple(kinds[type(sensor)] for sensor in sensors),
        targets=tuple(scenario.target_names),
        moving=tuple(model.d == 4 for model in simulation.prior.models),
        dt=scenario.step,
    )
