"""The play of a fault schedule over time: what befalls robots, and the weather on the links."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.sim.datagrams import Weather
from vedette.sim.faults.kinds import (
    Crash,
    Cut,
    Delay,
    Duplicate,
    Fault,
    FreezeFault,
    Heal,
    LinkFault,
    Loss,
    OneWay,
    Partition,
    Restart,
    Schedule,
    Skew,
)


@dataclass(frozen=True)
class Crashes:
    """The program of a robot, by index from 0, ends; its body stops."""

    robot: int


@dataclass(frozen=True)
class Restarts:
    """The program of a robot that has crashed starts with a new boot and nothing in memory."""

    robot: int


@dataclass(frozen=True)
class Freezes:
    """The program of a robot halts."""

    robot: int


@dataclass(frozen=True)
class Thaws:
    """The program of a robot that was frozen goes on with its old ideas."""

    robot: int


@dataclass(frozen=True)
class Skews:
    """A robot's clock is set ahead and runs faster, as `SkewedClock.skewed`."""

    robot: int
    s: float
    ppm: float


Happening: TypeAlias = Crashes | Restarts | Freezes | Thaws | Skews


class Timeline:
    """A schedule, checked for this team, that time passes over; ``weather`` is how the links are by now."""

    def __init__(self, schedule: Schedule, robots: int) -> None:
        """Begin before the first fault, even one at 0 s."""
        self.weather = Weather()
        self._robots = robots
        self._links: list[LinkFault] = []  # at work, in the order of their beginning
        self._frozen: dict[int, FreezeFault] = {}  # by number from 1
        begins = [(fault.at, True, fault) for _, fault in schedule.in_time()]
        ends = [(end, False, fault) for _, fault in schedule.in_time() if (end := _end(fault)) is not None]
        # at one time, what ends comes before what begins
        self._ahead = deque(sorted(ends + begins, key=lambda change: change[:2]))

    def next_change(self) -> float:
        """Return when a fault begins or ends next [s]; inf: no more."""
        return self._ahead[0][0] if self._ahead else math.inf

    def advance(self, now: float) -> list[Happening]:
        """Return what befalls robots up to ``now`` [s], in order, and bring ``weather`` up to then."""
        happenings: list[Happening] = []
        before = tuple(self._links)
        while self.next_change() <= now:
            _, begins, fault = self._ahead.popleft()
            happening = self._begin(fault) if begins else self._finish(fault)
            if happening is not None:
                happenings.append(happening)
        if before != tuple(self._links):
            self.weather = _weather(self._links, self._robots)
        return happenings

    def _begin(self, fault: Fault) -> Happening | None:
        match fault:
            case Heal():
                self._links.clear()
            case Crash(robot=robot):
                self._frozen.pop(robot, None)
                return Crashes(robot - 1)
            case Restart(robot=robot):
                return Restarts(robot - 1)
            case FreezeFault(robot=robot):
                self._frozen[robot] = fault
                return Freezes(robot - 1)
            case Skew(robot=robot):
                return Skews(robot - 1, fault.s, fault.ppm)
            case _:
                self._links.append(fault)
        return None

    def _finish(self, fault: Fault) -> Happening | None:
        self._links = [each for each in self._links if each is not fault]
        if isinstance(fault, FreezeFault) and self._frozen.get(fault.robot) is fault:
            del self._frozen[fault.robot]
            return Thaws(fault.robot - 1)
        return None


def _end(fault: Fault) -> float | None:
    lasts = fault.lasts if isinstance(fault, LinkFault | FreezeFault) else None
    return None if lasts is None else fault.at + lasts


def _weather(faults: list[LinkFault], robots: int) -> Weather:
    """Return what link faults do together: of each kind the latest rules, but all that is cut is cut."""
    loss, repeat, delay = 0.0, 0.0, None
    blocked = np.zeros((robots, robots), dtype=bool)
    for fault in faults:
        match fault:
            case Loss(share=share):
                loss = share
            case Duplicate(share=share):
                repeat = share
            case Delay(between=between):
                delay = between
            case OneWay(sender=sender, to=to):
                blocked[sender - 1, to - 1] = True
            case Cut(robots=(a, b)):
                blocked[a - 1, b - 1] = blocked[b - 1, a - 1] = True
            case Partition(parts=parts):
                blocked |= _between(parts, robots)
    return Weather(loss, repeat, delay, blocked if blocked.any() else None)


def _between(parts: tuple[tuple[int, ...], ...], robots: int) -> NDArray[np.bool_]:
    part = np.zeros(robots, dtype=int)
    for number, members in enumerate(parts, start=1):
        part[[robot - 1 for robot in members]] = number
    return np.asarray(part[:, None] != part)
