"""What may lie behind frontiers: the known map continued by its own pieces, in several worlds at once."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.mapping_scenes import CORRIDOR, FRAME, SPEC, building, explored, placed, plan_of
from vedette.domains.mapping import layers
from vedette.domains.mapping.belief import MapBelief, freeze
from vedette.domains.mapping.completions import completions
from vedette.domains.mapping.impact import NOTHING, Impact, MapImpactCodec, on_map, promised
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.prior import PriorMap, Shares, trust
from vedette.domains.mapping.sightings import empty_counts
from vedette.domains.mapping.worlds import over_worlds
from vedette.kernels.coverage import LAYERS, CellWeights
from vedette.kernels.frontier import find_frontiers
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.laid import laid

OBJECTIVE = MappingObjective()
SIDE = 24  # of a room and its wall [cells]


def rooms(count: int, known: int) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Return a row of equal rooms with a door between each two, and what is known: the first rooms."""
    whole = np.full((2 * SIDE, count * SIDE + 2), FREE, np.uint8)
    whole[[0, 1, -1, -2]] = whole[:, [0, 1, -1, -2]] = OCCUPIED
    for wall in range(SIDE, count * SIDE, SIDE):
        whole[:, wall : wall + 2] = OCCUPIED
        whole[SIDE - 4 : SIDE + 5, wall : wall + 2] = FREE
    seen = whole.copy()
    seen[:, known * SIDE + 2 :] = UNKNOWN
    return whole, seen


def continued(seen: NDArray[np.uint8], worlds: int = 2) -> list[NDArray[np.uint8]]:
    return completions(seen, 2, (0, 0), find_frontiers(seen, 2, 30), worlds)


def test_behind_a_door_a_room_is_expected_like_those_behind_the_doors_before() -> None:
    whole, seen = rooms(count=6, known=4)
    for said in continued(seen):
        next_room = np.s_[:, 4 * SIDE + 2 : 5 * SIDE]
        told = said[next_room] != UNKNOWN
        assert told.mean() > 0.7
        assert (said[next_room][told] == whole[next_room][told]).mean() > 0.9


@pytest.mark.parametrize("turn", range(1, 4))
def test_a_map_turned_by_a_quarter_is_continued_as_well(turn: int) -> None:
    whole, seen = rooms(count=6, known=4)
    said = np.rot90(continued(np.ascontiguousarray(np.rot90(seen, turn)))[0], -turn)
    next_room = np.s_[:, 4 * SIDE + 2 : 5 * SIDE]
    told = said[next_room] != UNKNOWN
    assert told.mean() > 0.7
    assert (said[next_room][told] == whole[next_room][told]).mean() > 0.9


def test_nothing_is_told_of_what_is_known_or_where_nothing_fits() -> None:
    _, seen = rooms(count=6, known=4)
    assert all((said[seen != UNKNOWN] == UNKNOWN).all() for said in continued(seen))
    alone = np.full((80, 80), UNKNOWN, np.uint8)
    alone[38:44, 38:44] = FREE
    assert all((said == UNKNOWN).all() for said in continued(alone))


def test_worlds_hang_on_the_map_and_not_on_the_window_about_it() -> None:
    _, seen = rooms(count=6, known=4)
    wide = np.pad(seen, ((8, 4), (6, 10)))
    for said, there in zip(
        completions(seen, 2, (4, 3), find_frontiers(seen, 2, 30), 3),
        completions(wide, 2, (0, 0), find_frontiers(wide, 2, 30), 3),
        strict=True,
    ):
        inside = there[8:-4, 6:-10]
        np.testing.assert_array_equal(inside, said)
        assert (said != UNKNOWN).any()


def imagined(worlds: int = 3, prior: PriorMap | None = None) -> MapBelief:
    """Return a belief on the building's corridor and a room, several worlds at once."""
    return freeze(
        explored([*CORRIDOR, (-0.5, 3.0)]),
        FRAME,
        reach=4.0,
        extent=2.5,
        hidden=0.5,
        layers=layers.rate(start=5.0),
        counts=empty_counts(),
        prior=prior,
        worlds=worlds,
    )


