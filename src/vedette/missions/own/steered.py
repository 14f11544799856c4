"""One vehicle of an own domain: the turn rates it can fly, what they would add, its best reply."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.errors import PartError
from vedette.forbidden import NOWHERE, Forbidden, Turning
from vedette.missions.own.case import OwnCase
from vedette.parts import telling
from vedette.problem import Objective
from vedette.vehicle import drive, turn_sequences

EPSILON = 1e-9  # a new course must gain this share more than the present one


@dataclass(frozen=True, eq=False)
class OwnBelief:
    """What a round is decided on: the belief of an own domain, for plans from a step on."""

    belief: Any
    step: int


@dataclass(frozen=True)
class Turns:
    """A strategy: the turn rate of each step from one on."""

    step: int  # at whose beginning it starts
    rates: tuple[float, ...]  # (K,) [rad/s], counter-clockwise positive

    def after(self, step: int, horizon: int) -> Turns:
        """Return what is left of it at a later step, straight ahead at the end."""
        left = self.rates[max(0, step - self.step) :][:horizon]
        return Turns(step, left + (0.0,) * (horizon - len(left)))


@dataclass(eq=False)
class SteeredPlatform:
    """A vehicle at constant speed that compares all sequences of right, straight and left.

    ``vedette.agent.mission.RoundPlatform``.
    """

    case: OwnCase
    objective: Objective[OwnBelief, Any]
    robot: int
    forbidden: Forbidden = NOWHERE  # ground that it must not be over
    courses: list[Turns] = field(default_factory=list)  # that are compared, the present one first
    own: list[Any] = field(default_factory=list)  # what each would add

    def prepare(self, known: OwnBelief, pose: NDArray[np.float64], present: Turns) -> Turns:
        """Work out what each course would add from a pose; return the present one, restated."""
        scenario, step = self.case.scenario, known.step
        vehicle, horizon = scenario.vehicles[self.robot], scenario.horizon
        now = present.after(step, horizon)
        others = (Turns(step, tuple(rates)) for rates in self._sequences(vehicle.turn_rate).tolist())
        self.courses = self._kept_out(pose, list(dict.fromkeys([now, *others])))
        rates = np.array([course.rates for course in self.courses])
        poses = drive(pose, rates, vehicle.speed, scenario.step)
        self.own = list(self.case.theory.impacts(known.belief, self.robot, poses))
        self._try(known)
        return self.courses[0]

    def _kept_out(self, pose: NDArray[np.float64], courses: list[Turns]) -> list[Turns]:
        """Return courses with those that lead over forbidden ground replaced."""
        vehicle, dt = self.case.scenario.vehicles[self.robot], self.case.scenario.step
        if not self.forbidden or vehicle.speed == 0.0 or vehicle.turn_rate == 0.0:
            return courses
        turning = Turning(vehicle.speed, vehicle.turn_rate)
        rates = self.forbidden.kept_out(pose, np.array([each.rates for each in courses]), turning, dt)
        return list(dict.fromkeys(Turns(courses[0].step, tuple(row)) for row in rates.tolist()))

    def _try(self, known: OwnBelief) -> None:
        """Raise PartError where the theory's parts do not go together, before a message is sent."""
        where, theory = self.case.where, self.case.theory
        if len(self.own) != len(self.courses):
            raise PartError(f"{where}: impacts: gives {len(self.own)} for {len(self.courses)} courses")
        with telling(f"{where}: objective"):
            if (wrong := theory.objective.wrong_belief(known.belief)) is not None:
                raise PartError(f"{where}: belief: {wrong}")
            if (bad := theory.objective.wrong_impact(known.belief, self.own)) is not None:
                raise PartError(f"{where}: impacts[{bad[0]}]: {bad[1]}")
            self.objective.values(known, self.objective.nothing(known), self.own)
        with telling(f"{where}: codec"):
            theory.codec.decode(theory.codec.encode(self.own[0]))

    def _sequences(self, turn_rate: float) -> NDArray[np.float64]:
        horizon = self.case.scenario.horizon
        blocks = min(horizon, self.case.scenario.decisions)
        lengths = [horizon // blocks + (i >= blocks - horizon % blocks) for i in range(blocks)]
        rates = np.repeat(turn_sequences(turn_rate, blocks), lengths, axis=1)
        return rates[
            np.argsort(np.abs(rates).sum(axis=1), kind="stable")
        ]  # on equal terms, the least turning

    def impact(self, belief: OwnBelief, strategy: Turns) -> Any:
        """Return what a course adds."""
        return self.own[self.courses.index(strategy)]

    def reply(self, belief: OwnBelief, others: Any, current: Turns) -> Turns:
        """Return the best course against the rest of the team, the present one if none is better."""
        values = self.objective.values(belief, others, self.own)
        best, present = int(np.argmax(values)), values[self.courses.index(current)]
        return self.courses[best] if values[best] - present > EPSILON * abs(present) else current

    def slack(self, belief: OwnBelief, base: Any) -> float:
        """No course adds more to the team's impact; infinite where the objective has no bound."""
        if not (self.objective.monotone and self.objective.submodular):
            return math.inf
        most = float(self.objective.values(belief, base, self.own).max())
        return max(0.0, most - self.objective.value(belief, base))
