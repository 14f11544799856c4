"""Flights: turn-rate plans laid end to end in time, and where they take a vehicle."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import ceil, floor, inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.vehicle import drive

_ROUNDING = 1e-9  # [s], and of a step: times this near a boundary are at it
_SEEN = 1e-6  # of a step: what was seen this near its beginning was seen at it


def step_of(time: float, step: float) -> int:
    """Return the step that a time [s] lies in; step k begins at ``k dt``."""
    return floor(time / step + _SEEN)


def start_step(t0: float, lead: float, step: float) -> int:
    """``k = ceil((t0 + lead) / dt)``: the first step that begins at or after ``t0 + lead`` [s].

    ``t0`` is the round's, so that the whole team plans for the same steps; step k begins at ``k dt`` [s].
    """
    return ceil((t0 + lead) / step - _ROUNDING)


@dataclass(frozen=True, eq=False)
class FlightPlan:
    """Turn rates held for a step each, from a time on."""

    start: float  # [s]
    step: float  # dt [s]
    turn_rates: NDArray[np.float64]  # (K,) [rad/s], counter-clockwise positive

    def held(self, time: float) -> tuple[float | None, float]:
        """Return the turn rate [rad/s] held at a time after ``start`` (None past the end), and until when."""
        k = max(floor((time - self.start) / self.step + _ROUNDING), 0)
        if k >= len(self.turn_rates):
            return None, inf
        return float(self.turn_rates[k]), self.start + (k + 1) * self.step


@dataclass(frozen=True, eq=False)
class Itinerary:
    """What a vehicle flies: each plan from its start until the next one's; without one, a circle.

    Before its first plan and after its last a vehicle turns at ``loiter``. It then stays within
    ``2 V / loiter`` of where the plan left it, which a straight line would not.
    """

    loiter: float  # [rad/s]
    plans: tuple[FlightPlan, ...] = ()
    since: tuple[float, ...] = ()  # when each takes over [s], increasing

    def joined(self, plan: FlightPlan, now: float) -> Itinerary:
        """Return this flight up to the plan's start, the plan from then on.

        A plan that comes after its start is taken up where it would be by now. Plans over by now are dropped.
        """
        since = max(plan.start, now)
        first = max(bisect_right(self.since, now) - 1, 0)
        kept = [k for k in range(first, len(self.plans)) if self.since[k] < since]
        return replace(
            self,
            plans=(*(self.plans[k] for k in kept), plan),
            since=(*(self.since[k] for k in kept), since),
        )

    def planned(self, now: float) -> bool:
        """Tell whether a plan, and not the circle, holds now."""
        k = bisect_right(self.since, now) - 1
        return k >= 0 and self.plans[k].held(now)[0] is not None

    def held(self, begin: float, end: float) -> Iterator[tuple[float, float]]:
        """Yield the turn rates [rad/s] held between two times, each with its duration [s]."""
        time = begin
        while time < end - _ROUNDING:
            k = bisect_right(self.since, time + _ROUNDING) - 1
            rate, until = self.plans[k].held(time) if k >= 0 else (None, inf)
            following = self.since[k + 1] if k + 1 < len(self.since) else inf
            until = min(until, following, end)
            yield self.loiter if rate is None else rate, until - time
            time = until

    def fly(self, pose: ArrayLike, speed: float, begin: float, end: float) -> NDArray[np.float64]:
        """Return the pose (3,) [m, m, rad] at ``end`` of a vehicle that has the one given at ``begin``.

        Exact, at constant ``speed`` [m/s]; at an ``end`` that is not after ``begin`` it is where it was.
        """
        here = np.asarray(pose, np.float64)
        for rate, duration in self.held(begin, end):
            here = drive(here, [rate], speed, duration)[0]
        return here
