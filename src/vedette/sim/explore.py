"""Run one exploration mission in simulation and say how it went."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent
from vedette.agent.driving import remaining
from vedette.domains.mapping.belief import LN2, planning_factor
from vedette.domains.mapping.impact import final_miss
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.record.log import RobotSample, RunLog, Sink, Snapshot
from vedette.record.summary import Outcome, Summary, Timing
from vedette.sim.exploration import ExploreSetup, ExploreSimulation
from vedette.sim.figures import negotiated, timing, traffic
from vedette.sim.score import Progress, Reference, coverage, map_errors, overlap
from vedette.sim.starts import choose_starts
from vedette.sim.world import World
from vedette.team import PlatformSpec


@dataclass(frozen=True, eq=False)
class Report:
    """What a mission leaves: its figures, its log, and the map that a living robot holds."""

    summary: Summary
    timing: Timing
    log: RunLog
    classes: NDArray[np.uint8]  # (R, C) team map


def planning_frame(world: World) -> GridFrame:
    """Return the frame of the planning cells over a world."""
    return world.frame.coarse(planning_factor(world.frame.resolution))


def prepare(world: World, specs: Sequence[PlatformSpec], setup: ExploreSetup) -> ExploreSimulation:
    """Put a team at its starts, those that are not given chosen by the seed.

    Raises:
        InputError: a start is not possible, the team does not fit, or the planner is unknown.
    """
    starts = choose_starts(world, specs, np.random.default_rng([setup.seed, 1]))
    return ExploreSimulation(world, specs, starts, setup)


def explore(simulation: ExploreSimulation, sinks: Sequence[Sink] = ()) -> Report:
    """Run a mission to its end; ``sinks`` follow it, and Ctrl-C ends it in good order."""
    reference = Reference(simulation.world, simulation.specs, simulation.starts)
    observer = Observer(simulation, reference, sinks)
    simulation.clock.start()
    outcome = simulation.run(observer.look, observer.period)
    observer.finish()
    return Report(observer.summary(outcome), timing(simulation), observer.log, observer.delivered_map())


class Observer:
    """Looks at a simulation from outside: it knows the truth, the agents do not."""

    def __init__(self, simulation: ExploreSimulation, reference: Reference, sinks: Sequence[Sink]) -> None:
        self._simulation = simulation
        self._reference = reference
        self._progress = Progress()
        world = simulation.world
        self.period = 0.5 if world.frame.size <= 1_000_000 else 2.0  # of looking [s]
        self.log = RunLog(world.name, world.frame, planning_frame(world), simulation.specs, sinks)
        self._looks = 0
        self._logged = -1.0  # time of the last snapshot [s]

    def look(self) -> None:
        """Measure the mission, and log every second look."""
        self._measure(log=self._looks % 2 == 0)
        self._looks += 1

    def finish(self) -> None:
        """Measure and log how the mission ended."""
        self._measure(log=True)

    def _measure(self, log: bool) -> None:
        classes = self._union()
        share = coverage(self._reference, classes)
        now = self._simulation.now
        self._progress.add(now, share)
        if log and now > self._logged:
            self.log.add(self._snapshot(classes, share))
            self._logged = now

    def _union(self) -> NDArray[np.uint8]:
        """What the living robots know together, whether or not they have told each other; if none lives, all.

        That is what they saw themselves, and what they hold from the dead.
        """
        living, missions = self._simulation.living, self._simulation.missions
        log_odds = np.zeros(self._simulation.world.frame.shape, np.int16)
        seen = np.zeros(log_odds.shape, bool)
        for i in living or range(len(missions)):
            own = missions[i].log_odds
            log_odds += own
            seen |= own != 0
        known = np.where(log_odds < 0, FREE, OCCUPIED).astype(np.uint8)
        known[~seen] = UNKNOWN
        if len(living) < len(missions):
            for i in living:
                np.copyto(known, missions[i].fusion.classes, where=known == UNKNOWN)
        return known

    def _snapshot(self, classes: NDArray[np.uint8], share: float) -> Snapshot:
        unknown = int(np.count_nonzero(classes == UNKNOWN))
        return Snapshot(
            t=self._simulation.now,
            robots=tuple(self._robot(i, agent) for i, agent in enumerate(self._simulation.agents)),
            coverage=share,
            known_fraction=1.0 - unknown / classes.size,
            entropy=unknown * LN2,
            classes=classes,
            impact=self._team_impact(),
        )

    def _robot(self, i: int, agent: Agent) -> RobotSample:
        x, y, heading = self._simulation.pose(i)
        alive = bool(self._simulation.robots.alive[i])
        wanted = self._simulation.drivers[i].wanted if alive else None
        path = np.empty((0, 2)) if wanted is None else remaining(wanted.path, x, y, np.inf)
        goal = (float(path[-1, 0]), float(path[-1, 1])) if len(path) else None
        state = agent.state.value if alive else "dead"
        return RobotSample(self._simulation.specs[i].name, x, y, heading, state, goal, path, alive)

    def _team_impact(self) -> NDArray[np.float32]:
        """Probability that the strategies decided on last will observe each planning cell."""
        frame = self.log.planning
        miss = np.ones(frame.size, np.float32)
        for i in self._simulation.living:
            decided = self._simulation.agents[i].rounds.impact
            if decided is not None and len(decided.keys):
                miss *= final_miss(decided, frame.size)
        return (1.0 - miss).reshape(frame.shape)

    def delivered_map(self) -> NDArray[np.uint8]:
        """Return the team map as the first living robot holds it; what all saw, if none lives."""
        living = self._simulation.living
        return self._simulation.missions[living[0]].fusion.classes.copy() if living else self._union()

    def summary(self, outcome: Outcome) -> Summary:
        """Return the figures of the mission, in simulated time."""
        simulation, progress = self._simulation, self._progress
        names = [spec.name for spec in simulation.specs]
        wrong, known = map_errors(simulation.world, self.delivered_map())
        rounds = negotiated(simulation)
        return Summary(
            completed=outcome is Outcome.COMPLETE,
            outcome=outcome,
            seed=simulation.setup.seed,
            robots=len(names),
            planner=simulation.setup.planner,
            scheme=simulation.setup.scheme,
            fusion=simulation.setup.fusion,
            world=simulation.world.name,
            time_s=simulation.now,
            t50_s=progress.t_at(0.50),
            t90_s=progress.t_at(0.90),
            t95_s=progress.t_at(0.95),
            t99_s=progress.t_at(0.99),
            auc_s=progress.auc(simulation.now),
            coverage=progress.coverages[-1],
            map_errors=wrong,
            map_error_share=wrong / known if known else 0.0,
            path_m=dict(zip(names, simulation.robots.bodies.travelled.tolist(), strict=True)),
            overlap=overlap([simulation.missions[i].log_odds != 0 for i in range(len(names))]),
            collisions=simulation.robots.bodies.collisions,
            min_clearance_m=simulation.robots.bodies.min_clearance,
            rounds=rounds.rounds,
            sweeps=rounds.sweeps,
            bound_ratio=rounds.bound_ratio,
            messages=traffic(names, simulation.links.messages_sent),
            bytes=traffic(names, simulation.links.bytes_sent),
        )
