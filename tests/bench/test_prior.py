"""What an old map brings is a ratio of times in the same worlds."""

from __future__ import annotations

from bench.prior import prior_table, run_case
from bench.ways import Case, Timed


def ended(way: str, seed: int, time: float, t99: float | None = 50.0) -> Timed:
    return Timed("cave", 3, way, seed, "complete", 0.999, time / 2, t99, time, 1.0, "abc")


def test_ratios_are_of_pairs_in_the_same_world_and_of_those_that_were_reached() -> None:
    results = [
        ended("none", 1, 100.0),
        ended("right", 1, 80.0),
        ended("none", 2, 200.0),
        ended("right", 2, 90.0),
    ]
    results += [ended("right", 3, 1.0), ended("wrong", 1, 110.0, None)]
    lines = prior_table(results).splitlines()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines if " / " in line]
    right = next(row for row in rows if row[2] == "right / none")
    assert right[3] == "2"
    assert right[6].startswith("0.60 (")  # the square root of 0.8 * 0.45
    wrong = next(row for row in rows if row[2] == "wrong / none")
    assert wrong[5] == "-"


def test_a_case_runs_with_the_map_of_another_world() -> None:
    assert run_case(Case("cave", 1, "wrong", 4), "abc").outcome == "complete"
