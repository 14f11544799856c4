"""Combining many parts of which any can be replaced or left out."""

from __future__ import annotations

from collections import Counter
from functools import reduce

import numpy as np
import pytest

from vedette.negotiation.fold import Fold


@pytest.mark.parametrize("size", [0, 1, 2, 3, 4, 5, 8, 13, 64])
def test_total_and_leave_one_out_are_those_of_brute_force_after_any_changes(size: int) -> None:
    rng = np.random.default_rng(size)
    fold: Fold[Counter[str]] = Fold(size, lambda a, b: a + b)
    parts: dict[int, Counter[str]] = {}
    assert fold.total is None
    for _ in range(3 * size):
        place = int(rng.integers(size))
        parts[place] = Counter(str(letter) for letter in rng.choice(list("abc"), 4))
        fold.put(place, parts[place])
        assert fold.total == sum(parts.values(), Counter())
        for k in range(size):
            rest = [part for other, part in parts.items() if other != k]
            assert fold.without(k) == (reduce(lambda a, b: a + b, rest) if rest else None)
            assert fold[k] == parts.get(k)


def test_leaving_out_one_of_many_takes_few_combinations() -> None:
    count = 0

    def add(a: int, b: int) -> int:
        nonlocal count
        count += 1
        return a + b

    fold: Fold[int] = Fold(1024, add)
    for place in range(1024):
        fold.put(place, 1)
    assert count == 0  # nobody has asked
    assert fold.total == 1024
    assert count == 1023
    count = 0
    fold.put(17, 2)
    assert (fold.total, fold.without(17)) == (1025, 1023)
    assert count <= 20
