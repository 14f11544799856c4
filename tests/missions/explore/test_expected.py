"""What is expected of a mission: the formula's, never in the past, and right four times in five."""

from __future__ import annotations

from math import exp, log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.forecast import Foreseen, Sample, checked, fitted, run_foreseen
from tests.support.small_missions import small_maze, small_office
from vedette.missions.explore.expected import EARLIEST, ENDED, KNOWN, Expected, Forecaster, Progress, Span
from vedette.outcome import Outcome
from vedette.record.explore.log import ExploreSnapshot
from vedette.record.explore.told import outlook, progress
from vedette.run import Explore

TIMES = np.arange(0.0, 80.5, 0.5)


def told(area: float = 2.0, frontiers: int | None = 7, way: float = 0.3, robots: int = 3) -> list[Progress]:
    """A mission that comes to know so much more each second [m^2], while each robot drives so far [m]."""
    return [Progress(float(t), area * float(t), frontiers, way * float(t), robots) for t in TIMES]


def test_what_is_expected_is_what_the_formula_says() -> None:
    forecaster = Forecaster()
    for now in told():
        forecaster.add(now)
    features = np.array([1.0, log(8.0), 0.5, log(1.0 + 24.0), log(160.0), log(3.0)])
    assert forecaster.expected is not None
    for span, weights in ((forecaster.expected.known, KNOWN), (forecaster.expected.ended, ENDED)):
        times = sorted(80.0 * exp(float(np.dot(row, features))) for row in weights)
        assert [span.low, span.middle, span.high] == pytest.approx(times)


@given(
    st.floats(0.01, 50.0), st.integers(0, 500), st.floats(0.0, 2.0), st.integers(1, 40), st.integers(20, 160)
)
def test_no_end_is_expected_in_the_past(
    area: float, frontiers: int, way: float, robots: int, until: int
) -> None:
    forecaster = Forecaster()
    for now in told(area, frontiers, way, robots)[:until]:
        expected = forecaster.add(now)
    assert expected is not None
    ended, known = expected.ended, expected.known
    assert now.t <= ended.low <= ended.middle <= ended.high
    assert 0.0 <= known.low <= known.middle <= known.high


def test_before_anything_can_be_said_nothing_is_expected() -> None:
    forecaster = Forecaster()
    moments = told()
    assert [forecaster.add(now) for now in moments if now.t < EARLIEST] == [None] * 12
    assert Forecaster().add(moments[40]._replace(frontiers=None)) is None
    assert Forecaster().add(moments[40]._replace(known_m2=0.0)) is None
    assert Forecaster().add(moments[40]._replace(robots=0)) is None
    assert Forecaster().add(moments[40]) is not None


def test_a_long_mission_is_remembered_in_part_and_expected_as_if_it_were_whole() -> None:
    moments = [Progress(0.5 * k, 0.01 * k, 5, 0.1 * k, 2) for k in range(20_000)]
    forecaster = Forecaster()
    for now in moments:
        forecaster.add(now)
    assert len(forecaster._times) <= 4096
    features = forecaster.features(moments[-1])
    assert features is not None
    assert features[2] == pytest.approx(0.5, abs=0.01)


def test_the_quantiles_that_are_fitted_leave_a_tenth_on_either_side() -> None:
    rng = np.random.default_rng(3)
    x = np.column_stack((np.ones(600), rng.normal(size=(600, 5))))
    y = x @ rng.normal(size=6) + rng.exponential(size=600)
    low, middle, high = (x @ fitted(x, y, np.arange(600)).T).T
    assert np.mean(y < low) == pytest.approx(0.1, abs=0.02)
    assert np.mean(y < middle) == pytest.approx(0.5, abs=0.02)
    assert np.mean(y > high) == pytest.approx(0.1, abs=0.02)


def test_a_mission_that_is_ended_says_how_it_would_have_gone_on_and_one_that_ends_does_not() -> None:
    snapshots: list[ExploreSnapshot] = []
    ended = Explore(small_office(), 2, max_time=30.0).run(snapshots.append)
    assert ended.outcome is Outcome.TIME_LIMIT
    assert ended.expected is not None
    assert ended.expected == snapshots[-1].expected
    assert ended.expected.ended.low >= 30.0
    figures = dict(progress(snapshots[-1]))
    assert figures["end"].startswith(f"{ended.expected.ended.middle:.0f} s (")
    assert "90 % known" in figures
    assert "90 % known" not in dict(progress(snapshots[2]))
    assert Explore(small_office(), 2, max_time=30.0).run().expected == ended.expected
    assert Explore(small_maze(), 2).run().expected is None


def test_where_90_percent_are_known_already_nobody_tells_when_they_will_be() -> None:
    expected = Expected(Span(10.0, 20.0, 30.0), Span(50.0, 60.0, 70.0))
    assert list(outlook(expected, 31.0)) == [
        ("90 % known", "passed, most likely"),
        ("end", "60 s (50 to 70)"),
    ]
    assert dict(outlook(expected, 29.0))["90 % known"] == "20 s (10 to 30)"
    assert dict(outlook(expected, 29.0, 0.89))["90 % known"] == "29 s (29 to 30)"  # not yet, that is certain
    assert dict(outlook(expected, 12.0, 0.91))["90 % known"] == "passed"


@pytest.mark.slow
def test_four_ends_in_five_lie_within_what_was_expected_of_missions_that_nothing_was_fitted_on() -> None:
    missions = [run_foreseen(Foreseen(seed), "") for seed in range(2000, 2020)]
    shares = {row[0]: float(row[3].removesuffix(" %")) for row in checked(Sample.of(missions))}
    assert set(shares) == {"90 % known", "the end"}
    assert all(65.0 <= share <= 95.0 for share in shares.values()), shares
