"""Two parts of one building find each other; what looks alike in more than one way, or differs, does not."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.frames import Part, building, off, part, shell
from vedette.align import FramePose, align, charted, judged, shifts
from vedette.align.agreement import agreement, middles
from vedette.align.fitted import fitted
from vedette.align.verdict import SAVED, bare
from vedette.kernels.reference import align as reference
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame

HERE = FramePose(0.0, 0.0, 0.0)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_parts_with_a_third_in_common_lie_within_5_cm_and_0_3_degrees_of_the_truth(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y, turn = rng.uniform(-20, 20), rng.uniform(-20, 20), rng.uniform(-math.pi, math.pi)
    classes = building(seed)
    a, b = part(classes, 0.0, 16.0, HERE), part(classes, 8.0, 24.0, FramePose.of(x, y, turn))
    verdict = judged(a.charted, b.charted, seed=0)
    assert verdict.joined is not None, verdict.doubt
    shift, aside = off(verdict.joined.pose, a, b)
    assert shift <= 0.05
    assert aside <= math.radians(0.3)
    assert verdict.joined.contradicted < 0.05
    assert verdict.joined.overlap == pytest.approx(0.5, abs=0.12)


def test_parts_of_a_hundred_metres_with_a_third_in_common_are_joined_where_they_were_cut() -> None:
    classes = building(3, 90.0, 100.0)
    a, b = part(classes, 0.0, 60.0, HERE), part(classes, 30.0, 90.0, FramePose.of(-7.0, 3.0, 0.4))
    found = align(a.charted, b.charted).candidates[0]
    assert off(found.pose, a, b)[0] <= 0.05
    assert found.contradicted < 0.05


def test_maps_of_other_cells_are_laid_on_each_other() -> None:
    classes = building(4)
    a, b = (
        part(classes, 0.0, 18.0, HERE),
        part(classes, 6.0, 24.0, FramePose.of(3.0, 1.0, 0.7), resolution=0.05),
    )
    joined = judged(a.charted, b.charted, seed=0).joined
    assert joined is not None
    assert off(joined.pose, a, b)[0] <= 0.05


@pytest.mark.parametrize(("first", "second"), [(1, 2), (3, 4), (5, 6)])
def test_parts_of_different_buildings_are_not_joined(first: int, second: int) -> None:
    a = part(building(first), 0.0, 16.0, HERE)
    b = part(building(second), 0.0, 16.0, FramePose.of(1.0, 2.0, 1.0))
    assert judged(a.charted, b.charted, seed=0).joined is None


def hotel() -> NDArray[np.uint8]:
    """Eight rooms of 3 x 4 m along a corridor of 2 m."""
    solid = np.zeros((63, 241), np.bool_)
    solid[[0, 41, 62]] = solid[:, [0, 240]] = True
    solid[:42, ::30] = True
    for door in range(12, 240, 30):
        solid[41, door : door + 9] = False
    return shell(solid)


def test_equal_rooms_in_a_row_are_refused_for_another_place_fits_as_well() -> None:
    a, b = part(hotel(), 0.0, 15.0, HERE), part(hotel(), 6.0, 21.0, FramePose.of(2.0, 0.0, 0.4))
    verdict = judged(a.charted, b.charted, seed=0)
    assert verdict.joined is None
    assert verdict.doubt is not None
    assert "another place fits" in verdict.doubt


def corridor() -> NDArray[np.uint8]:
    solid = np.ones((24, 502), np.bool_)
    solid[2:22, 1:-1] = False
    return shell(solid)


def test_along_a_bare_corridor_nothing_tells_where_maps_lie() -> None:
    a, b = part(corridor(), 5.0, 30.0, HERE), part(corridor(), 15.0, 45.0, FramePose.of(2.0, 0.0, 0.4))
    assert judged(a.charted, b.charted, seed=0).joined is None
    fit = fitted(a.charted, a.charted, HERE, 2000)
    along, across = math.sqrt(fit.covariance[0, 0]), math.sqrt(fit.covariance[1, 1])
    assert across < 0.02
    assert along > 50.0 * across


def test_a_building_symmetric_about_a_point_is_refused() -> None:
    half = building(7)[:, :-1]
    whole = np.hstack([half, half[::-1, ::-1]])
    middle = part(whole, 8.0, whole.shape[1] * 0.1 - 8.0, HERE)
    again = part(whole, 8.0, whole.shape[1] * 0.1 - 8.0, FramePose.of(1.0, 1.0, 0.3))
    verdict = judged(middle.charted, again.charted, seed=0)
    assert verdict.alignment.rivalry > 0.9
    assert verdict.joined is None


def test_of_a_symmetric_building_halves_that_were_seen_apart_are_not_laid_on_each_other() -> None:
    """Each knows 6 m of the other's half: 12 m are in common where they lie, all 30 m where they do not."""
    half = building(7)[:, :-1]
    whole = np.hstack([half, half[::-1, ::-1]])
    long = whole.shape[1] * 0.1
    left = part(whole, 0.0, long / 2.0 + 6.0, HERE)
    right = part(whole, long / 2.0 - 6.0, long, FramePose.of(1.0, 1.0, 0.3))
    verdict = judged(left.charted, right.charted, seed=0)
    assert off(verdict.alignment.candidates[0].pose, left, right)[1] > 3.0
    assert verdict.alignment.rivalry < 0.5
    assert verdict.joined is None
    assert verdict.doubt is not None
    assert "looks the same" in verdict.doubt


