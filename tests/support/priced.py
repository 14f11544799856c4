"""Coverage with prices, for the theory of prices: small random teams, and all their joint choices."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np

from tests.support.random_teams import Float, misses
from vedette import Objective
from vedette.problem import Reach

TICK = 1.0 / 1024.0  # prices are whole numbers of it, so that their sums are exact


class PricedCoverage(Objective[Float, Float]):
    """``Coverage`` of impacts whose last number is a price: misses multiply, prices add.

    Cell s lies at x = s, so that messages can leave out cells that nobody beyond a link changes.
    """

    monotone = submodular = True

    def nothing(self, belief: Float) -> Float:
        """Nothing seen, nothing to pay."""
        return np.append(np.ones(len(belief)), 0.0)

    def combine(self, a: Float, b: Float) -> Float:
        """Products, and a sum."""
        both: Float = a * b
        both[-1] = a[-1] + b[-1]
        return both

    def value(self, belief: Float, impact: Float) -> float:
        """What is seen, less the price."""
        return float(np.sum(belief * (1.0 - impact[:-1])) - impact[-1])

    def price(self, impact: Float) -> float:
        """The last number."""
        return float(impact[-1])

    def thin(self, impact: Float, chance: float) -> Float:
        """Seen, and paid for, with a chance."""
        thin: Float = 1.0 - chance * (1.0 - impact)
        thin[-1] = chance * impact[-1]
        return thin

    def clip(self, belief: Float, impact: Float, reach: Reach) -> Float:
        """Keep the cells that lie in the boxes, and the price."""
        x = np.arange(len(belief))
        inside = np.ones(len(impact), bool)
        inside[:-1] = np.any([(low <= x) & (x <= high) for low, _, high, _ in reach] or [x < 0], axis=0)
        return np.where(inside, impact, 1.0)


PRICED = PricedCoverage()


def priced(rng: np.random.Generator, own: Sequence[Float], most: float) -> list[Float]:
    """Give each impact a price up to ``most``; a third are free."""
    prices = TICK * rng.integers(0, max(1, round(most / TICK)), len(own)) * (rng.random(len(own)) < 0.7)
    return [np.append(impact, price) for impact, price in zip(own, prices, strict=True)]


@dataclass(frozen=True)
class Team:
    """A problem small enough to look at everything."""

    weights: Float
    candidates: list[list[Float]]

    @classmethod
    def random(cls, rng: np.random.Generator, n: int, k: int, cells: int = 12, dear: float = 2.0) -> Team:
        """Draw one, whose prices are up to ``dear``: some choices are worth it, and some are not."""
        return cls(rng.uniform(size=cells), [priced(rng, own, dear) for own in misses(rng, n, k, cells)])

    def choices(self) -> Iterator[tuple[int, ...]]:
        """Yield all joint choices."""
        yield from itertools.product(*(range(len(own)) for own in self.candidates))

    def worth(self, choice: Sequence[int], counts: float = 1.0) -> float:
        """Return J, its prices counted so many times."""
        return self.gross(choice) - counts * self.price(choice)

    def gross(self, choice: Sequence[int]) -> float:
        """Return what is seen."""
        left = [own[k][:-1] for own, k in zip(self.candidates, choice, strict=True)]
        return float(np.sum(self.weights * (1.0 - reduce(np.multiply, left))))

    def price(self, choice: Sequence[int]) -> float:
        """Return what that costs."""
        return float(sum(own[k][-1] for own, k in zip(self.candidates, choice, strict=True)))

    def optimum(self) -> float:
        """Return the most that J can be."""
        return max(map(self.worth, self.choices()))

    def alternatives(self, choice: Sequence[int]) -> Iterator[tuple[int, ...]]:
        """Yield the joint choices in which one platform, at most, has changed."""
        for i, own in enumerate(self.candidates):
            for k in range(len(own)):
                yield (*choice[:i], k, *choice[i + 1 :])

    def is_equilibrium(self, choice: Sequence[int], counts: float = 1.0) -> bool:
        """Tell whether nobody gains alone."""
        here = self.worth(choice, counts)
        return all(self.worth(other, counts) <= here + 1e-12 for other in self.alternatives(choice))

    def equilibria(self, counts: float = 1.0) -> Iterator[tuple[int, ...]]:
        """Yield all of them."""
        yield from (choice for choice in self.choices() if self.is_equilibrium(choice, counts))
