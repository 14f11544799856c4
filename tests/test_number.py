"""What counts as a number."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from vedette.number import is_number, is_whole


@pytest.mark.parametrize("value", [0, -3, 2.5, 1e308, np.float32(0.1), np.int8(4), Fraction(1, 3)])
def test_finite_real_numbers_are_numbers_whoever_made_them(value: object) -> None:
    assert is_number(value)
    assert is_whole(value) == isinstance(value, int | np.integer)


@pytest.mark.parametrize(
    "value", [True, np.True_, float("nan"), float("-inf"), np.float64("inf"), 10**400, 1j, "1", None, [1]]
)
def test_what_is_not_finite_or_real_is_no_number_and_nor_is_a_truth(value: object) -> None:
    assert not is_number(value)
    assert is_whole(value) == (type(value) is int)
