"""The statistics of a study: closed forms, counts by hand, and pairs that are pairs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy
from scipy import stats

from vedette.study.compare import by_draw, difference, mean
from vedette.study.curves import CurvesOf, at, averaged, lowest, time_axis
from vedette.study.facets import AXES, Facet, cells, margins, overview, panels
from vedette.study.intervals import draws_needed, mean_band, mean_interval, ratio_interval
from vedette.study.metrics import AUC, TIMES, TOTAL
from vedette.study.mission import RunResult
from vedette.study.ratios import ratios
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


def test_the_interval_of_the_mean_is_the_one_of_the_textbook() -> None:
    samples = np.array([10.2, 9.1, 11.4, 10.9, 8.7])
    found = mean_interval(samples)
    half = 2.776445 * samples.std(ddof=1) / math.sqrt(5)  # t of 4 degrees of freedom, from a table
    assert found.value == samples.mean()
    assert (found.low, found.high) == pytest.approx((samples.mean() - half, samples.mean() + half))


@pytest.mark.parametrize("draws", [4, 10, 30])
def test_95_of_100_intervals_of_ratios_hold_the_truth_however_few_the_worlds(draws: int) -> None:
    rng, studies, skew = np.random.default_rng(draws), 3000, 12.0
    truth = 0.9 * math.exp(scipy.special.digamma(skew)) / skew  # geometric mean of what is drawn below
    held = 0
    for _ in range(studies):
        below = rng.lognormal(5.0, 0.4, draws)  # worlds differ much
        found = ratio_interval(0.9 * below * rng.gamma(skew, 1.0 / skew, draws), below)
        held += found.low <= truth <= found.high
    assert held / studies == pytest.approx(0.95, abs=4.0 * math.sqrt(0.95 * 0.05 / studies))


def test_the_interval_goes_along_with_shift_and_scale() -> None:
    samples = np.array([1.0, 4.0, 2.0, 8.0, 5.0])
    one, other = mean_interval(samples), mean_interval(3.0 * samples + 7.0)
    assert [other.low, other.high] == pytest.approx([3.0 * one.low + 7.0, 3.0 * one.high + 7.0])


def test_one_draw_has_no_interval_and_equal_ones_have_none_to_spare() -> None:
    assert math.isnan(mean_interval(np.array([4.0])).low)
    same = mean_interval(np.array([4.0, 4.0, 4.0]))
    assert (same.low, same.value, same.high) == (4.0, 4.0, 4.0)


def test_the_ratio_of_pairs_knows_that_they_are_pairs() -> None:
    below = np.random.default_rng(1).uniform(1.0, 100.0, 20)
    exact = ratio_interval(0.6 * below, below)
    assert [exact.low, exact.value, exact.high] == pytest.approx([0.6, 0.6, 0.6])
    apart = ratio_interval(0.6 * below[::-1], below)
    assert apart.value == pytest.approx(0.6)
    assert apart.high - apart.low > 0.1
    assert math.isnan(ratio_interval(below, np.zeros(20)).value)
    assert math.isnan(ratio_interval(np.zeros(20), below).value)


def test_over_and_under_are_inverse_ratios() -> None:
    above, below = np.random.default_rng(2).uniform(1.0, 9.0, (2, 8))
    one, other = ratio_interval(above, below), ratio_interval(below, above)
    assert (one.value, one.low, one.high) == pytest.approx(
        (1.0 / other.value, 1.0 / other.high, 1.0 / other.low)
    )


def test_so_many_draws_as_are_asked_for_make_the_interval_narrow_enough_and_one_less_does_not() -> None:
    pairs = np.random.default_rng(5).uniform(0.7, 1.3, (2, 10))
    needed = draws_needed(*pairs)
    assert needed is not None
    spread = np.log(pairs[0] / pairs[1]).std(ddof=1)

    def half_width(draws: int) -> float:
        return float(stats.t.interval(0.95, draws - 1, scale=spread / math.sqrt(draws))[1])

    assert half_width(needed) <= math.log(1.05) < half_width(needed - 1)
    assert draws_needed(np.ones(1), np.ones(1)) is None
    assert draws_needed(np.zeros(3), np.ones(3)) is None
    assert draws_needed(np.array([1e-9, 1e9]), np.ones(2)) is None


def test_the_band_of_curves_is_the_interval_at_each_point() -> None:
    curves = np.array([[0.0, 5.0], [1.0, 5.0], [5.0, 6.0]])
    low, high = mean_band(curves)
    each = [mean_interval(curves[:, point]) for point in range(2)]
    assert low == pytest.approx([point.low for point in each])
    assert high == pytest.approx([point.high for point in each])


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
    assert found.ratio.value == pytest.approx(math.sqrt(10.0 / 15.0 * 20.0 / 40.0))
    assert found.difference.low == pytest.approx(-12.5 - 12.706205 * 7.5)  # t of 1 degree of freedom
    assert found.draws == 2


def test_a_planner_does_not_differ_from_itself() -> None:
    rows = [row(name, seed=seed, t90_s=float(seed)) for seed in range(1, 6) for name in ("a", "b")]
    found = difference(rows, "a", "b", T90)
    assert (found.difference.low, found.difference.high, found.ratio.value) == (0.0, 0.0, 1.0)


def test_the_last_words_give_ratios_and_how_many_draws_would_do() -> None:
    times = {"a": (10.0, 22.0, 29.0), "b": (20.0, 20.0, 20.0)}
    rows = [row(name, seed=seed, t90_s=t) for name, all_of in times.items() for seed, t in enumerate(all_of)]
    (line,) = ratios(rows, "b")
    found = difference(rows, "a", "b", T90)
    assert line.startswith(f"a over b: T90 {found.ratio.value:.2f} ({found.ratio.low:.2f} to ")
    assert line.endswith(f"within 5 % with {found.needed} draws instead of 3")
    assert ratios(rows[:3], "a") == []


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
