"""What a tour costs beside what it shows: a price on when it ends, the second integer of its impact."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.impact import PRICE_STEPS, Impact
from vedette.errors import InputError, brief
from vedette.kernels.coverage import LAYERS
from vedette.kernels.misses import SparseMisses
from vedette.number import is_number, many

LATEST = 3600.0  # a tour that ends later costs no more [s]


@dataclass(frozen=True)
class EndPrice:
    """``linear t + quadratic t^2 / 2`` for a tour that ends t seconds after the round's t0.

    In the unit of the objective, which takes it off. Equal for the whole team.  docs/theory.md (V195)
    """

    linear: float = 0.0  # a second
    quadratic: float = 0.0  # a second^2

    def __post_init__(self) -> None:
        """Raise ``InputError`` unless both are numbers >= 0."""
        for name in ("linear", "quadratic"):
            value = getattr(self, name)
            if not (is_number(value) and 0.0 <= value < math.inf):
                raise InputError(f"end_price: {name} must be a number >= 0; got {brief(value)}")

    def times(self, factor: float) -> EndPrice:
        """Return so many times the price."""
        return EndPrice(factor * self.linear, factor * self.quadratic)

    def of(self, end: float) -> int:
        """Return the price of an end [s], in steps, rounded to the nearest, halves up."""
        t = min(end, LATEST)
        return math.floor((self.linear + 0.5 * self.quadratic * t) * t * PRICE_STEPS + 0.5)

    def least(self, impact: SparseMisses, edges: NDArray[np.float64]) -> int:
        """Return what robots pay at least that show so much: one of them drives until the last layer begins.

        Args:
            impact: of robots, combined.
            edges: (LAYERS,) upper edge of each layer [s].
        """
        last = int((impact.keys % np.uint32(LAYERS)).max(initial=0))
        return self.of(float(edges[last - 1])) if last else 0

    def check(self, impact: Impact, robots: int, edges: NDArray[np.float64]) -> None:
        """Raise ``ValueError`` for a price that so many robots, combined, cannot have.

        No tour costs more than one that ends at ``LATEST``.  docs/theory.md (V196)

        Args:
            impact: of so many robots, combined.
            robots: how many.
            edges: (LAYERS,) upper edge of each layer [s].
        """
        if not impact.price and self == FREE:
            return
        least, most = self.least(impact, edges), robots * self.of(LATEST)
        if not least <= impact.price <= most:
            said, low, high = (price / PRICE_STEPS for price in (impact.price, least, most))
            costs = f"what it shows costs {many(robots, 'robot')} {low:.9g} to {high:.9g}"
            raise ValueError(f"impact has a price of {said:.9g}; {costs}")


FREE = EndPrice()
