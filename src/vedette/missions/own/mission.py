"""A vehicle's share of a mission of an own domain: evidence that adds up, plans as turn rates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.agent.events import Pose, Sensed
from vedette.agent.flight import FlightPlan, start_step, step_of
from vedette.agent.mates import Mate
from vedette.agent.mission import RoundPlatform
from vedette.fusion.steps import Refilter, Sparse, SparseIntegers, StepEvidence
from vedette.missions.flying import FlyingMission, SharedBelief
from vedette.missions.own.case import OwnCase
from vedette.missions.own.steered import OwnBelief, SteeredPlatform, Turns
from vedette.problem import Codec, Objective, Reach
from vedette.problem.checked import value_of, values_of


@dataclass(frozen=True, eq=False)
class OwnReading:
    """What a vehicle's sensor tells at the end of a step, and where."""

    pose: NDArray[np.float64]  # (3,) [m, m, rad]
    reading: Any


@dataclass(frozen=True, eq=False)
class OnOwnBelief(Objective[OwnBelief, Any]):
    """An own domain's objective on what a round is decided on."""

    own: Objective[Any, Any]

    @property
    def monotone(self) -> bool:  # type: ignore[override]
        """Whether it says so."""
        return self.own.monotone

    @property
    def submodular(self) -> bool:  # type: ignore[override]
        """Whether it says so."""
        return self.own.submodular

    def nothing(self, belief: OwnBelief) -> Any:
        """Return nothing."""
        return self.own.nothing(belief.belief)

    def combine(self, a: Any, b: Any) -> Any:
        """``a * b``."""
        return self.own.combine(a, b)

    def value(self, belief: OwnBelief, impact: Any) -> float:
        """``psi``."""
        return value_of(self.own, belief.belief, impact)

    def values(self, belief: OwnBelief, others: Any, own: Sequence[Any]) -> NDArray[np.float64]:
        """``psi`` of others with each of own."""
        return values_of(self.own, belief.belief, others, own)


@dataclass(eq=False)
class OwnMission(FlyingMission[OwnBelief, Turns, Any]):
    """One vehicle's share; ``vedette.agent.mission.FlightMission``.

    Evidence waits to be published: a round's must not change while it lasts.
    """

    case: OwnCase
    robot: int
    lead: float  # from freezing a round to the start of its plans, at least [s]
    fusion: StepEvidence[Sparse]
    tells_plans: bool = True  # False: the team shares beliefs alone
    strategy: Turns = field(default_factory=lambda: Turns(0, ()))
    vehicle: SteeredPlatform = field(init=False)
    working: RoundPlatform[Any, Turns, Any] = field(init=False)
    _elements: SparseIntegers = field(init=False)
    _filter: Refilter[NDArray[np.int64], Sparse] = field(init=False)
    _waiting: list[tuple[int, OwnReading]] = field(default_factory=list)

    def __post_init__(self) -> None:
        theory = self.case.theory
        self.vehicle = SteeredPlatform(self.case, OnOwnBelief(theory.objective), self.robot)
        self.working = self.vehicle if self.tells_plans else SharedBelief(self.vehicle, self.objective)
        self._elements = SparseIntegers(theory.size)
        nothing = np.zeros(theory.size, np.int64)
        self._filter = Refilter(self.fusion, nothing, 0, predict=lambda total, step: total, update=_added)

    @property
    def objective(self) -> Objective[OwnBelief, Any]:
        """What the team gains."""
        return self.vehicle.objective

    @property
    def codec(self) -> Codec[Any]:
        """How impacts travel."""
        return self.case.theory.codec

    # -- evidence -----------------------------------------------------------------------------------

    def observe(self, seen: Sensed, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Keep what was sensed until it is published."""
        assert isinstance(seen.data, OwnReading)
        self._waiting.append((step_of(seen.time, self.case.scenario.step), seen.data))

    def publish(self, now: float) -> None:
        """Hand the evidence that waits to fusion."""
        waiting, self._waiting = self._waiting, []
        for step, told in waiting:
            places, numbers = self.case.theory.evidence(self.robot, told.pose, told.reading)
            self.fusion.publish(step, self._elements.of(np.asarray(places), np.asarray(numbers)))

    def total(self, step: int) -> NDArray[np.int64]:
        """Return what all evidence adds up to at a step, as far as this vehicle has heard."""
        return self._filter.at(max(step, self._filter.first))

    # -- planning -----------------------------------------------------------------------------------

    def freeze(self, t0: float) -> OwnBelief:
        """Snapshot what is known, for plans from the first step on that all can plan for."""
        step = max(step_of(t0, self.case.scenario.step), self._filter.first)
        start = max(step, start_step(t0, self.lead, self.case.scenario.step))
        return OwnBelief(self.case.theory.belief(self._filter.at(step).copy()), start)

    def prepare(
        self, belief: OwnBelief, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float
    ) -> None:
        """Work out what each course would add from where the vehicle will be."""
        self.held, self.vehicle.forbidden = not pose.at_work, self.forbidden
        if self.held:
            return
        here = np.array([pose.x, pose.y, pose.heading])
        self.strategy = self.vehicle.prepare(belief, here, self.strategy)

    def reach(self, now: float) -> Reach | None:
        """Gains may depend on looks anywhere."""
        return None

    def admit(self, belief: OwnBelief, impact: Any, robots: int) -> None:
        """Take what the theory's objective takes; ValueError for what it refuses."""
        wrong = self.case.theory.objective.wrong_impact(belief.belief, [impact])
        if wrong is not None:
            raise ValueError(wrong[1])

    # -- flying -------------------------------------------------------------------------------------

    def stand_by(self) -> None:
        """Leave the present course: orders keep the vehicle from it."""
        self.strategy = Turns(0, ())

    def start(self, belief: OwnBelief) -> float:
        """Return when courses planned on this belief begin [s]."""
        return belief.step * self.case.scenario.step

    def plan(self) -> FlightPlan | None:
        """Return the course decided on; None before the first round."""
        if not self.strategy.rates:
            return None
        dt = self.case.scenario.step
        return FlightPlan(self.strategy.step * dt, dt, np.array(self.strategy.rates))


def _added(total: NDArray[np.int64], step: int, more: Sparse) -> NDArray[np.int64]:
    if not len(more.index):
        return total
    both = total.copy()
    both[more.index] += more.value
    return both
