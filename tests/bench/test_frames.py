"""The bench of joins: its truth is one, a join elsewhere is wrong, and its tables count what there is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bench.frames.pairs import Pair, Sources
from bench.frames.tables import tables
from bench.frames.trial import Trial, tried
from vedette.align import FramePose


@pytest.fixture(scope="module")
def pair() -> Pair:
    return Sources((), ()).two_of_one(5, "cave")


@pytest.fixture(scope="module")
def trial(pair: Pair) -> Trial:
    made = tried("one", 5, pair, "0000000")
    assert made is not None
    return made


def test_the_truth_of_a_pair_lays_more_free_ground_on_free_ground_than_places_beside_it(pair: Pair) -> None:
    assert 0.0 < pair.common <= pair.least
    for x, y, angle in ((2.0, 0.0, 0.0), (0.0, -2.0, 0.0), (0.0, 0.0, 0.3)):
        moved = replace(pair.b, pose=pair.b.pose.after(FramePose.of(x, y, angle)))
        assert Pair(pair.place, pair.a, moved, True).common < pair.common


def test_a_pair_of_one_place_is_joined_and_the_same_with_another_truth_is_wrong(
    pair: Pair, trial: Trial
) -> None:
    assert trial.outcome == "joined"
    assert trial.error_m is not None
    assert trial.error_m < 0.05
    elsewhere = replace(pair.b, pose=FramePose.of(1.0, 0.0, 0.0).after(pair.b.pose))
    assert (other := tried("one", 5, Pair(pair.place, pair.a, elsewhere, True), "0000000")) is not None
    assert other.outcome == "wrong"
    assert (strange := tried("two", 5, Pair(pair.place, pair.a, pair.b, False), "0000000")) is not None
    assert (strange.outcome, strange.error_m) == ("wrong", None)


def test_the_tables_count_joins_and_wrong_joins_by_overlap(trial: Trial) -> None:
    some = [
        replace(trial, common_m2=50.0, least_m2=100.0, outcome=outcome)
        for outcome in ("joined", "joined", "wrong", "refused")
    ]
    (row,) = [line for line in tables(some).splitlines() if line.startswith("| 0.50 to 0.60")]
    assert [cell.strip() for cell in row.split("|")[2:6]] == ["4", "2", "50.0%", "1"]


def test_the_same_number_gives_the_same_pair() -> None:
    first, second = (Sources((), ()).two_alike(2) for _ in range(2))
    assert first.place == second.place
    assert np.array_equal(first.a.classes, second.a.classes)
    assert first.truth == second.truth


def test_what_repeats_itself_is_told_apart_and_what_was_asked_is_met_or_missed(trial: Trial) -> None:
    assert trial.alike is not None
    assert not replace(trial, alike=0.5).repetitive
    maze, hall = replace(trial, place="maze"), replace(trial, alike=0.6, outcome="refused")
    assert maze.repetitive
    assert hall.repetitive
    some = [replace(trial, common_m2=50.0, least_m2=100.0, outcome="joined")] * 49
    for refused, verdict in ((1, "MET"), (2, "MISSED")):
        lines = tables([*some, *[replace(some[0], outcome="refused")] * refused, maze, hall]).splitlines()
        (row,) = [line for line in lines if line.startswith("| joined from an overlap of 0.4")]
        assert row.split("|")[4].strip() == verdict
    (wrong,) = [line for line in tables([trial]).splitlines() if line.startswith("| joined wrongly")]
    assert wrong.split("|")[3].strip() == "0"
