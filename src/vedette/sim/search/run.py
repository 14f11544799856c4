"""Run one search in simulation and say how it went."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vedette.agent import FlightBehaviour
from vedette.agent.body import TICK
from vedette.domains.search.bounds import sweep_width
from vedette.kernels.search import propagate
from vedette.missions.search.case import SearchCase
from vedette.outcome import Outcome
from vedette.record.figures import Negotiated, RoundFigures, traffic
from vedette.record.search.curves import Curves
from vedette.record.search.log import Floats, Scene, SearchLog, SearchSink, SearchSnapshot, VehicleSample
from vedette.record.search.summary import Best, Quality, SearchOutcome, SearchSummary
from vedette.record.summary import Timing
from vedette.sim.search.curves import ideal, missed
from vedette.sim.search.simulation import SearchSimulation


@dataclass(frozen=True, eq=False)
class SearchReport:
    """What a search leaves: its figures, its log and its curves."""

    summary: SearchSummary
    timing: Timing
    log: SearchLog
    curves: Curves


def search(simulation: SearchSimulation, sinks: Sequence[SearchSink] = ()) -> SearchReport:
    """Run a search to its end; ``sinks`` follow it, and ``simulation.stop`` ends it in good order."""
    observer = Observer(simulation, sinks)
    simulation.clock.start()
    outcome = simulation.run(observer.look, TICK)
    observer.finish()
    curves = ideal_curves(simulation.case, simulation.steps)
    timing = simulation.clock.timing(simulation.now)
    return SearchReport(observer.summary(outcome, curves), timing, observer.log, curves)


def ideal_curves(case: SearchCase, steps: int) -> Curves:
    """Return what is known of a search before it is made."""
    best = ideal(case, steps)
    times = np.arange(steps + 1, dtype=np.float64) * case.scenario.step
    return Curves(times, best.bound, best.koopman)


class Observer:
    """Looks at a simulation from outside: it knows the truth, the agents do not."""

    def __init__(self, simulation: SearchSimulation, sinks: Sequence[SearchSink]) -> None:
        self._simulation = simulation
        self._next = 0  # step to log
        self._left = simulation.case.pdf.mass  # probability by cell that no look has taken away
        self.log = SearchLog(scene_of(simulation), sinks)

    def look(self) -> None:
        """Log a step at its last tick, when its evidence has had the most time to go round."""
        if self._simulation.now >= (self._next + 1) * self._simulation.plan.prior.dt - TICK - 1e-6:
            self._log()

    def finish(self) -> None:
        """Log the step in which the search ended."""
        if self._simulation.now >= self._next * self._simulation.plan.prior.dt - 1e-6:
            self._log()

    def _log(self) -> None:
        simulation, step = self._simulation, self._next
        pdf = simulation.case.pdf
        if step > 0:
            moved, looks = propagate(self._left, pdf.stencil), simulation.vehicles.looks
            self._left = missed(moved, pdf, simulation.case.detectors, looks, step)
        holder = simulation.missions[simulation.living[0] if simulation.living else 0]
        known = holder.pdf(step)
        x, y = simulation.hidden.at(step).tolist()
        self.log.add(
            SearchSnapshot(
                t=step * pdf.dt,
                vehicles=tuple(self._vehicle(i, step) for i in range(len(simulation.missions))),
                mass=known.mass.astype(np.float32),
                entropy=known.entropy,
                detection=1.0 - float(self._left.sum()),
                target=(x, y),
            )
        )
        self._next += 1

    def _vehicle(self, i: int, step: int) -> VehicleSample:
        simulation = self._simulation
        alive = bool(simulation.vehicles.alive[i])
        looks = simulation.vehicles.looks[i].get(step)
        pose = looks[-1] if looks is not None else np.array(simulation.pose(i))
        behaviour = simulation.agents[i].behaviour
        assert isinstance(behaviour, FlightBehaviour)
        path = self._ahead(i, step, pose, behaviour) if alive else np.empty((0, 2))
        strategy = simulation.missions[i].strategy
        goal = strategy.goal if alive and strategy is not None else None
        x, y, heading = pose.tolist()
        return VehicleSample(x, y, heading, behaviour.state.value if alive else "dead", alive, path, goal)

    def _ahead(self, i: int, step: int, pose: Floats, behaviour: FlightBehaviour) -> Floats:
        """Return where the flight takes a vehicle as far as it is planned, in half steps."""
        scenario, begin = self._simulation.case.scenario, step * self._simulation.plan.prior.dt
        end = max(
            (plan.start + plan.step * len(plan.turn_rates) for plan in behaviour.flight.plans), default=begin
        )
        times = np.arange(begin, max(end, begin) + 1e-6, 0.5 * scenario.step)
        ways = [behaviour.flight.fly(pose, scenario.vehicles[i].speed, begin, time)[:2] for time in times]
        return np.array(ways)

    def summary(self, outcome: Outcome, curves: Curves) -> SearchSummary:
        """Return the figures of the search, in simulated time."""
        simulation, setup, names = self._simulation, self._simulation.setup, self._simulation.names
        rounds = Negotiated.by([RoundFigures.of(agent.rounds) for agent in simulation.agents])
        last = self.log.snapshots[-1]
        found = simulation.declared
        place = None if found is None else (found[1].x, found[1].y)
        error = None if place is None else float(np.hypot(*np.subtract(place, last.target)))
        ended = ended_as(simulation, outcome)
        right = found is not None and ended is SearchOutcome.FOUND
        return SearchSummary(
            completed=right,
            outcome=ended,
            seed=setup.seed,
            scenario=simulation.case.name,
            coordination=setup.coordination,
            scheme=setup.scheme,
            fusion=setup.fusion,
            worth=simulation.case.scenario.worth,
            radio=None if setup.radio is None else str(setup.radio),
            faults=setup.faults_from,
            vehicles=len(names),
            time_s=simulation.now,
            found_s=found[1].time if right and found else None,
            found_by=names[found[0]] if right and found else None,
            declared_m=place,
            target_m=last.target,
            error_m=error,
            detection_then=last.detection,
            duration_s=float(curves.times[-1]),
            quality=None,
            counted=None,
            bound=_best(curves.times, curves.bound),
            koopman=_best(curves.times, curves.koopman),
            path_m=dict(zip(names, simulation.vehicles.travelled.tolist(), strict=True)),
            rounds=rounds.rounds,
            sweeps=rounds.sweeps,
            bound_ratio=rounds.bound_ratio,
            messages=traffic(names, simulation.network.messages_sent),
            bytes=traffic(names, simulation.network.bytes_sent),
            comparison={},
        )


def ended_as(simulation: SearchSimulation, outcome: Outcome) -> SearchOutcome:
    """Return how a search ended: a declared place is right if the target is within the scenario's radius.

    A detection that cannot be a false alarm is always right.
    """
    if simulation.declared is None or outcome is not Outcome.COMPLETE:
        return SearchOutcome(outcome.value)
    found = simulation.declared[1]
    x, y = simulation.hidden.at(simulation.plan.step(found.time)).tolist()
    near = np.hypot(found.x - x, found.y - y) <= simulation.plan.radius
    return SearchOutcome.FOUND if found.certain or near else SearchOutcome.MISTAKEN


def scene_of(simulation: SearchSimulation) -> Scene:
    """Return what stays the same all through a search."""
    case = simulation.case
    speeds = [vehicle.speed for vehicle in case.scenario.vehicles]
    widths = [
        sweep_width(detector, speed, case.scenario.step / case.looks(i))
        for i, (detector, speed) in enumerate(zip(case.detectors, speeds, strict=True))
    ]
    return Scene(
        name=case.name,
        frame=case.pdf.frame,
        vehicles=tuple(case.names),
        ranges=tuple(detector.range for detector in case.detectors),
        widths=tuple(widths),
        duration=simulation.setup.max_time,
        dt=case.scenario.step,
    )


def _best(times: Floats, detection: Floats) -> Best:
    quality = Quality.of(times, detection)
    return Best(quality.detection, quality.mean_time_s)
