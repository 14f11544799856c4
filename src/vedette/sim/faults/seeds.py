"""Random fault schedules: all kinds of faults, and in the end everything that can heal is healed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from vedette.errors import InputError
from vedette.sim.faults.kinds import (
    Crash,
    Cut,
    Delay,
    Duplicate,
    Fault,
    FreezeFault,
    Heal,
    Loss,
    OneWay,
    Partition,
    Restart,
    Schedule,
    Skew,
)

FEWEST, MOST = 4, 10  # faults, beside clocks and the healing
LONGEST_FREEZE = 8.0  # [s]: some are noticed, some are not
LONGEST_WAIT = 0.5  # of a datagram [s]
SKEW_S, SKEW_PPM = 1000.0, 500.0  # of clocks that are wrong at all, at most


def faults_from_seed(seed: int, robots: int, duration: float) -> Schedule:
    """Return a random schedule for a team, in order of time.

    All faults happen before ``duration`` [s]; at ``duration`` the links are healed and nobody is frozen any
    more. Robots that have crashed may stay so, but one robot at least never crashes. Clocks stay wrong.

    Raises:
        InputError: the duration is too short or not a number.
    """
    if not 1.0 <= duration <= 86400.0:
        raise InputError(f"the duration of random faults must be 1 to 86400 s; got {duration:g}")
    return _Dice(seed, robots, float(duration)).schedule()


class _Dice:
    """Throws faults in order of time, and knows who is up."""

    def __init__(self, seed: int, robots: int, duration: float) -> None:
        self._rng = np.random.default_rng(seed)
        self._robots, self._duration = robots, duration
        self._safe = int(self._rng.integers(1, robots + 1))  # never crashes
        self._crashed: set[int] = set()
        self._thaw: dict[int, float] = {}  # when [s]

    def schedule(self) -> Schedule:
        """Return all faults, in order of time."""
        faults = self._clocks() if self._rng.random() < 0.5 else []
        times = self._rng.uniform(0.0, self._duration, self._rng.integers(FEWEST, MOST + 1))
        for at in sorted(round(0.95 * float(time), 3) for time in times):
            faults += self._any(at)
        faults.sort(key=lambda fault: fault.at)
        return Schedule((*faults, Heal(at=self._duration)))

    def _any(self, at: float) -> list[Fault]:
        kinds: list[Callable[[float], list[Fault]]] = [self._loss, self._delay, self._duplicate, self._freeze]
        if self._robots > 1:
            kinds += [self._one_way, self._flap, self._partition, self._heal, self._crash]
        if self._crashed:
            kinds += [self._restart, self._restart]
        return kinds[int(self._rng.integers(len(kinds)))](at)

    # -- of links ------------------------------------------------------------------------------------

    def _loss(self, at: float) -> list[Fault]:
        return [Loss(at=at, share=self._number(0.05, 0.6), lasts=self._lasts(at))]

    def _duplicate(self, at: float) -> list[Fault]:
        return [Duplicate(at=at, share=self._number(0.05, 0.5), lasts=self._lasts(at))]

    def _delay(self, at: float) -> list[Fault]:
        between = (self._number(0.001, 0.02), self._number(0.02, LONGEST_WAIT))
        return [Delay(at=at, between=between, lasts=self._lasts(at))]

    def _one_way(self, at: float) -> list[Fault]:
        sender, to = self._pair()
        return [OneWay(at=at, sender=sender, to=to, lasts=self._lasts(at))]

    def _flap(self, at: float) -> list[Fault]:
        """Cut a link once or several times in a row."""
        pair, cuts = self._pair(), []
        for _ in range(int(self._rng.integers(1, 5))):
            lasts = self._within(at, self._number(0.05, 3.0))
            cuts.append(Cut(at=at, robots=pair, lasts=lasts))
            at = round(at + lasts + self._number(0.05, 1.0), 3)
            if at >= 0.98 * self._duration:
                break
        return [*cuts]

    def _partition(self, at: float) -> list[Fault]:
        order = [int(robot) for robot in self._rng.permutation(self._robots) + 1]
        size = int(self._rng.integers(1, self._robots))
        parts = tuple(sorted(order[:size])), tuple(sorted(order[size:]))
        return [Partition(at=at, parts=parts, lasts=self._lasts(at))]

    def _heal(self, at: float) -> list[Fault]:
        return [Heal(at=at)]

    # -- of robots -----------------------------------------------------------------------------------

    def _clocks(self) -> list[Fault]:
        return [
            Skew(at=0.0, robot=robot, s=self._number(-SKEW_S, SKEW_S), ppm=self._number(-SKEW_PPM, SKEW_PPM))
            for robot in range(1, self._robots + 1)
        ]

    def _crash(self, at: float) -> list[Fault]:
        up = [robot for robot in self._up() if robot != self._safe]
        if not up:
            return self._restart(at)
        robot = self._one_of(up)
        self._crashed.add(robot)
        self._thaw.pop(robot, None)
        return [Crash(at=at, robot=robot)]

    def _restart(self, at: float) -> list[Fault]:
        robot = self._one_of(sorted(self._crashed))
        self._crashed.remove(robot)
        return [Restart(at=at, robot=robot)]

    def _freeze(self, at: float) -> list[Fault]:
        awake = [robot for robot in self._up() if self._thaw.get(robot, 0.0) <= at]
        if not awake:
            return self._loss(at)
        robot = self._one_of(awake)
        lasts = self._within(at, self._number(0.1, LONGEST_FREEZE))
        self._thaw[robot] = at + lasts
        return [FreezeFault(at=at, robot=robot, lasts=lasts)]

    # -- chance --------------------------------------------------------------------------------------

    def _up(self) -> list[int]:
        return [robot for robot in range(1, self._robots + 1) if robot not in self._crashed]

    def _one_of(self, robots: list[int]) -> int:
        return robots[int(self._rng.integers(len(robots)))]

    def _pair(self) -> tuple[int, int]:
        a, b = (int(robot) + 1 for robot in self._rng.choice(self._robots, 2, replace=False))
        return a, b

    def _number(self, low: float, high: float) -> float:
        return round(float(self._rng.uniform(low, high)), 3)

    def _lasts(self, at: float) -> float | None:
        """Return how long a fault of links lasts; half of them last until they are healed."""
        if self._rng.random() < 0.5:
            return None
        return self._within(at, self._number(0.1, 0.5 * self._duration))

    def _within(self, at: float, lasts: float) -> float:
        """Shorten what would last beyond the healing."""
        return min(lasts, round(0.99 * (self._duration - at), 3))
