"""One tracker: a vehicle with a sensor, the courses it can take, and its best reply to the team."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from vedette.domains.tracking import impact as impacts
from vedette.domains.tracking.ascent import ascend, turn_rate_gradient
from vedette.domains.tracking.attending import Attending
from vedette.domains.tracking.belief import Tracks
from vedette.domains.tracking.courses import MOST_DECISIONS, Course, sequences
from vedette.domains.tracking.impact import Impact, Impacts
from vedette.domains.tracking.objective import TrackingObjective
from vedette.domains.tracking.sensing import Sensor
from vedette.domains.tracking.transit import nearest_worth, times_to_see
from vedette.errors import InputError
from vedette.forbidden import NOWHERE, Forbidden, Turning
from vedette.problem import Reach
from vedette.vehicle import carried, drive

MOST_OTHERS = 8  # targets beside the present one that it may go to after the horizon
EPSILON = 1e-9  # a new course must gain this share more than the present one


@dataclass(eq=False)
class TrackingPlatform:
    """A vehicle at constant speed, or a sensor that only turns; it looks at the end of every step.

    ``place`` says where it is at the belief's step before ``prepare``; a round then works on what that found.

    Raises:
        InputError: a speed or turn rate that is negative or not finite.
    """

    speed: float  # [m/s]; 0: a sensor on a pivot
    turn_rate: float  # most it can turn [rad/s]
    sensor: Sensor
    objective: TrackingObjective = field(default_factory=TrackingObjective)
    decisions: int = MOST_DECISIONS  # turn rates chosen independently in a horizon
    continuous: bool = False  # improve the best sequence of right, straight and left by its gradient
    pose: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))  # [m, m, rad], team frame
    present: Course | None = None
    wind: tuple[float, float] = (0.0, 0.0)  # that carries it off its way [m/s], team frame
    forbidden: Forbidden = NOWHERE  # ground that it must not be over
    courses: list[Course] = field(default_factory=list)  # that are compared; set by prepare
    candidates: Impacts | None = None  # what each would observe
    _near: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))  # (N,) targets in reach
    _known: dict[Course, Impact] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, value, unit in (("speed", self.speed, "m/s"), ("turn_rate", self.turn_rate, "rad/s")):
            if not (math.isfinite(value) and value >= 0.0):
                raise InputError(f"tracker: {name} must be >= 0 {unit}; got {value}")

    def place(self, x: float, y: float, heading: float, present: Course | None = None) -> None:
        """Say where it will be at the belief's step [m, m, rad], team frame, and which course it is on."""
        self.pose, self.present = np.array([x, y, heading]), present

    def prepare(self, belief: Tracks) -> None:
        """List the courses, the present one among them, and what each would observe: the slow part."""
        rates = sequences(self.turn_rate, belief.horizon, self.decisions)
        present = self.carry_over(belief, self.present)
        carried = np.clip(present.rates, -self.turn_rate, self.turn_rate)
        if not (rates == carried).all(axis=1).any():
            rates = np.vstack([rates, carried])
        rates = self._kept_out(belief, rates)
        self.courses = [Course(belief.k0, tuple(row), present.target) for row in rates.tolist()]
        if belief.layers:
            self.courses += self._ways_to_others(belief, rates, present.target)
        self._near = self._within_reach(belief)
        self._known.clear()
        self.candidates = self._impacts(belief, self.courses)

    def carry_over(self, belief: Tracks, strategy: Course | None) -> Course:
        """Restate a course from the belief's step on, straight ahead where it has ended.

        With a tail it goes to a target after the horizon: the nearest, if none was chosen.
        """
        course = (strategy or Course(belief.k0, ())).from_step(belief.k0, belief.horizon)
        if not belief.layers or course.target is not None:
            return course
        return replace(course, target=int(np.argmin(self._times(belief, self.pose))))

    def kept_out(self, belief: Tracks, course: Course) -> Course:
        """Return a course, or the first of those compared where it would lead over forbidden ground."""
        if not self.forbidden:
            return course
        rates = np.array([course.rates])
        return course if (self._kept_out(belief, rates) == rates).all() else self.courses[0]

    def impact(self, belief: Tracks, strategy: Course) -> Impact:
        """Information about each target along the course, step by step; paper, eq. (25)."""
        if strategy not in self._known:
            self._known[strategy] = self._impacts(belief, [strategy])[0]
        return self._known[strategy]

    def reply(self, belief: Tracks, others: Impact, current: Course) -> Course:
        """Best course against the rest of the team, ``current`` if none is better; paper, eq. (30).

        While nothing can be gained within the horizon, the course that soonest gets where something can.
        """
        assert self.candidates is not None
        values = self.objective.values(belief, others, self.candidates)
        base, present = self.objective.values(
            belief, others, [self.objective.nothing(belief), self.impact(belief, current)]
        )
        best, value = self.courses[int(np.argmax(values))], float(values.max())
        if max(value, present) - base <= EPSILON * abs(base):
            return self._transit(belief, others, current)
        if self.continuous:
            start = best if value > present else current
            best, value = self._climb(belief, others, start)
            best = self.kept_out(belief, best)
        return best if value - present > EPSILON * abs(present) else current

    def slack(self, belief: Tracks, team: Impact) -> float:
        """No course adds more than this to the team's impact; infinite where the objective has no bound.

        With continuous turn rates: what the best look from anywhere within reach would add, at every step.
        """
        assert self.candidates is not None
        if not (self.objective.monotone and self.objective.submodular):
            return math.inf
        own = [self._ceiling(belief)] if self.continuous else self.candidates
        return max(
            0.0, float(self.objective.values(belief, team, own).max()) - self.objective.value(belief, team)
        )

    def reach(self, belief: Tracks) -> Reach:
        """Return the box within which it may see targets during the horizon [m], team frame."""
        most = self.speed * (belief.dt * belief.horizon + sum(belief.layers[-1:])) + self.sensor.range
        x, y, _ = self.pose.tolist()
        return ((x - most, y - most, x + most, y + most),)

    # -- what a course observes ----------------------------------------------------------------------

    def _kept_out(self, belief: Tracks, rates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return turn rates with those that lead over forbidden ground replaced."""
        if self.speed == 0.0 or self.turn_rate == 0.0:
            return rates
        turning = Turning(self.speed, self.turn_rate)
        return self.forbidden.kept_out(self.pose, rates, turning, belief.dt)

    def _within_reach(self, belief: Tracks) -> NDArray[np.int64]:
        """Targets that it might see at some step."""
        gone = self.speed * belief.dt * np.arange(1, belief.horizon + 1)
        away = np.hypot(*np.moveaxis(belief.predicted_means[..., :2] - self.pose[:2], -1, 0))
        return np.flatnonzero((away <= self.sensor.range + gone[:, None]).any(axis=0))

    def _expected(self, belief: Tracks) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Where the targets within reach will be, (M, K, 2), and how uncertain, (M, K, 2, 2)."""
        near = self._near
        means, spreads = belief.predicted_means[:, near, :2], belief.predicted_covariances[:, near, :2, :2]
        return means.swapaxes(0, 1), spreads.swapaxes(0, 1)

    def _impacts(self, belief: Tracks, courses: Sequence[Course]) -> Impacts:
        poses = drive(self.pose, np.array([course.rates for course in courses]), self.speed, belief.dt)
        poses = carried(poses, belief.dt * np.arange(1.0, belief.horizon + 1.0), self.wind)
        near = self.sensor.foresee(poses, *self._expected(belief), self.speed * belief.dt)
        if not belief.layers:
            return impacts.stack_dense(near, self._near)
        blocks = np.zeros((len(courses), len(belief), belief.blocks, 3))
        blocks[:, self._near, : belief.horizon] = near
        attending = Attending(self.sensor, self.speed, self.turn_rate)
        goals = np.array([-1 if course.target is None else course.target for course in courses])
        for goal in np.unique(goals[goals >= 0]).tolist():
            ends = poses[goals == goal, -1]
            blocks[goals == goal, :, belief.horizon :] = attending.blocks(belief.tail, ends, goal)
        return impacts.stack_dense(blocks, np.arange(len(belief)))

    def _times(self, belief: Tracks, poses: NDArray[np.float64]) -> NDArray[np.float64]:
        """Times to see each target where it is at the horizon's end, (..., T) [s]."""
        places = belief.predicted_means[-1, :, :2]
        return times_to_see(self.sensor, self.speed, self.turn_rate, poses[..., None, :], places)

    def _ways_to_others(self, belief: Tracks, rates: NDArray[np.float64], target: int | None) -> list[Course]:
        """For each of the `MOST_OTHERS` targets that are worth most after the horizon, the quickest way."""
        tail = belief.tail
        looks = Attending(self.sensor, self.speed, self.turn_rate).looks(tail)
        worth = tail.worth(np.arange(len(belief)), looks)
        times = self._times(belief, drive(self.pose, rates, self.speed, belief.dt)[:, -1])  # (C, T)
        quickest, soon = np.argmin(times, axis=0), np.isfinite(times.min(axis=0))
        order = [t for t in np.argsort(-worth, kind="stable").tolist() if soon[t] and t != target]
        return [Course(belief.k0, tuple(rates[quickest[t]].tolist()), t) for t in order[:MOST_OTHERS]]

    def _ceiling(self, belief: Tracks) -> Impact:
        """The best that any look tells in any direction, wherever it can come within range of a target."""
        gone = self.speed * belief.dt * np.arange(1, belief.horizon + 1)
        points, _ = self._expected(belief)
        r = np.hypot(*np.moveaxis(points - self.pose[:2], -1, 0)) - gone
        most = np.where(r <= self.sensor.range, self.sensor.detection * self.sensor.most, 0.0)
        blocks = np.zeros((len(belief), belief.blocks, 3))
        blocks[self._near, : belief.horizon] = most[..., None] * np.array([1.0, 0.0, 1.0])
        if belief.layers:
            looks = Attending(self.sensor, self.speed, self.turn_rate).looks(belief.tail)
            blocks[:, belief.horizon :] = looks
        return impacts.impact_of(blocks)

    # -- how a course is chosen ----------------------------------------------------------------------

    def _climb(self, belief: Tracks, others: Impact, start: Course) -> tuple[Course, float]:
        """Improve a course by the gradient of the value as it is computed, but for the edges of the view."""
        near, dt, stride = self._near, belief.dt, self.speed * belief.dt
        points, spreads = self._expected(belief)
        theirs = np.zeros((len(belief), belief.blocks, 3))
        theirs[others.targets] = others.blocks
        theirs = theirs[:, : belief.horizon]

        def course(rates: NDArray[np.float64]) -> Course:
            return Course(belief.k0, tuple(rates.tolist()), start.target)

        def values(rates: NDArray[np.float64]) -> NDArray[np.float64]:
            return self.objective.values(
                belief, others, self._impacts(belief, [course(row) for row in rates])
            )

        def gradient(rates: NDArray[np.float64]) -> NDArray[np.float64]:
            poses = drive(self.pose, rates, self.speed, dt)
            own = self.sensor.foresee(poses[None], points, spreads, stride)[0]
            by = self.objective.gradient(belief, Impact(near, theirs[near] + own))
            slopes = self.sensor.foreseen_slope(poses, points, spreads, by, stride)
            return turn_rate_gradient(self.pose, rates, self.speed, dt, slopes.sum(axis=0))

        rates, value = ascend(values, gradient, np.array(start.rates), self.turn_rate)
        return course(rates), value

    def _transit(self, belief: Tracks, others: Impact, current: Course) -> Course:
        """Head for the target that is worth most for the time to see it, by the course that ends nearest."""
        points = belief.predicted_means[-1, :, :2]
        times = times_to_see(self.sensor, self.speed, self.turn_rate, self.pose, points)
        target = nearest_worth(self.objective, belief, others, self.sensor, times)
        if target is None:
            return current
        rates = np.array([current.rates, *(course.rates for course in self.courses)])
        ends = drive(self.pose, rates, self.speed, belief.dt)[:, -1]
        left = times_to_see(self.sensor, self.speed, self.turn_rate, ends, points[target])
        best = int(np.argmin(left))
        return self.courses[best - 1] if left[best] < left[0] * (1.0 - EPSILON) else current
