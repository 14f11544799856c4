"""Targets that are whole agents on real missions, caught in the middle of a round."""

from __future__ import annotations

import heapq
import itertools
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from tests.fuzz.keep import Kept
from tests.fuzz.scripts import Script, Stage, Told, scripted
from tests.fuzz.target import Target
from tests.support.agent_team import Post, nested_kind
from tests.support.search_missions import case
from tests.support.small_missions import robots as equal_robots
from tests.support.small_missions import small_maze
from tests.support.track_scenes import scenario
from vedette.agent import Agent, step
from vedette.agent import messages as wire
from vedette.agent.effects import Drive, Effect, Fly, Job, Send, TrafficKind
from vedette.agent.events import Event, JobDone, Message, Pose, TreeChanged
from vedette.sim.explore.run import prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.search.simulation import SearchSetup, SearchSimulation
from vedette.sim.simulation import Simulation
from vedette.sim.track.simulation import TrackSetup, TrackSimulation

PARENTS = (None, 0, 0, 1)
CAUGHT = (0, 1)  # the root, and one with a parent and a child
BEGIN, END = 3.0, 9.0  # of what is caught [s]
DELAY = 0.03  # of links and jobs [s]
TICK = 0.1  # [s]
MOST_SCENES = 2  # before messages of a kind from a sender
AFTER = 8  # poses after a script
NOT_STATE = frozenset({
    "dropped", "dropped_of", "answers",  # mere counts
    "silences",  # that a neighbour has said something, whatever it is
})  # fmt: skip


@dataclass(eq=False)
class Caught:
    """An agent at a time."""

    agent: Agent
    now: float
    pending: list[Job] = field(default_factory=list)


def _stage(make: Callable[[], Simulation]) -> Stage:
    """Run a mission on a fixed tree; catch the root and an inner robot before messages of every kind."""
    simulation = make()
    agents, robots = simulation.agents, simulation.field
    scenes: list[Kept] = []
    scripts: list[Script] = []
    met: Counter[tuple[int, str, int]] = Counter()
    due: list[tuple[float, int, int, Event]] = []  # time, number, robot, what it is told
    numbers = itertools.count()

    def tell(i: int, events: list[Event], now: float) -> None:
        for effect in step(agents[i], events, now):
            match effect:
                case Send(to, _, payload):
                    heapq.heappush(due, (now + DELAY, next(numbers), to, Message(i, payload)))
                case Job(key, run):
                    run()
                    heapq.heappush(due, (now + DELAY, next(numbers), i, JobDone(key)))
                case Drive() | Fly():
                    robots.carry_out(i, effect, now)

    def catch(i: int, message: Message, now: float) -> None:
        post = Post(now, message.sender, i, TrafficKind.BEACONS, wire.decode(message.payload))
        kind = i, nested_kind(post), message.sender
        met[kind] += now >= BEGIN
        if i in CAUGHT and 0 < met[kind] <= MOST_SCENES:
            scripts.append(Script(len(scenes), (Told(message.sender, message.payload),)))
            scenes.append(Kept(Caught(agents[i], now)))

    for i, parent in enumerate(PARENTS):
        near = [k for k in range(len(PARENTS)) if k == parent or PARENTS[k] == i]
        tell(i, [TreeChanged(1, parent, tuple(near), len(PARENTS))], 0.0)
    for tick in range(round(END / TICK)):
        for i in range(len(agents)):
            tell(i, robots.sense(i, TICK * tick), TICK * tick)
        while due and due[0][0] < TICK * (tick + 1):
            now, _, i, event = heapq.heappop(due)
            if isinstance(event, Message):
                catch(i, event, now)
            tell(i, [event], now)
        robots.advance(TICK * (tick + 1), TICK)
    return Stage(scenes, scripts)


def _ready(caught: Caught) -> None:
    _carry_out(caught, step(caught.agent, [], caught.now))


def _hear(caught: Caught, sender: int, payload: bytes) -> bool:
    """Take in a message; tell whether it was dropped."""
    before = caught.agent.dropped
    _carry_out(caught, step(caught.agent, [Message(sender, payload)], caught.now))
    return caught.agent.dropped > before


def _wait_no_longer(caught: Caught, sender: int) -> None:
    """Do what is done with a neighbour whose word in a round makes no sense: it goes on without."""
    if caught.agent.rounds.round is not None:
        caught.agent.rounds.round.spoilt.add(sender)
    _ready(caught)


def _carry_out(caught: Caught, effects: list[Effect]) -> None:
    caught.pending += [effect for effect in effects if isinstance(effect, Job)]


def _go_on(caught: Caught) -> None:
    """Let jobs run and time pass."""
    agent = caught.agent
    for _ in range(AFTER):
        caught.now += 0.25
        jobs, caught.pending = caught.pending, []
        for job in jobs:
            job.run()
            _carry_out(caught, step(agent, [JobDone(job.key)], caught.now))
        pose = agent.pose
        assert pose is not None
        _carry_out(caught, step(agent, [Pose(pose.x, pose.y, pose.heading, pose.slowed)], caught.now))


def explore(**setup: Any) -> Simulation:
    """A team of four in a small maze."""
    return prepare(
        small_maze(), equal_robots(len(PARENTS), range=4.0, beams=90), ExploreSetup(max_time=60.0, **setup)
    )


def _search(**setup: Any) -> Simulation:
    vehicles = [
        {"start": [200 + 80 * i, 100, 60], "speed": 30, "turn_rate": 0.4} for i in range(len(PARENTS))
    ]
    return SearchSimulation(case(vehicles=vehicles, horizon=8), SearchSetup(max_time=60.0, **setup))


def _track(**setup: Any) -> Simulation:
    sensor = {"type": "range-bearing", "range": 120, "view": 180, "range_noise": 5, "bearing_noise": 3}
    vehicles = [
        {"start": [40 + 30 * i, 40, 45], "speed": 18, "turn_rate": 0.4, "sensor": sensor}
        for i in range(len(PARENTS))
    ]
    return TrackSimulation(scenario(vehicles=vehicles, horizon=8), TrackSetup(max_time=60.0, **setup))


def agents() -> list[Target]:
    """Return them all."""
    makers: dict[str, Callable[[], Simulation]] = {
        "agent-explore": explore,
        "agent-explore-jacobi-channel": partial(explore, scheme="jacobi", fusion="channel"),
        "agent-search": _search,
        "agent-search-sums": partial(_search, fusion="sums"),
        "agent-track": _track,
        "agent-track-channel": partial(_track, fusion="channel", scheme="jacobi"),
    }
    return [
        scripted(name, partial(_stage, make), _hear, _go_on, NOT_STATE, _ready, _wait_no_longer)
        for name, make in makers.items()
    ]