@pytest.mark.parametrize(("down", "across"), [(0, 0), (60, 30)])
def test_two_bare_halls_are_not_joined_by_the_corner_and_the_recess_that_both_have(
    down: int, across: int
) -> None:
    seen = []
    for long, wide, pose in ((34, 28, HERE), (38, 31, FramePose.of(1.0, 2.0, 0.5))):
        solid = np.zeros((10 * wide, 10 * long), np.bool_)
        solid[[0, -1]] = solid[:, [0, -1]] = True
        solid[:down, :across] = True
        classes = shell(solid)
        classes[80:, 80:] = classes[-20:] = classes[:, -20:] = UNKNOWN  # neither knows how far its hall goes
        seen.append(part(classes, 0.0, float(long), pose).charted)
    verdict = judged(seen[0], seen[1], seed=0)
    assert verdict.joined is None
    assert verdict.alignment.candidates[0].same > 40.0
    doubt = bare(seen[0], seen[1], verdict.alignment.candidates[0], SAVED)
    assert doubt is not None
    assert "a few straight lines" in doubt


def test_the_verdict_is_the_same_for_the_same_seed() -> None:
    classes = building(5)
    a, b = part(classes, 0.0, 16.0, HERE), part(classes, 8.0, 24.0, FramePose.of(1.0, 2.0, 2.0))
    first, second = (judged(a.charted, b.charted, seed=3) for _ in range(2))
    assert first.doubt == second.doubt
    assert [c.pose for c in first.alignment.candidates] == [c.pose for c in second.alignment.candidates]


def test_with_the_twin_in_the_place_of_the_kernel_the_best_place_is_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    classes = building(6, 12.0, 10.0)
    a, b = part(classes, 0.0, 9.0, HERE), part(classes, 3.0, 12.0, FramePose.of(4.0, 0.0, -1.0))
    compiled = align(a.charted, b.charted)
    monkeypatch.setattr(shifts, "align_peaks", reference.align_peaks)
    plain = align(a.charted, b.charted)
    shift, turn = compiled.candidates[0].pose.apart(plain.candidates[0].pose, b.charted.middle)
    assert (shift, turn) == pytest.approx((0.0, 0.0), abs=1e-3)
    assert off(plain.candidates[0].pose, a, b)[0] < 0.1


def test_a_map_without_walls_or_without_free_ground_has_nothing_to_be_found_by() -> None:
    frame = GridFrame(0.1, 40, 40)
    for cells in (UNKNOWN, FREE, OCCUPIED):
        assert charted(frame, np.full((40, 40), cells, np.uint8)) is None


def test_walls_that_look_the_other_way_do_not_count_as_the_same() -> None:
    """Two rooms on both sides of a wall touch, and have no wall in common."""
    room = np.ones((40, 52), np.bool_)
    room[1:-1, 1:-1] = False
    a = Part(GridFrame(0.1, 40, 52), shell(room), HERE)
    best = align(a.charted, a.charted).candidates[0]
    assert best.same == pytest.approx(18.0, rel=0.1)
    touching = [c for c in align(a.charted, a.charted).candidates if c.common < 1.0]
    assert all(candidate.same < 4.0 for candidate in touching)


@pytest.mark.parametrize(("shift", "degrees"), [(0.0, 5.0), (0.0, -3.0), (0.4, 0.0), (-0.3, 4.0), (0.0, 0.0)])
def test_walls_pull_a_map_that_lies_askew_back_by_as_much(shift: float, degrees: float) -> None:
    """In a small office walls 5 degrees askew contradict hardly anything; they pull."""
    classes = building(1, 12.0, 10.0)
    a, b = part(classes, 0.0, 9.0, HERE), part(classes, 3.0, 12.0, FramePose.of(1.0, 2.0, 0.7))
    right = middles(a.charted, b.charted, a.pose.inverse().after(b.pose))
    taken = FramePose.of(right.x + shift, right.y, right.angle + math.radians(degrees))
    agrees = agreement(a.charted, b.charted, taken)
    assert agrees.same > 8.0
    assert agrees.contradicted < 0.15
    moved, turned = fitted(a.charted, b.charted, taken, 800).pose.apart(taken, np.zeros(2))
    assert moved == pytest.approx(abs(shift), abs=0.05)
    assert math.degrees(turned) == pytest.approx(abs(degrees), abs=0.3)
