"""Run one exploration mission in simulation and say how it went."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.align.turned import turned
from vedette.domains.mapping.leftovers import Leftover
from vedette.kernels.motion import remaining
from vedette.maps.world import World
from vedette.outcome import Outcome
from vedette.record.explore.frames import FramesFound
from vedette.record.explore.log import Ahead, ExploreSnapshot, RobotSample
from vedette.record.explore.observer import ExploreObserver, ExploreReport
from vedette.record.explore.views import GroundFigures, RobotView, held, left_out
from vedette.record.log import Sink
from vedette.sim.explore.frames import FrameWatch
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.framed import FramedRobots
from vedette.sim.starts import choose_starts
from vedette.sim.views import NOWHERE, figures, setting, state
from vedette.sim.watched import Watched
from vedette.team import PlatformSpec, check_team


def prepare(world: World, specs: Sequence[PlatformSpec], setup: ExploreSetup) -> ExploreSimulation:
    """Put a team at its starts, as `placed` chooses them."""
    return ExploreSimulation(world, *placed(world, specs, setup), setup)


def placed(
    world: World, specs: Sequence[PlatformSpec], setup: ExploreSetup
) -> tuple[tuple[PlatformSpec, ...], NDArray[np.float64]]:
    """Return a team with its starts, those that are not given chosen by the seed.

    Raises:
        InputError: nobody is in the team, or two of one name; a start is not possible, the team does not fit;
            the planner or the fusion is unknown; or a robot is to die that there is not.
    """
    specs = check_team(specs)
    setup.check_team(len(specs))
    area = setup.options.lattice_on(world.frame).area
    return specs, choose_starts(world, specs, np.random.default_rng([setup.seed, 1]), area)


class ExploreRun(Watched[ExploreReport]):
    """One exploration, measured as often as its map's size allows."""

    def __init__(
        self,
        simulation: ExploreSimulation,
        sinks: Sequence[Sink[ExploreSnapshot]] = (),
        *,
        curves_only: bool = False,
    ) -> None:
        """Prepare a mission that has not begun; ``sinks`` follow it; ``curves_only``: no map is kept."""
        super().__init__(simulation)
        self.simulation = simulation
        self._curves_only = curves_only
        self._observer = observer_of(simulation, sinks, curves_only=curves_only)
        self._frames = _watch(simulation)
        self._next_look = 0.0  # [s]

    def _look(self) -> None:
        now = self.simulation.now
        if now >= self._next_look - 1e-9:
            self._observer.frames = self._frames_found()
            seen = views(self.simulation, ways=not self._curves_only)
            self._observer.look(now, seen, self.simulation.network.links())
            self._next_look += self._observer.period

    def _frames_found(self, *, last: bool = False) -> FramesFound | None:
        return None if self._frames is None else self._frames.look(last=last)

    def _report(self, outcome: Outcome) -> ExploreReport:
        now = self.simulation.now
        self._observer.frames = self._frames_found(last=True) or self._observer.frames
        self._observer.finish(now, views(self.simulation), self.simulation.network.links())
        return self._observer.report(outcome, self.simulation.clock.timing(now))


def _watch(simulation: ExploreSimulation) -> FrameWatch | None:
    """Return who watches how frames are found; None: all share one."""
    robots = simulation.robots
    if not isinstance(robots, FramedRobots):
        return None
    return FrameWatch(simulation, [spec.name for spec in simulation.specs], robots.frames)


def explore(
    simulation: ExploreSimulation, sinks: Sequence[Sink[ExploreSnapshot]] = (), *, curves_only: bool = False
) -> ExploreReport:
    """Run a mission to its end; ``sinks`` follow it, and Ctrl-C ends it in good order.

    ``curves_only``: the report's log holds curves and no maps, which takes less time.
    """
    return ExploreRun(simulation, sinks, curves_only=curves_only).run()


def observer_of(
    simulation: ExploreSimulation, sinks: Sequence[Sink[ExploreSnapshot]] = (), *, curves_only: bool = False
) -> ExploreObserver:
    """Return an observer of a simulated mission that has not begun."""
    setup = simulation.setup
    team = simulation.world, simulation.specs, simulation.starts
    shared = setup.frames == "known"
    lattice = simulation.lattice if shared else None  # of the world, which the robots' own are laid on
    return ExploreObserver(*team, setup.options, setting(setup), sinks, lattice, curves_only=curves_only)


def views(simulation: ExploreSimulation, *, ways: bool = True) -> list[RobotView]:
    """Return what can be told of every simulated robot now; without ``ways``, not where it goes."""
    return [_view(simulation, i, ways) for i in range(len(simulation.specs))]


def _view(simulation: ExploreSimulation, i: int, ways: bool) -> RobotView:
    mission, bodies, sample = simulation.missions[i], simulation.robots.bodies, _sample(simulation, i, ways)
    frame = mission.frame.window(*mission.known)
    classes, seen = held(mission.fusion.classes, mission.own.log_odds, mission.known)
    impact = simulation.promised(i)
    if isinstance(simulation.robots, FramedRobots):
        back, world = simulation.robots.frames[i].inverse(), simulation.world.frame
        classes, seen = turned(classes, frame, back, world), turned(seen, frame, back, world)
        frame, impact = world, None
    return RobotView(
        sample,
        frame,
        classes,
        seen,
        impact,
        GroundFigures(
            **vars(figures(simulation, i, float(bodies.travelled[i]))),
            collisions=int(bodies.collisions[i]),
            min_clearance_m=float(bodies.min_clearance[i]),
            pose_error_m=float(simulation.robots.pose_errors[i]),
        ),
        mission.fusion.digest,
        left_out(_left_in_world(simulation, i, mission.left_out), sample.name),
        mission.frontiers,
        mission.own.beyond,
        simulation.network.agents[i].ending is Outcome.SPENT,
    )


def _in_world(simulation: ExploreSimulation, i: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points ``(n, 2)`` of a robot's own frame as they lie in the world."""
    robots = simulation.robots
    return robots.frames[i].places(points) if isinstance(robots, FramedRobots) else points


def _left_in_world(simulation: ExploreSimulation, i: int, left: Sequence[Leftover]) -> list[Leftover]:
    if not isinstance(simulation.robots, FramedRobots) or not left:
        return list(left)
    places = _in_world(simulation, i, np.array([(spot.x, spot.y) for spot in left])).tolist()
    return [replace(spot, x=x, y=y) for spot, (x, y) in zip(left, places, strict=True)]


def _sample(simulation: ExploreSimulation, i: int, ways: bool) -> RobotSample:
    x, y, heading = simulation.pose(i)
    alive = bool(simulation.robots.alive[i])
    wanted = simulation.drivers[i].wanted if alive and ways else None
    path = NOWHERE
    if wanted is not None:
        path = remaining(_in_world(simulation, i, wanted.path), x, y, np.inf)
    goal = (float(path[-1, 0]), float(path[-1, 1])) if len(path) else None
    name = simulation.specs[i].name
    stops = simulation.missions[i].ahead(simulation.now) if alive and ways else ()
    places = _in_world(simulation, i, np.array([stop[:2] for stop in stops]).reshape(-1, 2)).tolist()
    tour = tuple(
        Ahead(x, y, after, reveals) for (x, y), (_, _, after, reveals) in zip(places, stops, strict=True)
    )
    budget = simulation.missions[i].platform.budget
    return RobotSample(
        *(x, y, heading, state(simulation, i), alive, path, name, goal),
        tour=tour,
        way_left=budget.left if budget.limited else None,
        orders=tuple(simulation.as_meant(given.order) for given in simulation.network.agents[i].orders.all),
    )
