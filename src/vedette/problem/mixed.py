"""Several objectives as one: impacts are tuples, values a weighted sum."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError, brief
from vedette.number import is_number
from vedette.problem.objective import Codec, Objective

Parts: TypeAlias = tuple[Any, ...]  # one of each objective: beliefs, or impacts


@dataclass(frozen=True)
class WeightedSum(Objective[Parts, Parts]):
    """``psi(x_1, ..., x_m) = sum_j w_j psi_j(x_j)`` with ``*`` by parts; docs/theory.md (V130).

    It is monotone where all parts are, and submodular where all are, for weights are not negative. The belief
    is a tuple too.

    Raises:
        InputError: no objectives, not a weight each, or one that is negative or no number.
    """

    objectives: tuple[Objective[Any, Any], ...]
    weights: tuple[float, ...]  # from the unit of each objective to that of the sum

    def __post_init__(self) -> None:
        if not self.objectives or len(self.objectives) != len(self.weights):
            raise InputError(
                f"{len(self.objectives)} objectives and {len(self.weights)} weights; give a weight each"
            )
        for weight in self.weights:
            if not is_number(weight) or not math.isfinite(weight) or weight < 0.0:
                raise InputError(f"weights must be numbers >= 0; got {brief(weight)}")

    @property
    def monotone(self) -> bool:  # type: ignore[override]
        """Whether all parts that count are."""
        return all(part.monotone for part in self._counting)

    @property
    def submodular(self) -> bool:  # type: ignore[override]
        """Whether all parts that count are."""
        return all(part.submodular for part in self._counting)

    @property
    def _counting(self) -> list[Objective[Any, Any]]:
        return [part for part, weight in zip(self.objectives, self.weights, strict=True) if weight > 0.0]

    def nothing(self, belief: Parts) -> Parts:
        """Return nothing in each part."""
        return tuple(part.nothing(of) for part, of in zip(self.objectives, belief, strict=True))

    def combine(self, a: Parts, b: Parts) -> Parts:
        """``a * b`` by parts."""
        return tuple(part.combine(x, y) for part, x, y in zip(self.objectives, a, b, strict=True))

    def value(self, belief: Parts, impact: Parts) -> float:
        """Return the weighted sum."""
        parts = zip(self.objectives, self.weights, belief, impact, strict=True)
        return float(sum(weight * part.value(of, x) for part, weight, of, x in parts))

    def price(self, impact: Parts) -> float:
        """Return the weighted sum of what is a price."""
        parts = zip(self.objectives, self.weights, impact, strict=True)
        return float(sum(weight * part.price(x) for part, weight, x in parts))

    def values(self, belief: Parts, others: Parts, own: Sequence[Parts]) -> NDArray[np.float64]:
        """Return the weighted sums, each part's values in one go."""
        total = np.zeros(len(own))
        for j, (part, weight) in enumerate(zip(self.objectives, self.weights, strict=True)):
            total += weight * part.values(belief[j], others[j], [impact[j] for impact in own])
        return total

    def wrong_belief(self, belief: Parts) -> str | None:
        """Return what is wrong with a belief in the first part that refuses its own."""
        if not isinstance(belief, tuple) or len(belief) != len(self.objectives):
            return f"must be a tuple of {len(self.objectives)}, one for each objective"
        told = (part.wrong_belief(of) for part, of in zip(self.objectives, belief, strict=True))
        return next((wrong for wrong in told if wrong is not None), None)

    def wrong_impact(self, belief: Parts, own: Sequence[Parts]) -> tuple[int, str] | None:
        """Return the first impact that is none, and why."""
        for k, impact in enumerate(own):
            if not isinstance(impact, tuple) or len(impact) != len(self.objectives):
                return k, f"must be a tuple of {len(self.objectives)}, one for each objective"
        for j, part in enumerate(self.objectives):
            wrong = part.wrong_impact(belief[j], [impact[j] for impact in own])
            if wrong is not None:
                return wrong
        return None


@dataclass(frozen=True)
class PartsCodec:
    """Impacts of several parts as bytes, each as its own codec has it, after its length."""

    codecs: tuple[Codec[Any], ...]

    def encode(self, impact: Parts) -> bytes:
        """Return the impact as bytes."""
        parts = [codec.encode(part) for codec, part in zip(self.codecs, impact, strict=True)]
        return b"".join(len(part).to_bytes(4, "big") + part for part in parts)

    def decode(self, data: bytes) -> Parts:
        """Return the impact; ValueError if it is malformed."""
        impact, at = [], 0
        for codec in self.codecs:
            size = int.from_bytes(data[at : at + 4], "big")
            part = data[at + 4 : at + 4 + size]
            if len(part) != size or at + 4 > len(data):
                raise ValueError(f"a part of {len(data)} bytes is cut")
            impact.append(codec.decode(part))
            at += 4 + size
        if at != len(data):
            raise ValueError(f"{len(data) - at} bytes are more than {len(self.codecs)} parts have")
        return tuple(impact)
