"""The statistics of a study: closed forms, counts by hand, and pairs that are pairs."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

from vedette.study.bootstrap import mean_band, mean_interval, ratio_interval
from vedette.study.compare import by_draw, difference, mean
from vedette.study.curves import CurvesOf, at, averaged, lowest, time_axis
from vedette.study.facets import AXES, Facet, cells, margins, overview, panels
from vedette.study.metrics import AUC, TIMES, TOTAL
from vedette.study.mission import RunResult
from vedette.study.rows import Row
from vedette.study.tables import difference_rows, mean_rows

T90 = TIMES[1]


def row(planner: str, world: str = "maze", seed: int = 0, robots: int = 1, **figures: Any) -> Row:
    """A run's row; the case is all but the planner."""
    axes = dict.fromkeys(AXES) | {"world": world, "robots": robots, "starts": figures.pop("starts", "apart")}
    case = f"{world} {seed} {robots} {axes['starts']}"
    known = {"completed": True, "error": "", "t90_s": 1.0, "bound_t90_s": 0.5}
    return {
        "case": case,
        "planner": planner,
        "world_id": f"{world} {seed}",
        "seed": 0,
        **axes,
        **known,
        **figures,
    }


# -- intervals ----------------------------------------------------------------------------------------


def test_the_interval_of_many_normal_draws_is_the_closed_form() -> None:
    samples = np.random.default_rng(3).normal(10.0, 2.0, 400)
    found = mean_interval(samples)
    half = 1.96 * samples.std() / math.sqrt(400)
    assert found.value == samples.mean()
    assert found.low == pytest.approx(samples.mean() - half, abs=0.1 * half)
    assert found.high == pytest.approx(samples.mean() + half, abs=0.1 * half)


def test_nine_in_ten_and_more_intervals_hold_the_truth() -> None:
    rng = np.random.default_rng(0)
    held = [(i := mean_interval(rng.exponential(1.0, 30))).low <= 1.0 <= i.high for _ in range(120)]
    assert 0.88 <= np.mean(held) <= 0.99


def test_the_interval_goes_along_with_shift_and_scale() -> None:
    samples = np.array([1.0, 4.0, 2.0, 8.0, 5.0])
    one, other = mean_interval(samples), mean_interval(3.0 * samples + 7.0)
    assert [other.low, other.high] == pytest.approx([3.0 * one.low + 7.0, 3.0 * one.high + 7.0])


def test_few_or_equal_draws_have_the_interval_that_they_can_have() -> None:
    assert math.isnan(mean_interval(np.array([4.0])).low)
    same = mean_interval(np.array([4.0, 4.0, 4.0]))
    assert (same.low, same.value, same.high) == (4.0, 4.0, 4.0)
    two = mean_interval(np.array([1.0, 3.0]))
    assert (two.low, two.high) == (1.0, 3.0)


def test_the_ratio_of_pairs_knows_that_they_are_pairs() -> None:
    below = np.random.default_rng(1).uniform(1.0, 100.0, 20)
    exact = ratio_interval(0.6 * below, below)
    assert [exact.low, exact.value, exact.high] == pytest.approx([0.6, 0.6, 0.6])
    apart = ratio_interval(0.6 * below[::-1], below)
    assert apart.value == pytest.approx(0.6)
    assert apart.high - apart.low > 0.1
    assert math.isnan(ratio_interval(below, np.zeros(20)).value)


def test_the_band_of_curves_is_the_percentiles_of_all_resamples() -> None:
    curves = np.array([[0.0, 5.0], [1.0, 5.0], [5.0, 6.0]])
    means = [np.mean(chosen, axis=0) for chosen in itertools.product(curves, repeat=3)]
    low, high = mean_band(curves)
    assert low == pytest.approx(np.percentile(means, 2.5, axis=0, method="inverted_cdf"))
    assert high == pytest.approx(np.percentile(means, 97.5, axis=0, method="inverted_cdf"))


# -- means and differences ----------------------------------------------------------------------------


def test_runs_in_one_draw_are_averaged_before_the_draws() -> None:
    assert by_draw([(("a", 0), 1.0), (("a", 0), 3.0), (("b", 0), 10.0)]).tolist() == [2.0, 10.0]


def test_a_mean_counts_what_is_missing_and_leaves_it_out() -> None:
    rows = [
        row("tours", seed=0, t90_s=10.0),
        row("tours", seed=1, t90_s=None),
        row("tours", seed=2, t90_s=30.0),
        row("burgard", seed=0, t90_s=99.0),
    ]
    found = mean(rows, "tours", T90)
    assert (found.interval.value, found.reached, found.runs, found.bound) == (20.0, 2, 3, 0.5)


def test_total_and_area_are_of_complete_missions_only() -> None:
    early = row("tours", completed=False, time_s=5.0, auc_s=1.0)
    assert TOTAL.of(early) is AUC.of(early) is None
    assert T90.of(early) == 1.0