def test_worth_is_the_mean_over_worlds_and_each_sums_to_what_is_to_be_seen_in_it() -> None:
    belief = imagined()
    rows, cols = belief.unknown.shape
    each = belief.to_see.reshape(rows, cols, 3)
    assert belief.worlds[0] is None
    np.testing.assert_allclose(3 * each[..., 0], belief.unknown)
    for world, foresight in enumerate(belief.worlds[1:], start=1):
        assert foresight is not None
        np.testing.assert_allclose(3 * each[..., world], foresight.expected(belief.unknown), rtol=1e-6)
        assert set(np.unique(foresight.trust * belief.unknown).round(3)) <= set(range(5))  # certain, by cells


def test_equal_maps_give_equal_worlds_and_keys_to_the_bit() -> None:
    one, other = imagined(), imagined()
    assert one.weights.window.tobytes() == other.weights.window.tobytes()
    impacts = []
    for belief in (one, other):
        platform = MappingPlatform(SPEC)
        placed(platform, belief)
        tour = platform.reply(belief, NOTHING, platform.tour(np.array([0])))
        impacts.append(MapImpactCodec(belief.planning.size * 3).encode(platform.impact(belief, tour)))
    assert impacts[0] == impacts[1]


def test_a_looks_keys_are_cells_of_worlds_and_show_what_it_shows_in_each() -> None:
    def row(cells: list[int], shares: list[float]) -> Shares:
        half = len(cells) // 2
        return np.array([0, half, len(cells)]), np.array(cells, np.uint32), np.array(shares, np.float32)

    starts, cells, shares = over_worlds([row([2, 5], [0.5, 0.25]), row([2, 3], [1.0, 0.75])])
    assert starts.tolist() == [0, 2, 4]
    assert cells.tolist() == [4, 5, 7, 10]
    assert shares.tolist() == [0.5, 1.0, 0.75, 0.25]


def random_impact(rng: np.random.Generator, keys: int) -> Impact:
    chosen = np.sort(rng.choice(keys * LAYERS, keys, replace=False)).astype(np.uint32)
    return OBJECTIVE.combine(NOTHING, Impact(chosen, rng.choice([3, 11, 64, 255], keys).astype(np.uint8)))


