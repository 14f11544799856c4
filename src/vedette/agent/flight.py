"""Flights: plans laid end to end in time, of turn rates or of velocities, and where they take a vehicle."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan2, ceil, floor, hypot, inf
from typing import TypeAlias

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


Control: TypeAlias = float | NDArray[np.float64] | None
"""A turn rate [rad/s], counter-clockwise positive; a velocity (2,) [m/s], team frame; None: it stands."""


@dataclass(frozen=True, eq=False)
class FlightPlan:
    """Turn rates held for a step each, from a time on."""

    start: float  # [s]
    step: float  # dt [s]
    turn_rates: NDArray[np.float64]  # (K,) [rad/s], counter-clockwise positive

    @property
    def end(self) -> float:
        """When it is over [s]."""
        return self.start + self.step * len(self.turn_rates)

    def held(self, time: float) -> tuple[Control, float]:
        """Return the turn rate [rad/s] held at a time after ``start`` (None past the end), and until when."""
        k = _step_within(self, time)
        if k >= len(self.turn_rates):
            return None, inf
        return float(self.turn_rates[k]), self.start + (k + 1) * self.step


@dataclass(frozen=True, eq=False)
class MovePlan:
    """Velocities held for a step each, from a time on: of one that turns at once, and may stand."""

    start: float  # [s]
    step: float  # dt [s]
    velocities: NDArray[np.float64]  # (K, 2) [m/s], team frame

    @property
    def end(self) -> float:
        """When it is over [s]."""
        return self.start + self.step * len(self.velocities)

    def held(self, time: float) -> tuple[Control, float]:
        """Return the velocity (2,) [m/s] held at a time after ``start``, None past the end, until when."""
        k = _step_within(self, time)
        if k >= len(self.velocities):
            return None, inf
        return self.velocities[k], self.start + (k + 1) * self.step


AnyPlan: TypeAlias = FlightPlan | MovePlan


def _step_within(plan: AnyPlan, time: float) -> int:
    return max(floor((time - plan.start) / plan.step + _ROUNDING), 0)


@dataclass(frozen=True, eq=False)
class Itinerary:
    """What a vehicle flies: each plan from its start until the next one's; without one, a circle.

    Before its first plan and after its last a vehicle turns at ``loiter``. It then stays within
    ``2 V / loiter`` of where the plan left it, which a straight line would not. One that may stand, stands.
    """

    loiter: float | None  # [rad/s]; None: it stands
    plans: tuple[AnyPlan, ...] = ()
    since: tuple[float, ...] = ()  # when each takes over [s], increasing

    def joined(self, plan: AnyPlan, now: float) -> Itinerary:
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

    def held(self, begin: float, end: float) -> Iterator[tuple[Control, float]]:
        """Yield the turn rates or velocities held between two times, each with its duration [s]."""
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
        for control, duration in self.held(begin, end):
            here = _moved(here, control, speed, duration)
        return here

    def traced(self, pose: ArrayLike, speed: float, begin: float, spacing: float) -> NDArray[np.float64]:
        """Return a vehicle's poses (N, 3), at most so far apart [m], from ``begin`` to the end of its plans.

        The first is the one given.
        """
        here = np.asarray(pose, np.float64)
        poses = [here[None]]
        for control, duration in self.held(begin, max((plan.end for plan in self.plans), default=begin)):
            parts = max(1, ceil(speed * duration / spacing))
            if isinstance(control, float):
                poses.append(drive(here, np.full(parts, control), speed, duration / parts))
            else:
                ends = np.arange(1, parts + 1) * (duration / parts)
                poses.append(np.array([_moved(here, control, speed, end) for end in ends.tolist()]))
            here = poses[-1][-1]
        return np.concatenate(poses)

    def rested(self, speed: float, begin: float, end: float) -> float:
        """Return how much longer than its way at full ``speed`` [m/s] takes the time between two is [s]."""
        rested = 0.0
        for control, duration in self.held(begin, end) if self.loiter is None else ():
            share = hypot(*control) / speed if isinstance(control, np.ndarray) and speed > 0.0 else 0.0
            rested += (1.0 - share) * duration
        return rested

    def ahead(self, pose: ArrayLike, speed: float, begin: float, every: float) -> NDArray[np.float64]:
        """Return where it takes a vehicle from ``begin`` on, as far as it is planned, (k, 2) [m].

        A place each ``every`` seconds, the first is where the vehicle is.
        """
        end = max((plan.end for plan in self.plans), default=begin)
        times = np.arange(begin, max(end, begin) + 1e-6, every)
        if self.loiter is not None:
            return np.array([self.fly(pose, speed, begin, time)[:2] for time in times])
        places = [np.asarray(pose, np.float64)]  # straight lines add up as well as they are
        for start, time in pairwise(times.tolist()):
            places.append(self.fly(places[-1], speed, start, time))
        return np.array(places)[:, :2]


def _moved(pose: NDArray[np.float64], control: Control, speed: float, duration: float) -> NDArray[np.float64]:
    """Return the pose (3,) after holding a control for so long [s]."""
    if control is None:
        return pose
    if not isinstance(control, np.ndarray):
        return np.asarray(drive(pose, [control], speed, duration)[0])
    x, y = (pose[:2] + duration * control).tolist()
    heading = atan2(control[1], control[0]) if control.any() else pose[2]
    return np.array((x, y, heading))
