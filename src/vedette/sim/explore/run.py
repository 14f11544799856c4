"""Run one exploration mission in simulation and say how it went."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vedette.agent.driving import remaining
from vedette.maps.world import World
from vedette.record.explore.log import RobotSample, Sink
from vedette.record.explore.observer import ExploreObserver, ExploreReport
from vedette.record.explore.views import RobotFigures, RobotView, Setting, held_map
from vedette.record.figures import RoundFigures, traffic_of
from vedette.record.summary import Traffic
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.starts import choose_starts
from vedette.team import PlatformSpec


def prepare(world: World, specs: Sequence[PlatformSpec], setup: ExploreSetup) -> ExploreSimulation:
    """Put a team at its starts, those that are not given chosen by the seed.

    Raises:
        InputError: a start is not possible, the team does not fit, or the planner is unknown.
    """
    starts = choose_starts(world, specs, np.random.default_rng([setup.seed, 1]))
    return ExploreSimulation(world, specs, starts, setup)


def explore(simulation: ExploreSimulation, sinks: Sequence[Sink] = ()) -> ExploreReport:
    """Run a mission to its end; ``sinks`` follow it, and Ctrl-C ends it in good order."""
    observer = observer_of(simulation, sinks)
    simulation.clock.start()
    outcome = simulation.run(
        lambda: observer.look(simulation.now, views(simulation), simulation.network.links()), observer.period
    )
    observer.finish(simulation.now, views(simulation), simulation.network.links())
    return observer.report(outcome, simulation.clock.timing(simulation.now))


def observer_of(simulation: ExploreSimulation, sinks: Sequence[Sink] = ()) -> ExploreObserver:
    """Return an observer of a simulated mission that has not begun."""
    setup = simulation.setup
    setting = Setting(
        setup.seed,
        setup.planner,
        setup.options.negotiates_by,
        setup.fusion,
        radio=None if setup.radio is None else str(setup.radio),
        faults=setup.faults_from,
    )
    return ExploreObserver(simulation.world, simulation.specs, simulation.starts, setting, sinks)


def views(simulation: ExploreSimulation) -> list[RobotView]:
    """Return what can be told of every simulated robot now."""
    network = simulation.network
    messages, size = network.messages_sent, network.bytes_sent
    return [
        _view(simulation, i, traffic_of(messages, i), traffic_of(size, i))
        for i in range(len(simulation.specs))
    ]


def _view(simulation: ExploreSimulation, i: int, messages: Traffic, size: Traffic) -> RobotView:
    mission, rounds = simulation.missions[i], simulation.network.agents[i].rounds
    bodies = simulation.robots.bodies
    return RobotView(
        _sample(simulation, i),
        held_map(mission.fusion.classes, mission.log_odds),
        mission.log_odds != 0,
        rounds.impact,
        RobotFigures(
            travelled_m=float(bodies.travelled[i]),
            collisions=int(bodies.collisions[i]),
            min_clearance_m=float(bodies.min_clearance[i]),
            rounds=RoundFigures.of(rounds),
            messages=messages,
            bytes=size,
        ),
    )


def _sample(simulation: ExploreSimulation, i: int) -> RobotSample:
    x, y, heading = simulation.pose(i)
    alive = bool(simulation.robots.alive[i])
    wanted = simulation.drivers[i].wanted if alive else None
    path = np.empty((0, 2)) if wanted is None else remaining(wanted.path, x, y, np.inf)
    goal = (float(path[-1, 0]), float(path[-1, 1])) if len(path) else None
    state = simulation.network.agents[i].state.value if alive else "dead"
    return RobotSample(simulation.specs[i].name, x, y, heading, state, goal, path, alive)
