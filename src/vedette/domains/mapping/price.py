"""What a tour costs beside what it shows: a price on when it ends, the second integer of its impact."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vedette.domains.mapping.impact import PRICE_STEPS, Impact
from vedette.errors import InputError, brief
from vedette.number import is_number, many

LATEST = 3600.0  # a tour that ends later costs no more [s]
DEAREST = 1 << 45  # steps; so the prices of a thousand robots are written in seven bytes


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
        """Return the price of an end [s], in whole steps, halves up; ``DEAREST`` at most."""
        t = min(end, LATEST)
        return math.floor(min((self.linear + 0.5 * self.quadratic * t) * t * PRICE_STEPS + 0.5, DEAREST))

    def check(self, impact: Impact, robots: int) -> None:
        """Raise ``ValueError`` for a price that so many robots, combined, cannot have.

        No tour costs more than one that ends at ``LATEST``.  docs/theory.md (V196)
        """
        most = robots * self.of(LATEST)
        if not 0 <= impact.price <= most:
            said, high = (price / PRICE_STEPS for price in (impact.price, most))
            raise ValueError(
                f"impact has a price of {said:.9g}; {many(robots, 'robot')} cost 0 to {high:.9g}"
            )


FREE = EndPrice()