def test_differences_pair_the_same_cases_and_no_others() -> None:
    rows = [
        row("tours", seed=0, t90_s=10.0),
        row("burgard", seed=0, t90_s=15.0),
        row("burgard", seed=1, t90_s=40.0),
        row("tours", seed=1, t90_s=20.0),
        row("tours", seed=2, t90_s=1.0),
        row("burgard", seed=2, t90_s=None),
        row("tours", seed=3, t90_s=500.0),
    ]
    found = difference(rows, "tours", "burgard", T90)
    assert (found.pairs, found.left_out, found.lower, found.higher) == (2, 1, 2, 0)
    assert found.difference.value == pytest.approx((-5.0 - 20.0) / 2)
    assert found.ratio.value == pytest.approx(30.0 / 55.0)
    assert (found.difference.low, found.difference.high) == (-20.0, -5.0)


def test_a_planner_does_not_differ_from_itself() -> None:
    rows = [row(name, seed=seed, t90_s=float(seed)) for seed in range(1, 6) for name in ("a", "b")]
    found = difference(rows, "a", "b", T90)
    assert (found.difference.low, found.difference.high, found.ratio.value) == (0.0, 0.0, 1.0)


def test_without_pairs_there_is_no_difference() -> None:
    found = difference([row("a"), row("b", seed=1)], "a", "b", T90)
    assert math.isnan(found.difference.value)
    assert found.pairs == found.left_out == 0


# -- facets -------------------------------------------------------------------------------------------

GRID = [
    row(planner, world, seed, robots, starts=starts)
    for planner in ("a", "b")
    for world in ("maze", "cave")
    for seed in (0, 1)
    for robots in (3, 1)
    for starts in ("apart", "together")
]


def test_facets_part_the_runs() -> None:
    assert len(cells(GRID)) == 8
    assert sum(len(facet.of(GRID)) for facet in cells(GRID)) == len(GRID)
    assert [str(facet) for facet in margins(GRID)] == [
        "maze", "cave", "1 robot", "3 robots", "starts apart", "starts together",
    ]  # fmt: skip
    assert [[str(facet) for facet in line] for line in panels(GRID)] == [
        ["maze, 1 robot", "maze, 3 robots"], ["cave, 1 robot", "cave, 3 robots"],
    ]  # fmt: skip
    assert [str(facet) for facet in overview(GRID)][4:] == ["starts apart", "starts together"]
    assert Facet().of(GRID) == GRID


def test_what_a_study_varies_has_panels_whatever_it_is() -> None:
    rows = [row("a", seed=seed, link_loss=loss) for seed in (0, 1) for loss in (0.0, 0.3)]
    assert [[str(f) for f in line] for line in panels(rows)] == [
        ["link loss 0.0, maze"], ["link loss 0.3, maze"],
    ]  # fmt: skip
    assert [[str(f) for f in line] for line in panels([row("a")])] == [["maze, 1 robot"]]


def test_the_tables_have_a_row_for_each_facet_planner_and_metric() -> None:
    means, differences = mean_rows(GRID), difference_rows(GRID, "a")
    assert len({(r["world"], r["robots"], r["starts"], r["planner"], r["metric"]) for r in means}) == len(
        means
    )
    assert len({(r["world"], r["robots"], r["starts"], r["metric"]) for r in differences}) == len(differences)
    whole = [r for r in differences if r["world"] is r["robots"] is r["starts"] is None]
    assert {r["pairs"] for r in whole if r["metric"] == "t90_s"} == {16}


# -- curves -------------------------------------------------------------------------------------------


def test_a_curve_is_a_step_function_that_begins_with_nothing_known() -> None:
    times = np.array([0.0, 0.9, 1.0, 1.5, 2.0, 9.0])
    assert at(((1.0, 2.0), (0.4, 0.1)), times).tolist() == [1.0, 1.0, 0.4, 0.4, 0.1, 0.1]


def test_curves_are_averaged_within_draws_and_runs_that_broke_are_left_out() -> None:
    rows = [row("a", seed=0), row("a", seed=0, starts="together"), row("a", seed=1), row("a", seed=2)]
    ends = {rows[0]["case"]: 0.0, rows[1]["case"]: 0.2, rows[2]["case"]: 0.5}
    curves: CurvesOf = {
        (each["case"], "a"): RunResult({}, {}, (1.0,), (ends[each["case"]],), (0.0, 1.0), (0.9, 0.0))
        if each["case"] in ends
        else RunResult({}, {}, (), (), (), ())
        for each in rows
    }
    times = np.array([0.0, 2.0])
    found = averaged(rows, curves, times)
    assert found is not None
    assert found.mean.tolist() == [1.0, pytest.approx((0.1 + 0.5) / 2)]
    least = lowest(rows, curves, times)
    assert least is not None
    assert least.tolist() == pytest.approx([0.9, 0.0])
    assert time_axis(rows, curves, [rows])[-1] == pytest.approx(1.0)
    assert averaged(rows[3:], curves, times) is None
