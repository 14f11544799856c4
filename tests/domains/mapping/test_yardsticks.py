"""The planners to compare with do what was published."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.mapping_scenes import CORRIDOR, FRAME, SPEC, explored, frozen, placed
from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import NOTHING
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.stops import CLEARANCES
from vedette.domains.mapping.tour import STAY
from vedette.domains.mapping.yardsticks import STICK, BurgardPlatform, NearestPlatform
from vedette.kernels.distance import distance_field
from vedette.kernels.frontier import traversable

Places = list[tuple[float, float]]


def test_nearest_goes_to_the_stop_with_the_shortest_way() -> None:
    belief, platform = frozen(), NearestPlatform(SPEC)
    for x in (-1.0, 1.5, 3.2):
        placed(platform, belief, x)
        assert platform.stops is not None
        tour = platform.reply(belief, NOTHING, STAY)
        assert tour.stops.tolist() == [int(np.argmin(platform.stops.first_leg))]


def test_nearest_keeps_its_goal_unless_another_is_nearer_by_a_metre() -> None:
    belief, platform = frozen(), NearestPlatform(SPEC)
    placed(platform, belief)
    assert platform.stops is not None
    length = platform.stops.first_leg * SPEC.speed
    for stop in range(len(length)):
        current = platform.tour(np.array([stop]))
        kept = platform.reply(belief, NOTHING, current) is current
        assert kept == (length[stop] <= length.min() + STICK)


def burgard(belief: MapBelief, places: Places) -> dict[tuple[float, float], tuple[float, float]]:
    """The published greedy, told by coordinates: which frontier each robot gets."""
    passable = traversable(belief.classes, SPEC.radius + CLEARANCES[0], 0.1)
    scout = MappingPlatform(SPEC)
    placed(scout, belief, *places[0])
    assert scout.stops is not None
    targets = [(float(x), float(y)) for x, y in scout.stops.targets]
    views = [belief.frame.cell(x, y) for x, y in scout.stops.views]
    cost = {}
    for place in places:
        field = distance_field(passable, belief.frame.flat(*place), 0.1)
        cost.update(
            {(place, target): float(field[view]) for target, view in zip(targets, views, strict=True)}
        )
    utility = dict.fromkeys(targets, 1.0)
    given: dict[tuple[float, float], tuple[float, float]] = {}
    while len(given) < len(places):
        pairs = [pair for pair in cost if pair[0] not in given]
        place, target = max(pairs, key=lambda pair: utility[pair[1]] - cost[pair] / SPEC.range)
        given[place] = target
        for other in targets:
            away = float(np.hypot(other[0] - target[0], other[1] - target[1]))
            utility[other] -= max(0.0, 1.0 - away / SPEC.range)
    return given


@pytest.mark.parametrize(
    "places",
    [
        [(-0.5, 7.1)],
        [(-0.5, 7.1), (0.1, 7.3)],
        [(-1.1, 6.8), (-0.5, 7.1), (0.1, 7.3)],
        [(3.3, 7.1), (-1.3, 7.2), (-0.6, 5.3), (4.9, 7.0)],
    ],
)
def test_burgards_robots_each_take_what_the_published_greedy_gives_them(places: Places) -> None:
    belief, expected = frozen(), burgard(frozen(), places)
    for x, y in places:
        platform = BurgardPlatform(SPEC)
        mates = [(i, *place) for i, place in enumerate(places) if place != (x, y)]
        platform.place(x, y, [], [(-1, x, y), *mates], 0.0)
        platform.prepare(belief)
        tour = platform.reply(belief, NOTHING, STAY)
        assert tuple(tour.targets[0]) == expected[x, y]


def test_robots_that_tie_for_a_frontier_get_distinct_ones_from_burgard() -> None:
    belief = frozen()
    nearest: dict[tuple[int, float], list[tuple[float, float]]] = {}
    for x in np.arange(-0.95, 0.0, 0.1).tolist():
        scout = MappingPlatform(SPEC)
        placed(scout, belief, x, 7.05)
        assert scout.stops is not None
        legs = scout.stops.first_leg
        nearest.setdefault((int(legs.argmin()), float(legs.min())), []).append((x, 7.05))
    ties = [places for places in nearest.values() if len(places) > 1]
    assert ties
    for places in ties:
        goals = set()
        for x, y in places:
            platform = BurgardPlatform(SPEC)
            mates = [(9, *place) for place in places if place != (x, y)]
            platform.place(x, y, [], [(-1, x, y), *mates], 0.0)
            platform.prepare(belief)
            goals.add(tuple(platform.reply(belief, NOTHING, STAY).targets[0]))
        assert len(goals) == len(places)


def test_burgard_takes_a_mate_outside_the_window_at_its_edge() -> None:
    belief, platform = frozen(explored(CORRIDOR), reach=0.3), BurgardPlatform(SPEC)
    far = FRAME.extent[1] - 0.05, FRAME.extent[2] + 0.05
    assert not belief.frame.contains(*far)
    platform.place(-0.5, 7.1, [], [(-1, -0.5, 7.1), (1, *far)], 0.0)
    platform.prepare(belief)
    assert len(platform.reply(belief, NOTHING, STAY)) == 1
