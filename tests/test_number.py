"""What counts as a number, and how numbers are told."""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np
import pytest

from tests.support.places import ROOT
from vedette.number import is_number, is_whole, many, short


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


@pytest.mark.parametrize(("count", "said"), [(0, "0 robots"), (1, "1 robot"), (2, "2 robots")])
def test_one_of_something_is_told_in_the_singular(count: int, said: str) -> None:
    assert many(count, "robot") == said


_BARE = re.compile(r"\{(?!MOST)[^{}]*\} (robots|vehicles|targets|runs|places|rows|numbers|collisions)\b")


def test_no_message_counts_in_the_plural_what_may_be_one() -> None:
    more_than_one = ("for at most", "robots do not fit", "are too many", "at least one of each", "are due")
    lines = [
        line.strip()
        for path in (ROOT / "src").rglob("*.py")
        for line in path.read_text(encoding="utf-8").splitlines()
        if _BARE.search(line) and not any(said in line for said in more_than_one)
    ]
    assert lines == []


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (0.012345, "0.0123"), (148.2, "148"), (999.6, "1000"), (-1436.7, "-1437"), (2e12, "2e+12")],
)
def test_numbers_are_told_in_three_digits_and_whole_where_that_is_more(value: float, text: str) -> None:
    assert short(value) == text
