"""A network as robots have it: what links there are, with all that befalls them, and an overlay over them."""

from __future__ import annotations

import heapq
import itertools
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent, NetworkedAgent
from vedette.agent.effects import TrafficKind
from vedette.agent.events import Event, Pose, Scan, Sensed
from vedette.record.links import Link, links_of
from vedette.sim.datagrams import Datagrams
from vedette.sim.faults import Crashes, Freezes, Happening, Restarts, SkewedClock, Skews, Thaws, Timeline
from vedette.sim.field import Field
from vedette.sim.network import FIRST_BOOT, Act, Spawn

ROUNDING = 1e-7  # clocks round: a robot that wakes is never too early [s]
RADIO_PERIOD = 0.5  # links follow the robots so often [s]
BUFFER = 512  # datagrams that wait for a frozen robot

Live = Callable[[int, Agent, float, float], NetworkedAgent]
"""``live(i, agent, now, lease)``: the program of the i-th robot, at the time that its clock shows [s]."""

LossesNow = Callable[[], NDArray[np.float64]]
"""The links as they are now: ``(n, n)`` share of datagrams lost, 1 where there is no link."""


@dataclass(eq=False)
class _Robot:
    """One robot's program, and what it has sent in earlier lives."""

    life: NetworkedAgent
    boot: int
    clock: SkewedClock
    up: bool = True
    frozen: bool = False
    inbox: deque[tuple[int, bytes]] = field(default_factory=lambda: deque(maxlen=BUFFER))
    sensed: list[Event] = field(default_factory=list)  # while it could not take it in
    scheduled: float = float("inf")  # its next waking [s]
    peers: tuple[int, ...] = ()

    @property
    def runs(self) -> bool:
        """Tell whether the program can do anything now."""
        return self.up and not self.frozen


