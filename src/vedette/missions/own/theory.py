"""What an own domain says of itself: what there is, what sensors tell of it, what looks are worth."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Generic

import numpy as np
from numpy.typing import NDArray

from vedette.errors import brief
from vedette.missions.own.scenario import OwnScenario
from vedette.parts import PartKind
from vedette.problem import Codec, Objective
from vedette.problem.objective import BeliefT, ImpactT

Floats = NDArray[np.float64]
Evidence = tuple[
    NDArray[np.int64], NDArray[np.int64]
]  # places (M,), distinct and increasing, and numbers (M,)


class Theory(ABC, Generic[BeliefT, ImpactT]):
    """A domain of vehicles that look, at the end of every step, at something that stays as it is.

    Evidence is whole numbers at places of a vector that add up, in any order: counts, log-likelihoods in
    fractions of a nat. Chance and what is true are arguments; a theory has no state beside its scenario.
    """

    scenario_type: ClassVar[type[OwnScenario]] = OwnScenario  # its fields, beside those of every domain
    example: ClassVar[Mapping[str, Any]]  # the scenario without a file

    def __init__(self, scenario: Any) -> None:
        """Take a scenario that is checked as far as its type goes; InputError for what cannot be."""
        self.scenario = scenario

    @property
    @abstractmethod
    def objective(self) -> Objective[BeliefT, ImpactT]:
        """The team's ``*`` and ``psi``."""

    @property
    @abstractmethod
    def codec(self) -> Codec[ImpactT]:
        """How impacts travel."""

    @property
    @abstractmethod
    def size(self) -> int:
        """How many numbers the evidence adds up."""

    @abstractmethod
    def truth(self, rng: np.random.Generator) -> Any:
        """Return what is there, which no vehicle knows."""

    @abstractmethod
    def sense(self, truth: Any, i: int, pose: Floats, rng: np.random.Generator) -> Any:
        """Return what vehicle i's sensor tells at a pose (3,) [m, m, rad]; None: nothing."""

    @abstractmethod
    def evidence(self, i: int, pose: Floats, told: Any) -> Evidence:
        """Return what that says, as whole numbers that add up over vehicles and steps."""

    @abstractmethod
    def belief(self, total: NDArray[np.int64]) -> BeliefT:
        """Return what a team knows whose evidence adds up to ``total`` (size,)."""

    @abstractmethod
    def impacts(self, belief: BeliefT, i: int, poses: Floats) -> Sequence[ImpactT]:
        """Return what vehicle i would add on N courses, poses (N, K, 3) at the ends of K steps."""

    @abstractmethod
    def figures(self, belief: BeliefT, truth: Any) -> Mapping[str, float]:
        """Return how well the team does, by name, always the same names: for summary and curves."""

    def image(self, belief: BeliefT) -> Floats | None:
        """Return what is known as numbers (R, C) over the area, row 0 the lowest y; None: no picture."""
        return None


def _wrong(part: Any) -> str | None:
    if not (isinstance(part, type) and issubclass(part, Theory)):
        return f"is {type(part).__name__}, not a class of Theory"
    if not (isinstance(part.scenario_type, type) and issubclass(part.scenario_type, OwnScenario)):
        return f"has {brief(part.scenario_type)} as scenario_type, not a class of OwnScenario"
    lacking = sorted(part.__abstractmethods__) + ([] if hasattr(part, "example") else ["example"])
    return f"lacks {', '.join(lacking)}" if lacking else None


MISSION: PartKind[type[Theory[Any, Any]]] = PartKind(
    "missions", "domain", {}, _wrong, "docs/how-to/own-domain.md"
)
