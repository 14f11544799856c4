"""What is believed of a best place: the more walls speak against it, the less its rivals may have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.frames import off, part, shell
from vedette.align import Alignment, FramePose, JoinVerdict, PossibleJoin, align, judged
from vedette.align.candidates import CLASH
from vedette.align.verdict import OF_THINNED, SAVED, JoinRule, bare
from vedette.maps import UNKNOWN

HERE = FramePose(0.0, 0.0, 0.0)


def place(same: float, against: float, x: float = 0.0) -> PossibleJoin:
    """A place that walls speak for and against [m]."""
    return PossibleJoin(
        FramePose(x, 0.0, 0.0),
        score=same - CLASH * against,
        same=same,
        against=against,
        contradicted=against / (same + against),
        common=100.0,
        overlap=0.5,
        covariance=np.eye(3) * 1e-4,
    )


@pytest.mark.parametrize(
    ("same", "against", "rival", "believed"),
    [
        (100.0, 0.0, 59.0, True),  # at most 0.6 of 100 m
        (100.0, 0.0, 61.0, False),
        (100.0, 0.8, 41.0, True),  # 0.8 of 100.8 m are contradicted: at most 0.441 of 96 m, 42.4 m
        (100.0, 0.8, 44.0, False),
        (100.0, 3.0, 21.0, True),  # 2.9 %: at most a quarter of 85 m, 21.3 m
        (100.0, 3.0, 22.0, False),
        (100.0, 8.0, 14.0, True),  # 7.4 %: a quarter of 60 m still
        (100.0, 8.0, 16.0, False),
        (100.0, 12.0, 1.0, False),  # 10.7 %
    ],
)
def test_the_more_walls_speak_against_a_place_the_less_its_rival_may_have(
    same: float, against: float, rival: float, believed: bool
) -> None:
    """On a floor of like rooms 2 % were contradicted where a map was laid wrongly, with a rival at 0.46."""
    doubt = SAVED.doubt(Alignment((place(same, against), place(rival, 0.0, 9.0))))
    assert (doubt is None) is believed


def test_a_rule_that_does_not_fall_lets_rivals_be_whatever_is_contradicted() -> None:
    flat = JoinRule(rivalry=0.6, lead=12.0)
    for against in (0.0, 3.0, 8.0):
        best = place(100.0, against)
        assert flat.doubt(Alignment((best, place(0.59 * best.score, 0.0, 9.0)))) is None
        assert flat.doubt(Alignment((best, place(0.61 * best.score, 0.0, 9.0)))) is not None


def test_copies_with_parts_missing_may_contradict_each_other_somewhat_more_than_the_whole_maps() -> None:
    """A half of what is contradicted in a log may lie in the seven tenths that are left."""
    best = place(40.0, 5.5)  # 12 %
    assert SAVED.doubt(Alignment((best,))) is not None
    assert OF_THINNED.doubt(Alignment((best,))) is None


def hall(pillars: Sequence[int] = (), screens: Sequence[int] = ()) -> NDArray[np.uint8]:
    """Return what is seen along three sides of a hall, and of a fourth wall that leads away from it.

    Args:
        pillars: columns where one of 0.5 x 0.9 m stands before the longest wall.
        screens: columns where a wall of 2 m, a cell thick, stands in the open.
    """
    solid = np.zeros((260, 340), np.bool_)
    solid[[0, -1]] = solid[:, [0, -1]] = True
    solid[:60, 240:] = True  # the hall grows narrower
    for left in pillars:
        solid[-6:-1, left : left + 9] = True
    for left in screens:
        solid[-40, left : left + 20] = True
    classes = shell(solid)
    classes[100:160, 60:] = UNKNOWN  # farther from the walls than lidars reach
    classes[:, 300:] = UNKNOWN
    return classes


def verdict_of(first: NDArray[np.uint8], second: NDArray[np.uint8]) -> JoinVerdict:
    """Lay 25 m of one on 30 m of another."""
    a, b = part(first, 0.0, 30.0, HERE), part(second, 0.0, 25.0, FramePose.of(2.0, 1.0, 0.8))
    verdict = judged(a.charted, b.charted, seed=0)
    best = verdict.alignment.candidates[0]
    assert off(best.pose, a, b)[0] < 0.1
    assert best.contradicted < 0.1
    assert verdict.alignment.rivalry < 0.4
    return verdict


PILLARS = (40, 95, 170, 220)


def test_a_hall_whose_form_another_hall_has_is_joined_only_by_what_else_is_in_it() -> None:
    """Three sides and a fourth wall that leads away: two halls of other buildings had 116 m so in common."""
    alone = verdict_of(hall(), hall())
    assert alone.alignment.candidates[0].same > 60.0
    assert alone.joined is None
    assert "a few straight lines" in (alone.doubt or "")
    assert verdict_of(hall(PILLARS), hall(PILLARS)).joined is not None


@pytest.mark.parametrize(("screens", "joined"), [((), True), ((60,), False), ((60, 130, 200), False)])
def test_what_contradicts_is_weighed_against_what_both_have_that_is_no_straight_wall(
    screens: tuple[int, ...], joined: bool
) -> None:
    """Four pillars have 8 m or so: a wall of 2 m in one map alone is more than a tenth of that."""
    verdict = verdict_of(hall(PILLARS), hall(PILLARS, screens))
    assert verdict.alignment.candidates[0].against == pytest.approx(len(screens), rel=0.25)  # of one map
    assert (verdict.joined is not None) is joined, verdict.doubt
    assert joined or "contradict each other" in (verdict.doubt or "")


def test_of_maps_with_little_in_common_more_is_asked_beside_straight_walls() -> None:
    """Two floors have one hall above the other, a third of the smaller map, equal to the centimetre."""
    a, b = part(hall(PILLARS), 0.0, 30.0, HERE), part(hall(PILLARS), 0.0, 25.0, FramePose.of(2.0, 1.0, 0.8))
    (best, *_) = align(a.charted, b.charted).candidates
    assert bare(a.charted, b.charted, replace(best, overlap=0.41), SAVED) is None
    doubt = bare(a.charted, b.charted, replace(best, overlap=0.39), SAVED)
    assert doubt is not None
    assert "a few straight lines" in doubt
