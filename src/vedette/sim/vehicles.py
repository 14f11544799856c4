"""Simulated vehicles: they fly their plans exactly, and look at each step's end."""

from __future__ import annotations

from collections.abc import Callable
from math import floor
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.agent.body import TICK
from vedette.agent.effects import Fly, Motion
from vedette.agent.events import Event, Pose, Sensed
from vedette.agent.flight import AnyPlan, Itinerary, MovePlan
from vedette.errors import InputError
from vedette.outcome import Outcome

Look: TypeAlias = Callable[[int, NDArray[np.float64], float], object]
"""``look(i, pose (3,), now)``: what vehicle i's sensor tells its mission, noise included; None: nothing."""

_TOLERANCE = 1e-9  # [rad/s], and of a speed


class Vehicles:
    """Vehicles at constant speed that keep altitudes of their own; ``vedette.sim.field.Field``."""

    def __init__(
        self,
        poses: ArrayLike,
        speeds: ArrayLike,
        turn_rates: ArrayLike | None,
        step: float,
        look: Look,
        over: Callable[[float], Outcome | None] = lambda now: None,
    ) -> None:
        """Let n vehicles fly from their starts.

        Args:
            poses: (n, 3) x, y, heading [m, m, rad], team frame.
            speeds: (n,) [m/s].
            turn_rates: (n,) greatest [rad/s]; without a plan a vehicle circles at it. None: all turn at
                once, and stand without a plan.
            step: of looking [s], on its multiples.
            look: called for each living vehicle, in index order, at time 0 and after every step.
            over: tells when, and how, the mission is over for reasons of its own.

        Raises:
            InputError: ``step`` is no multiple of the simulator's tick of 0.1 s.
        """
        self.poses = np.array(poses, np.float64).reshape(-1, 3)
        n = len(self.poses)
        self._speeds = np.broadcast_to(np.asarray(speeds, np.float64), n)
        rates = None if turn_rates is None else np.asarray(turn_rates, np.float64)
        self._turn_rates = [None] * n if rates is None else np.broadcast_to(rates, n).tolist()
        if not (step >= TICK and abs(step / TICK - round(step / TICK)) < 1e-6):
            raise InputError(f"step must be a multiple of the simulator's tick of {TICK:g} s; got {step!r}")
        self._step, self._look, self._over = step, look, over
        self._alive = np.ones(n, np.bool_)
        self._flights = [Itinerary(rate) for rate in self._turn_rates]
        self._stood = np.zeros(n)  # time of that in which each was not alive, or stood [s]
        self._flown = np.zeros(n)  # time up to which each pose has been worked out [s]
        self._looks = np.zeros(n, np.int64)

    @property
    def alive(self) -> NDArray[np.bool_]:
        """``(n,)``."""
        return self._alive

    @property
    def travelled(self) -> NDArray[np.float64]:
        """``(n,)`` way flown so far [m]."""
        return self._speeds * (self._flown - self._stood)

    def pose(self, i: int) -> tuple[float, float, float]:
        """Return x, y [m] and heading [rad, not wrapped] of a vehicle, team frame."""
        x, y, heading = self.poses[i].tolist()
        return x, y, heading

    def flight(self, i: int) -> Itinerary:
        """Return what a vehicle flies."""
        return self._flights[i]

    def sense(self, i: int, now: float) -> list[Event]:
        """Return the pose, and at the end of a step what the sensor saw."""
        events: list[Event] = [Pose(*self.pose(i))]
        if now >= self._looks[i] * self._step - 1e-9:
            self._looks[i] = floor(now / self._step + 1e-6) + 1  # what could not be seen in time is not seen
            seen = self._look(i, self.poses[i].copy(), now)
            if seen is not None:
                events.append(Sensed(seen, now))
        return events

    def carry_out(self, i: int, motion: Motion, now: float) -> None:
        """Let a vehicle fly a plan from its start on; ValueError if it cannot turn, or move, so fast."""
        assert isinstance(motion, Fly), "vehicles do not drive"
        _check_plan(i, motion.plan, self._turn_rates[i], float(self._speeds[i]))
        if self._alive[i]:
            self._fly(i, now)
            self._flights[i] = self._flights[i].joined(motion.plan, now)

    def advance(self, now: float, dt: float) -> None:
        """Fly on to now."""
        for i in np.flatnonzero(self._alive).tolist():
            self._fly(i, now)

    def kill(self, i: int) -> None:
        """Stop a vehicle where it is."""
        self._alive[i] = False

    def revive(self, i: int, now: float) -> None:
        """Let a vehicle circle on from where it is."""
        self._alive[i] = True
        self._stood[i] += now - self._flown[i]
        self._flown[i] = now
        self._flights[i] = Itinerary(self._turn_rates[i])

    def over(self, now: float) -> Outcome | None:
        """Return what the mission's world says."""
        return self._over(now)

    def _fly(self, i: int, now: float) -> None:
        speed, flown = float(self._speeds[i]), float(self._flown[i])
        self.poses[i] = self._flights[i].fly(self.poses[i], speed, flown, now)
        self._stood[i] += self._flights[i].rested(speed, flown, now)
        self._flown[i] = max(flown, now)


def _check_plan(i: int, plan: AnyPlan, turn_rate: float | None, speed: float) -> None:
    """Raise ValueError for a plan that vehicle i cannot carry out."""
    if isinstance(plan, MovePlan):
        if turn_rate is not None or not np.all(np.hypot(*plan.velocities.T) <= speed * (1.0 + _TOLERANCE)):
            raise ValueError(f"vehicle {i} has {speed:g} m/s at most; its plan wants {plan.velocities}")
    elif turn_rate is None or not np.all(np.abs(plan.turn_rates) <= turn_rate + _TOLERANCE):
        raise ValueError(f"vehicle {i} turns at most at {turn_rate} rad/s; its plan wants {plan.turn_rates}")
