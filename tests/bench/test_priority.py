"""The bench of priority areas: the quarter is the farthest, and verdicts are of medians of ratios."""

from __future__ import annotations

import numpy as np
import pytest

from bench.priority import ErrandResult, farthest_quarter, priority_table
from tests.support.small_missions import small_office


@pytest.mark.parametrize(
    ("start", "lowest", "highest"),
    [((1.0, 1.0), (6.0, 5.0), (12.0, 10.0)), ((11.0, 9.0), (0.0, 0.0), (6.0, 5.0))],
)
def test_the_quarter_is_the_one_farthest_from_where_robots_start(
    start: tuple[float, float], lowest: tuple[float, float], highest: tuple[float, float]
) -> None:
    corners = np.array(farthest_quarter(small_office(), np.array([(*start, 0.0)])))
    assert corners.min(axis=0) == pytest.approx(lowest)
    assert corners.max(axis=0) == pytest.approx(highest)


def result(seed: int, ordered: bool, quarter: float | None, rest: float) -> ErrandResult:
    """How a mission went."""
    return ErrandResult(seed, ordered, "complete", quarter, rest, 200.0, "abc")


def test_medians_of_ratios_decide_and_who_never_got_there_was_infinitely_late() -> None:
    results = [
        *(result(1, False, 100.0, 100.0), result(1, True, 50.0, 110.0)),
        *(result(2, False, 100.0, 100.0), result(2, True, 70.0, 104.0)),
        *(result(3, False, 100.0, 100.0), result(3, True, None, 90.0)),
        result(4, False, 100.0, 100.0),  # its pair has not been run yet
    ]
    told = priority_table(results)
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in told.splitlines() if "|" in line
    ]
    assert rows[2:] == [
        ["1", "0.5", "1.1", "1"],
        ["2", "0.7", "1.04", "1"],
        ["3", "-", "0.9", "1"],
        ["median", "0.7", "1.04", "1"],
    ]
    assert "quarter asked at most 0.8: MET; rest at most 1.05: MET" in told
