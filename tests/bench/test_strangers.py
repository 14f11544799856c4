"""The bench of teams that share no frame: ratios are of pairs that were both run, and medians decide."""

from __future__ import annotations

import pytest

from bench.strangers import Arm, StrangersResult, strangers_table


def result(seed: int, arm: Arm, time: float, wrong: float = 0.0) -> StrangersResult:
    """How a mission went."""
    joined = None if arm == "known" else 12.0
    return StrangersResult(seed, arm, "complete", time, time / 2.0, 1.0, wrong, joined, 0, "abc")


def test_ratios_are_of_worlds_that_were_run_both_ways_and_their_median_decides() -> None:
    results = [
        *(result(1, "known", 100.0), result(1, "unknown", 110.0), result(1, "seeking", 120.0)),
        *(result(2, "known", 100.0), result(2, "unknown", 200.0)),
        *(result(3, "known", 100.0), result(3, "unknown", 105.0)),
        result(4, "known", 100.0),
    ]
    told = strangers_table(results)
    lines = [line for line in told.splitlines() if "|" in line]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    assert [row[2] for row in rows[2:]] == ["1.1", "2", "1.05"]
    assert rows[2][4] == "1.2"
    assert "median to the end of 3 worlds 1.10, asked at most 1.15: MET" in told


@pytest.mark.parametrize(("slow", "wrong", "says"), [(1.2, 0.0, "MISSED; wrong"), (1.0, 0.02, "1%: MISSED")])
def test_what_is_not_reached_is_told(slow: float, wrong: float, says: str) -> None:
    results = [result(1, "known", 100.0), result(1, "unknown", 100.0 * slow, wrong)]
    assert says in strangers_table(results)