@pytest.mark.parametrize("seed", range(4))
def test_the_value_is_the_mean_over_worlds_by_brute_force_and_returns_diminish(seed: int) -> None:
    """(V202): summed over every world, cell and layer; over all subsets of a team of four."""
    rng, worlds, cells = np.random.default_rng(seed), 3, 12
    belief = imagined()
    worth = rng.random((cells, worlds)).astype(np.float32)
    weights = CellWeights.whole((worth / np.float32(worlds)).ravel())
    belief = MapBelief(**{**vars(belief), "weights": weights})
    team = [random_impact(rng, cells * worlds) for _ in range(4)]

    def value(members: tuple[int, ...]) -> float:
        total = 0.0
        for world in range(worlds):
            for cell in range(cells):
                missed = np.zeros(LAYERS)
                for member in members:
                    for key, miss in zip(*team[member].sparse, strict=True):
                        if divmod(int(key) // LAYERS, worlds) == (cell, world):
                            missed[int(key) % LAYERS :] += 1e9 if miss == 255 else miss
                seen = 1.0 - np.exp(-np.where(missed >= 255, np.inf, missed) / 16.0)
                total += float(worth[cell, world]) * float(belief.layers.weights @ seen) / worlds
        return total

    subsets = [each for size in range(5) for each in combinations(range(4), size)]
    values = {}
    for members in subsets:
        impact = NOTHING
        for member in members:
            impact = OBJECTIVE.combine(impact, team[member])
        values[members] = OBJECTIVE.value(belief, impact)
        assert values[members] == pytest.approx(value(members), rel=1e-5)
    for fewer in subsets:
        for more in subsets:
            if set(fewer) <= set(more):
                assert values[more] >= values[fewer] - 1e-9
                for extra in set(range(4)) - set(more):
                    with_fewer, with_more = (tuple(sorted({*s, extra})) for s in (fewer, more))
                    assert values[with_more] - values[more] <= values[with_fewer] - values[fewer] + 1e-6


def test_no_tour_adds_more_than_the_bound_where_worlds_are_imagined() -> None:
    belief = imagined()
    platform = MappingPlatform(SPEC, foresees=True)
    placed(platform, belief)
    assert platform.stops is not None
    most, rng = platform.slack(belief, NOTHING), np.random.default_rng(0)
    best = platform.reply(belief, NOTHING, platform.tour(np.array([0])))
    orders = [rng.permutation(len(platform.stops))[: rng.integers(1, 7)] for _ in range(30)]
    tours = [best, *(platform.tour(order) for order in orders)]
    values = [OBJECTIVE.value(belief, platform.impact(belief, tour)) for tour in tours]
    assert max(values) <= most + 1e-9
    assert values[0] == max(values)


def test_an_old_map_counts_in_as_many_worlds_as_it_is_trusted() -> None:
    right = imagined(4, plan_of(building()))
    agreed = [world for world in right.worlds if world is not None]
    assert len(agreed) == 4
    np.testing.assert_array_equal(agreed[0].classes, agreed[3].classes)
    old = plan_of(np.roll(building(), (0, 2), axis=(0, 1)))
    partly = imagined(4, old)
    said = laid(old.classes, old.frame, partly.frame)
    chance = trust(partly.classes, said, FRAME.resolution)
    believed = [(said != UNKNOWN) & (partly.classes == UNKNOWN) & (8 * chance >= 2 * k + 1) for k in range(4)]
    assert believed[0].any()
    assert not believed[3].any()
    first, last, alone = partly.worlds[0], partly.worlds[3], imagined(4).worlds[3]
    assert first is not None
    assert (first.classes[believed[0] & (said == OCCUPIED)] == OCCUPIED).all()
    assert last is not None
    assert alone is not None
    np.testing.assert_array_equal(last.classes, alone.classes)


def test_what_is_shown_of_an_impact_is_its_mean_over_worlds() -> None:
    keys = np.array([6 * LAYERS + 2, 7 * LAYERS + 4, 8 * LAYERS + 2], np.uint32)
    shown = on_map(Impact(keys, np.array([255, 255, 16], np.uint8)), 3)
    assert (shown.keys // LAYERS).tolist() == [2, 2]
    seen = 1.0 - np.exp(-shown.misses.astype(np.float64).cumsum() / 16.0)
    exact = [(1.0 + 1.0 - np.exp(-1.0)) / 3.0, (2.0 + 1.0 - np.exp(-1.0)) / 3.0]
    np.testing.assert_allclose(seen, exact, atol=1 / 32)
    assert on_map(shown, 1) is shown


def test_only_what_is_seen_in_all_worlds_is_promised_by_when_the_last_does() -> None:
    keys = np.array([6 * LAYERS + 2, 7 * LAYERS + 4, 10 * LAYERS + 1], np.uint32)
    edges = np.arange(LAYERS, dtype=np.float64)
    cells, by = promised(Impact(keys, np.full(3, 64, np.uint8)), edges, 2)
    assert (cells.tolist(), by.tolist()) == ([3], [4.0])
    assert promised(NOTHING, edges, 2)[0].size == 0


def test_weights_are_of_each_planning_cell_in_each_world() -> None:
    belief = imagined()
    assert belief.planning == GridFrame(0.2, 51, 72, -3.0, 2.0)
    assert belief.weights.shape == (51, 216)
