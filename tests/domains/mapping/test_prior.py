"""An old map: how far it is trusted, what it lets a team expect, and where tours then lead."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.mapping_scenes import (
    CORRIDOR,
    FRAME,
    RESOLUTION,
    SPEC,
    building,
    explored,
    frozen,
    placed,
    plan_of,
)
from vedette.domains.mapping.belief import LN2, MapBelief
from vedette.domains.mapping.impact import NOTHING
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.prior import Foresight, PriorMap, Shares, trust
from vedette.domains.mapping.stops import Stops
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame

OBJECTIVE = MappingObjective()


def foreseen(belief: MapBelief) -> Foresight:
    assert belief.foresight is not None
    return belief.foresight


def stops_of(platform: MappingPlatform) -> Stops:
    assert platform.stops is not None
    return platform.stops


def random_maps(seed: int) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    rng = np.random.default_rng(seed)
    known, said = (rng.choice([UNKNOWN, FREE, OCCUPIED], (19, 23), p=(0.2, 0.6, 0.2)) for _ in range(2))
    return known.astype(np.uint8), said.astype(np.uint8)


@pytest.mark.parametrize("seed", range(5))
def test_trust_counts_what_was_found_right_and_wrong_about_each_cell_and_in_all(seed: int) -> None:
    known, said = random_maps(seed)
    resolution = 0.3  # a wall is the same one cell off; near is five cells
    rows, cols = known.shape

    def beside(walls: NDArray[np.uint8], row: int, col: int) -> bool:
        near = walls[max(0, row - 1) : row + 2, max(0, col - 1) : col + 2]
        return bool((near == OCCUPIED).any())

    right, wrong = np.zeros(known.shape, int), np.zeros(known.shape, int)
    for row in range(rows):
        for col in range(cols):
            wall, old = known[row, col] == OCCUPIED, said[row, col]
            right[row, col] = wall and beside(said, row, col)
            unexpected = wall and old == FREE and not beside(said, row, col)
            gone = known[row, col] == FREE and old == OCCUPIED and not beside(known, row, col)
            wrong[row, col] = unexpected or gone
    overall = (right.sum() + 20) / (right.sum() + 20 + 3 * wrong.sum())
    found = trust(known, said, resolution)
    for row in range(rows):
        for col in range(cols):
            near = slice(max(0, row - 5), row + 6), slice(max(0, col - 5), col + 6)
            c, x = right[near].sum(), wrong[near].sum()
            assert found[row, col] == pytest.approx((c + 20 * overall) / (c + 20 + 3 * x))


def test_a_map_that_was_right_everywhere_is_trusted_and_one_of_another_building_is_not() -> None:
    said = plan_of(building())
    right = foreseen(frozen(prior=said))
    there = frozen().unknown > 0
    assert right.trust[there].min() > 0.95
    other = plan_of(np.roll(building(), (11, 23), axis=(0, 1)))
    assert foreseen(frozen(prior=other)).trust[there].max() < 0.35


def test_what_can_be_seen_by_the_map_is_worth_its_area_and_walls_and_sealed_rooms_nothing() -> None:
    solid = building()
    solid[58:60] = True  # no doors on the far side
    known = explored(CORRIDOR)
    known[58:] = UNKNOWN
    known[58][known[57] == FREE] = OCCUPIED
    belief = frozen(known, hidden=0.0, prior=plan_of(solid))
    foresight = foreseen(belief)
    row = np.arange(belief.unknown.shape[0]) + belief.first[0]  # a planning cell is two cells wide
    assert not foresight.seeable[row > 31].any()
    open_ = (belief.classes == UNKNOWN) & (foresight.classes == UNKNOWN)
    assert open_.sum() == foresight.seeable.sum() > 0
    inside = belief.frame.centres(np.flatnonzero(open_))
    flat = [FRAME.flat(*place) for place in inside]
    assert not solid.ravel()[flat].any()
    expected = foresight.trust * foresight.seeable + (1 - foresight.trust) * belief.unknown
    np.testing.assert_allclose(belief.weights.window, LN2 * expected, rtol=1e-6)


def test_looks_show_on_average_what_they_show_whether_or_not_the_map_is_right() -> None:
    rng = np.random.default_rng(3)
    shape = (4, 5)
    unknown = rng.integers(1, 5, shape).astype(np.uint16)
    seeable = np.minimum(rng.integers(0, 5, shape), unknown).astype(np.uint16)
    chance = rng.random(shape).astype(np.float32)
    foresight = Foresight(np.zeros((8, 10), np.uint8), seeable, chance)

    def looks() -> tuple[Shares, NDArray[np.float64]]:
        dense = np.where(rng.random((3, 20)) < 0.6, rng.uniform(0.3, 1.0, (3, 20)), 0.0)
        which, cells = np.nonzero(dense)
        starts = np.searchsorted(which, np.arange(4))
        return (starts, cells.astype(np.uint32), dense[which, cells].astype(np.float32)), dense

    (plain, often), (right, seldom) = looks(), looks()
    starts, cells, shares = foresight.mean(plain, right, unknown)
    mean = np.zeros((3, 20))
    mean[np.repeat(np.arange(3), np.diff(starts)), cells] = shares
    seen = (1 - chance) * unknown * often.reshape(3, *shape) + chance * seeable * seldom.reshape(3, *shape)
    expected = seen / np.maximum(foresight.expected(unknown), 1e-6)
    np.testing.assert_allclose(mean, np.where(expected >= 1 / 16, expected, 0.0).reshape(3, 20), rtol=1e-5)


def test_unknown_ground_of_an_old_map_is_solid_behind_its_walls_and_open_where_they_are_missing() -> None:
    said = np.full((9, 20), UNKNOWN, np.uint8)
    said[2:7, 2:10] = FREE
    said[1, 1:10] = said[7, 1:10] = said[1:8, 1] = OCCUPIED  # the right side is open
    taken = PriorMap.of(said, GridFrame(0.1, 9, 20)).classes
    assert (taken[0, :10] == OCCUPIED).all()
    assert (taken[8, :10] == OCCUPIED).all()
    assert (taken[:, 0] == OCCUPIED).all()
    assert (taken[4, 10:] == UNKNOWN).all()
    np.testing.assert_array_equal(taken[said != UNKNOWN], said[said != UNKNOWN])


def test_a_map_of_somewhere_else_changes_nothing() -> None:
    elsewhere = PriorMap(np.full((5, 5), FREE, np.uint8), GridFrame(RESOLUTION, 5, 5, 500.0, 500.0))
    belief = frozen(prior=elsewhere)
    assert belief.foresight is None
    np.testing.assert_array_equal(belief.weights.window, frozen().weights.window)


def test_equal_maps_have_one_identity_and_a_cell_makes_another() -> None:
    solid = building()
    assert plan_of(solid).identity == plan_of(solid.copy()).identity
    solid[50, 70] = True
    assert plan_of(solid).identity != plan_of(building()).identity


@pytest.fixture(scope="module")
def ready() -> tuple[MapBelief, MappingPlatform]:
    belief = frozen(prior=plan_of(building()))
    platform = MappingPlatform(SPEC, foresees=True)
    placed(platform, belief)
    return belief, platform


def test_foreseen_stops_stand_where_nobody_has_been_and_the_robot_fits_if_the_map_is_right(
    ready: tuple[MapBelief, MappingPlatform],
) -> None:
    belief, platform = ready
    stops = stops_of(platform)
    assert stops.foreseen > 0
    for x, y in stops.views[-stops.foreseen :]:
        row, col = belief.frame.cell(x, y)
        assert belief.classes[row, col] == UNKNOWN
        row, col = FRAME.cell(x, y)
        reach = int(SPEC.radius / RESOLUTION)
        assert not building()[row - reach : row + reach + 1, col - reach : col + reach + 1].any()


def test_every_tour_begins_at_a_frontier_and_arrives_when_its_stops_say(
    ready: tuple[MapBelief, MappingPlatform],
) -> None:
    _, platform = ready
    stops = stops_of(platform)
    frontiers = len(stops) - stops.foreseen
    for first in range(frontiers, len(stops)):
        tour = platform.tour(np.array([first]))
        assert tour.stops[0] < frontiers
        assert tour.stops[-1] == first
        assert tour.arrivals[-1] == stops.first_leg[first]
        assert not platform.is_ahead_of_map(tour)
        assert platform.is_ahead_of_map(tour.after_first())


def test_a_reply_leads_on_into_what_is_foreseen_and_no_tour_adds_more_than_the_bound(
    ready: tuple[MapBelief, MappingPlatform],
) -> None:
    belief, platform = ready
    tour = platform.reply(belief, NOTHING, platform.tour(np.array([0])))
    stops = stops_of(platform)
    assert (tour.stops >= len(stops) - stops.foreseen).any()
    most = platform.slack(belief, NOTHING)
    rng = np.random.default_rng(0)
    for _ in range(50):
        some = platform.tour(rng.permutation(len(stops))[: rng.integers(1, 13)])
        assert OBJECTIVE.value(belief, platform.impact(belief, some)) <= most + 1e-9


def test_a_robot_that_considers_one_stop_or_has_little_way_left_foresees_none() -> None:
    belief = frozen(prior=plan_of(building()))
    single = MappingPlatform(SPEC, max_stops=1, foresees=True)
    placed(single, belief)
    assert stops_of(single).foreseen == 0