class OverlaidNetwork:
    """Everybody keeps up the tree over datagrams that may get lost; ``vedette.sim.network.Network``."""

    def __init__(
        self,
        spawn: Spawn,
        field: Field,
        datagrams: Datagrams,
        *,
        timeline: Timeline | None = None,
        losses: LossesNow | None = None,
        lease: float = 3.0,
        live: Live | None = None,
    ) -> None:
        """Bring the robots of a field to life.

        Args:
            spawn: makes agents.
            field: in which a robot whose program ends stands still.
            datagrams: what carries them; everybody reaches whom it links.
            timeline: of faults.
            losses: the links, which follow the robots; None: as they are.
            lease: after which a silent neighbour is given up [s].
            live: what runs a robot's agent; None: the program itself, and not a test's double of it.
        """
        self._spawn, self._field, self._datagrams = spawn, field, datagrams
        self._timeline, self._losses, self._lease = timeline, losses, lease
        self._live = live or self._program
        n = len(field.alive)
        self._earlier = {
            kind: ([0] * n, [0] * n) for kind in TrafficKind
        }  # messages, bytes of lives that are over
        self._queue: list[tuple[float, int, int]] = []  # wakings: time, number, robot
        self._count = itertools.count()
        self._radio_due, self._now = 0.0, 0.0
        self._begun = [] if timeline is None else timeline.advance(0.0)  # what befalls robots at once
        skews = {each.robot: each for each in self._skews()}
        slowest = min(0.0, *(each.s for each in skews.values())) if skews else 0.0
        clocks = [SkewedClock(reading=-slowest)] * n  # only differences matter; none begins below zero
        for i, each in skews.items():
            clocks[i] = clocks[i].skewed(0.0, each.s, each.ppm)
        self._robots = [self._start(i, FIRST_BOOT, clock, 0.0) for i, clock in enumerate(clocks)]
        self._agents = [robot.life.agent for robot in self._robots]

    def _skews(self) -> list[Skews]:
        """Take the skews out of what befalls robots at once: clocks are wrong before anything starts."""
        skews = [each for each in self._begun if isinstance(each, Skews)]
        self._begun = [each for each in self._begun if not isinstance(each, Skews)]
        return skews

    # -- what it tells -----------------------------------------------------------------------------------

    @property
    def agents(self) -> Sequence[Agent]:
        """Everybody's agent, of its latest life."""
        return self._agents

    @property
    def messages_sent(self) -> Mapping[TrafficKind, Sequence[int]]:
        """By kind and robot, over all its lives."""
        return {
            kind: [
                past + robot.life.messages_sent[kind]
                for past, robot in zip(before, self._robots, strict=True)
            ]
            for kind, (before, _) in self._earlier.items()
        }

    @property
    def bytes_sent(self) -> Mapping[TrafficKind, Sequence[int]]:
        """By kind and robot, over all its lives."""
        return {
            kind: [
                past + robot.life.bytes_sent[kind] for past, robot in zip(before, self._robots, strict=True)
            ]
            for kind, (_, before) in self._earlier.items()
        }

    def links(self) -> tuple[Link, ...]:
        """Return the links that are up."""
        return links_of(
            [
                robot.life.overlay.status(robot.clock.shows(self._now)) if robot.up else None
                for robot in self._robots
            ]
        )

    # -- time ----------------------------------------------------------------------------------------

    def tick(self, now: float) -> Iterable[tuple[int, Act]]:
        """Let faults happen, and links follow the robots."""
        self._now = now
        if self._timeline is not None:
            happenings = self._begun + self._timeline.advance(now)
            self._begun = []
            self._datagrams.set_weather(self._timeline.weather)
            for happening in happenings:
                yield from self._befall(happening, now)
        if self._losses is not None and now >= self._radio_due - 1e-9:
            self._radio_due = now + RADIO_PERIOD
            self._datagrams.set_links(self._losses())
        for i, robot in enumerate(self._robots):
            if robot.runs and (peers := tuple(self._datagrams.reachable(i))) != robot.peers:
                robot.peers = peers
                yield i, self._act(i, partial(robot.life.peers, peers), now)

    def tell(self, i: int, events: Sequence[Event], now: float) -> Act:
        """Let a robot's agent take in what its robot senses; of a frozen one the latest waits for it."""
        robot = self._robots[i]
        if not robot.runs:
            lasting = [event for event in robot.sensed if not isinstance(event, Pose | Scan | Sensed)]
            robot.sensed = [*lasting, *events]
            return list
        return self._act(i, partial(robot.life.step, events), now)

    def send(self, i: int, effect: Any, now: float) -> None:
        """Put a datagram under way."""
        self._datagrams.send(i, effect.to, effect.payload, now)

    def due(self) -> float:
        """Return when the next datagram arrives or robot wakes [s]."""
        wake = self._queue[0][0] if self._queue else float("inf")
        return min(wake, self._datagrams.next_arrival())

    def happen(self) -> tuple[float, int, Act]:
        """Take the next of these."""
        if self._datagrams.next_arrival() <= (self._queue[0][0] if self._queue else float("inf")):
            now, sender, to, payload = self._datagrams.arrive()
            robot = self._robots[to]
            if robot.runs:
                return now, to, self._act(to, partial(robot.life.hear, sender, payload), now)
            if robot.up:
                robot.inbox.append((sender, payload))
            return now, to, list
        now, _, i = heapq.heappop(self._queue)
        robot = self._robots[i]
        if not robot.runs or now < robot.scheduled:
            return now, i, list
        robot.scheduled = float("inf")
        return now, i, self._act(i, partial(robot.life.step, ()), now)

    def killed(self, i: int, now: float) -> None:
        """End a robot's program for ever."""
        self._robots[i].up = False

    # -- what befalls robots ---------------------------------------------------------------------------

    def _befall(self, happening: Happening, now: float) -> Iterable[tuple[int, Act]]:
        i, robot = happening.robot, self._robots[happening.robot]
        match happening:
            case Crashes():
                robot.up = False
                self._field.kill(i)
            case Restarts():
                self._bury(i)
                self._robots[i] = self._start(i, robot.boot + 1, robot.clock, now)
                self._agents[i] = self._robots[i].life.agent
                self._field.revive(i, now)
            case Freezes():
                robot.frozen = True
            case Thaws() if robot.up:
                robot.frozen, robot.scheduled = False, float("inf")
                yield from self._catch_up(i, now)
            case Skews(s=s, ppm=ppm):
                robot.clock = robot.clock.skewed(now, s, ppm)
                robot.scheduled = float("inf")
                if robot.runs:
                    yield i, self._act(i, partial(robot.life.step, ()), now)

    def _start(self, i: int, boot: int, clock: SkewedClock, now: float) -> _Robot:
        life = self._live(i, self._spawn(i, boot), clock.shows(now), self._lease)
        return _Robot(life, boot, clock)

    def _program(self, i: int, agent: Agent, now: float, lease: float) -> NetworkedAgent:
        return NetworkedAgent(agent, now, lease=lease, admitted=len(self._field.alive))

    def _bury(self, i: int) -> None:
        """Keep the counts of a life that is over."""
        life = self._robots[i].life
        for kind, (messages, size) in self._earlier.items():
            messages[i] += life.messages_sent[kind]
            size[i] += life.bytes_sent[kind]

    def _catch_up(self, i: int, now: float) -> Iterable[tuple[int, Act]]:
        """Let a robot go on, with its old ideas; what came meanwhile comes now."""
        robot = self._robots[i]
        while robot.inbox:
            sender, payload = robot.inbox.popleft()
            yield i, self._act(i, partial(robot.life.hear, sender, payload), now)
        events, robot.sensed = robot.sensed, []
        yield i, self._act(i, partial(robot.life.step, events), now)

    def _act(self, i: int, what: Callable[[float], Sequence[Any]], now: float) -> Act:
        """Return an act at the time that the robot's clock shows, after which the robot sleeps."""
        robot = self._robots[i]

        def act() -> Sequence[Any]:
            effects = what(robot.clock.shows(now))
            wake = max(robot.clock.when(robot.life.wake), now) + ROUNDING
            if wake < robot.scheduled:
                robot.scheduled = wake
                heapq.heappush(self._queue, (wake, next(self._count), i))
            return effects

        return act
