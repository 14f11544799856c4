"""What ``coverage.best_tour`` computes, to the last bit, but that every stop is priced at every step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.coverage import LAYERS, TourProblem
from vedette.kernels.misses import CERTAIN, STEPS_PER_NAT

Singles = NDArray[np.float32]
ZERO, ONE, HAIR, LATEST = np.float32(0.0), np.float32(1.0), np.float32(1e-4), np.float32(1e3)
HARDLY = 1e-9  # a tour is better that is so by more than this share
ROUNDS = 4  # of moves and turns
_MISS = np.array([math.exp(-q / STEPS_PER_NAT) for q in range(CERTAIN)] + [0.0])
_SEEN = (1.0 - _MISS).astype(np.float32)


class EagerTours:
    """One platform's search for a tour; single precision, in the order in which the kernel adds."""

    def __init__(self, problem: TourProblem, max_stops: int) -> None:
        self._problem, self._max_stops = problem, max_stops
        cells, others = np.unique(problem.footprints.cells), dict(zip(*problem.others, strict=True))
        self._weight = dict(zip(cells.tolist(), problem.weights.of(cells), strict=True))
        self._left = dict(self._weight)  # worth times own miss so far
        self._added = {
            cell: tuple(int(others.get(cell * LAYERS + layer, 0)) for layer in range(LAYERS))
            for cell in cells.tolist()
        }
        reached = problem.first_leg[np.isfinite(problem.first_leg)]
        self._stay = reached.max(initial=ZERO)
        self._discounts = {added: _suffix_sums(problem, added) for added in set(self._added.values())}

    def best(
        self, current: Sequence[int], stickiness: float, margin: float = 0.0
    ) -> tuple[list[int], float, float]:
        """Return the best tour found, its marginal value, and that of the present one."""
        best = self._search([], 0)
        if current:
            kept = self._search(list(current), 1)
            shown = _score(self._value(kept), self._end(kept))
            if self._score(best) <= shown * (1.0 + stickiness) - self._price(self._end(kept)) + margin:
                best = kept
        return best, self._net(best), self._net(current)

    def _search(self, tour: list[int], held: int) -> list[int]:
        self._insert(tour, held)
        tour = self._improved(tour, held)
        self._insert(tour, held)
        return tour

    def _insert(self, tour: list[int], held: int) -> None:
        while len(tour) < min(self._max_stops, len(self._problem.first_leg)):
            gain, stop, place = self._best_insertion(tour, held)
            before = self._score(tour)
            if gain <= 0.0 or self._score([*tour[:place], stop, *tour[place:]]) <= before:
                return
            tour.insert(place, stop)

    def _best_insertion(self, tour: list[int], held: int) -> tuple[np.float32, int, int]:
        """Return the gain of the best stop, the stop, and its place: of equal ones the lowest, foremost."""
        present = []
        for stop in tour:
            present.append(self._by_layer(self._entries(stop)))
            self._observe(stop)
        best = (ZERO, 0, 0)
        for stop in range(len(self._problem.first_leg)):
            if stop in tour:
                continue
            gain, place = self._best_place(stop, self._by_layer(self._entries(stop)), tour, held, present)
            if gain > best[0]:
                best = (gain, stop, place)
        self._left = dict(self._weight)
        return best

    def _best_place(
        self, stop: int, table: Singles, tour: list[int], held: int, present: list[Singles]
    ) -> tuple[np.float32, int]:
        best, arrivals = (ZERO, 0), self._arrivals(tour)
        for place in range(held, len(tour) + 1):
            start = arrivals[place - 1] if place else ZERO
            arrival = start + self._leg(tour[place - 1] if place else None, stop)
            if not np.isfinite(arrival):
                continue
            gain, end = table[self._layer(arrival)], arrival
            if gain <= 0.0:
                continue
            if place < len(tour):
                delay = arrival + self._leg(stop, tour[place]) - arrivals[place]
                if not np.isfinite(delay):
                    continue
                end = arrivals[-1] + delay
                for later, worth in zip(arrivals[place:], present[place:], strict=True):
                    gain += worth[self._layer(later + delay)] - worth[self._layer(later)]
            gain *= ONE - HAIR * min(arrival, LATEST) / LATEST
            gain -= np.float32(self._price(end) - self._price(self._end(tour)))
            if gain > best[0]:
                best = (gain, place)
        return best

    def _improved(self, tour: list[int], held: int) -> list[int]:
        """Move a stop or turn a stretch round as long as that helps."""
        best = self._order_score(tour, tour)
        for _ in range(ROUNDS):
            before = best
            for i in range(held, len(tour)):
                for j in range(held, len(tour)):
                    if i == j:
                        continue
                    for turn in (False, True) if i + 1 < j else (False,):
                        other = list(tour)
                        if turn:
                            other[i : j + 1] = other[i : j + 1][::-1]
                        else:
                            other.insert(j, other.pop(i))
                        score = self._order_score(tour, other)
                        if score > best + HARDLY * abs(best):
                            tour, best = other, score
            if best <= before:
                break
        return tour

    def _order_score(self, together: Sequence[int], order: Sequence[int]) -> float:
        """Return the score of an order; cells that only one stop sees are summed apart from shared ones."""
        arrivals = self._arrivals(order)
        if not np.isfinite(arrivals).all():
            return -np.inf
        count: dict[int, int] = {}
        for cell, _ in (entry for stop in together for entry in self._entries(stop)):
            count[cell] = count.get(cell, 0) + 1
        layers = [self._layer(arrival) for arrival in arrivals]
        most = [
            float(self._by_layer(self._entries(s))[layer]) for s, layer in zip(order, layers, strict=True)
        ]
        value = sum(most)
        for stop, layer, alone_at_most in zip(order, layers, most, strict=True):
            entries = self._entries(stop)
            total = self._by_layer([entry for entry in entries if count[entry[0]] == 1])[layer]
            for cell, seen in (entry for entry in entries if count[entry[0]] > 1):
                part = seen * self._left[cell]
                total += part * self._discounts[self._added[cell]][layer]
                self._left[cell] -= part
            value += float(total) - alone_at_most
        self._left = dict(self._weight)
        end = arrivals[-1] if len(arrivals) else ZERO
        return _score(value, end) - self._price(end)

    def _value(self, tour: Sequence[int]) -> float:
        value = 0.0
        for stop, arrival in zip(tour, self._arrivals(tour), strict=True):
            if not np.isfinite(arrival):
                value = -np.inf
                break
            total = ZERO
            for cell, seen in self._entries(stop):
                part = seen * self._left[cell]
                total += part * self._discounts[self._added[cell]][self._layer(arrival)]
                self._left[cell] -= part
            value += float(total)
        self._left = dict(self._weight)
        return value

    def _score(self, tour: Sequence[int]) -> float:
        end = self._end(tour)
        return _score(self._value(tour), end) - self._price(end)

    def _net(self, tour: Sequence[int]) -> float:
        return self._value(tour) - self._price(self._end(tour))

    def _end(self, tour: Sequence[int]) -> np.float32:
        end: np.float32 = self._arrivals(tour)[-1] if len(tour) else self._stay
        return end

    def _price(self, end: np.float32) -> float:
        """Return what a tour costs that ends then [s]; to stay costs what the farthest stop does."""
        linear, quadratic = self._problem.end_price
        t = min(float(end), 3600.0)
        return (linear + 0.5 * quadratic * t) * t

    def _by_layer(self, entries: Sequence[tuple[int, np.float32]]) -> Singles:
        """Return what entries add in every layer; cells that the others see alike are summed first."""
        sums: dict[tuple[int, ...], np.float32] = {}
        for cell, seen in entries:
            added = self._added[cell]
            sums[added] = sums.get(added, ZERO) + seen * self._left[cell]
        by_layer = np.zeros(LAYERS, np.float32)
        for added, total in sums.items():
            by_layer += total * self._discounts[added]
        return by_layer

    def _entries(self, stop: int) -> list[tuple[int, np.float32]]:
        marks = self._problem.footprints
        row = slice(marks.starts[stop], marks.starts[stop + 1])
        return list(zip(marks.cells[row].tolist(), _SEEN[marks.misses[row]], strict=True))

    def _observe(self, stop: int) -> None:
        for cell, seen in self._entries(stop):
            self._left[cell] *= ONE - seen

    def _arrivals(self, tour: Sequence[int]) -> Singles:
        legs = [self._leg(None, stop) for stop in tour[:1]] + [self._leg(a, b) for a, b in pairwise(tour)]
        return np.cumsum(np.array(legs, np.float32), dtype=np.float32)

    def _leg(self, start: int | None, end: int) -> np.float32:
        leg: np.float32 = self._problem.first_leg[end] if start is None else self._problem.legs[start, end]
        return leg

    def _layer(self, arrival: np.float32) -> int:
        return min(int(np.searchsorted(self._problem.edges, float(arrival))), LAYERS - 1)


def _suffix_sums(problem: TourProblem, added: tuple[int, ...]) -> Singles:
    """Return for every layer the sum over it and all later ones of its weight times the others' miss."""
    total = np.minimum(np.cumsum(added), CERTAIN)
    return np.cumsum((problem.layer_weights * _MISS[total])[::-1])[::-1].astype(np.float32)


def _score(value: float, end: np.float32) -> float:
    return value * (1.0 - 1e-4 * float(min(end, LATEST)) / 1e3)
