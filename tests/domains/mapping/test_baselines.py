"""The published planners choose what their definitions say, and whole missions with each of them end well."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.mapping_scenes import SPEC, frozen, placed
from tests.support.small_missions import check_complete, drawn, robots, run
from vedette.domains.mapping import layers
from vedette.domains.mapping.baselines.cost_utility import CostUtilityPlatform, expected_areas
from vedette.domains.mapping.baselines.greedy import GreedyPlatform
from vedette.domains.mapping.baselines.hungarian import HungarianPlatform, assign
from vedette.domains.mapping.baselines.joint import joint_optimum
from vedette.domains.mapping.baselines.makespan import MakespanPlatform
from vedette.domains.mapping.baselines.optimal import OptimalPlatform
from vedette.domains.mapping.baselines.routes import TIE, Graph, Routes, insert_all, plan_routes
from vedette.domains.mapping.baselines.team import STICK, TeamPlatform
from vedette.domains.mapping.belief import LN2, MapBelief
from vedette.domains.mapping.impact import NOTHING, Impact
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.planners import PLANNERS, planner
from vedette.domains.mapping.platform import HYSTERESIS, STICKINESS, MappingPlatform
from vedette.domains.mapping.stops import CLEARANCES
from vedette.domains.mapping.tour import STAY, Tour
from vedette.errors import InputError
from vedette.kernels.coverage import LAYERS
from vedette.kernels.distance import distance_field
from vedette.kernels.frontier import traversable
from vedette.kernels.reference.coverage import dense
from vedette.problem import exhaustive

Places = list[tuple[float, float]]
OBJECTIVE = MappingObjective()
TEAMS: list[Places] = [
    [(-0.5, 7.1)],
    [(-0.5, 7.1), (0.1, 7.3)],
    [(-1.1, 6.8), (-0.5, 7.1), (4.9, 7.0)],
]
INF = float("inf")


def joined(platform: MappingPlatform, belief: MapBelief, place: tuple[float, float], places: Places) -> None:
    """Put one robot of a team in its place and let it prepare a round."""
    mates = [(robot, x, y) for robot, (x, y) in enumerate(places) if (x, y) != place]
    platform.place(*place, [], [(-1, *place), *mates], 0.0)
    platform.prepare(belief)


def lengths_to(belief: MapBelief, place: tuple[float, float], points: NDArray[np.float64]) -> list[float]:
    """Path lengths from a place, by a flood of its own."""
    passable = traversable(belief.classes, SPEC.radius + CLEARANCES[0], belief.frame.resolution)
    flood = distance_field(passable, belief.frame.flat(*place), belief.frame.resolution)
    return [float(flood[belief.frame.cell(x, y)]) for x, y in points]


# -- hungarian -----------------------------------------------------------------------------------------


def cost_of(choice: Sequence[int], lengths: NDArray[np.float64]) -> tuple[int, int, float]:
    """Robots that go nowhere, pairs of robots that go to the same stop, metres: the first counts first."""
    sent = [(robot, stop) for robot, stop in enumerate(choice) if stop >= 0]
    pairs = sum(a[1] == b[1] for a, b in itertools.combinations(sent, 2))
    return len(choice) - len(sent), pairs, sum(float(lengths[pair]) for pair in sent)


@settings(deadline=None, max_examples=50)
@given(st.data())
def test_the_assignment_is_the_best_of_all_assignments(data: st.DataObject) -> None:
    robots_, stops = data.draw(st.integers(1, 4)), data.draw(st.integers(0, 4))
    entry = st.one_of(st.integers(-1, 30).map(float), st.just(INF))
    rows = data.draw(
        st.lists(st.lists(entry, min_size=stops, max_size=stops), min_size=robots_, max_size=robots_)
    )
    lengths = np.array(rows, np.float64).reshape(robots_, stops)
    able = [[-1, *np.flatnonzero(np.isfinite(row)).tolist()] for row in lengths]
    best = min(cost_of(choice, lengths) for choice in itertools.product(*able))
    assert cost_of(assign(lengths).tolist(), lengths) == pytest.approx(best)


@pytest.mark.parametrize("places", TEAMS)
def test_each_robot_takes_what_the_least_total_path_gives_it(places: Places) -> None:
    belief = frozen()
    scout = MappingPlatform(SPEC)
    placed(scout, belief, *places[0])
    assert scout.stops is not None
    lengths = np.array([lengths_to(belief, place, scout.stops.views) for place in places])
    every = itertools.permutations(range(len(scout.stops)), len(places))
    least = min(sum(lengths[robot, stop] for robot, stop in enumerate(stops)) for stops in every)
    taken = []
    for place in places:
        platform = HungarianPlatform(SPEC)
        joined(platform, belief, place, places)
        target = platform.reply(belief, NOTHING, STAY).targets[0]
        taken.append(int(np.argmin(np.hypot(*(scout.stops.targets - target).T))))
    assert len(set(taken)) == len(places)
    assert sum(lengths[robot, stop] for robot, stop in enumerate(taken)) == pytest.approx(least, abs=1e-4)


def test_a_robot_with_nowhere_to_go_stands() -> None:
    belief = frozen(np.ones((101, 143), np.uint8))  # all free: no frontier
    for kind in (HungarianPlatform, MakespanPlatform, OptimalPlatform, CostUtilityPlatform, GreedyPlatform):
        platform = kind(SPEC)
        placed(platform, belief)
        platform.carry_over(STAY)
        assert not len(platform.reply(belief, NOTHING, STAY))


# -- cost-utility --------------------------------------------------------------------------------------


def utilities(platform: CostUtilityPlatform, belief: MapBelief, bonus: Sequence[float]) -> list[float]:
    """``A exp(-beta L)`` of each stop, the area by the value of its impact."""
    assert platform.stops is not None
    found = []
    for stop, leg in enumerate(platform.stops.first_leg):
        nats = OBJECTIVE.value(belief, platform.impact(belief, platform.tour(np.array([stop]))))
        length = float(leg) * SPEC.speed - bonus[stop]
        found.append(nats / LN2 * 0.1**2 * float(np.exp(-platform.beta * length)))
    return found


@pytest.mark.parametrize("x", [-1.0, 0.5, 1.5, 3.2])
def test_cost_utility_goes_where_area_times_the_discount_of_the_way_is_largest(x: float) -> None:
    belief, platform = frozen(hidden=0.0, worth=layers.plain()), CostUtilityPlatform(SPEC)
    placed(platform, belief, x)
    assert platform.stops is not None
    count = len(platform.stops)
    best = int(np.argmax(utilities(platform, belief, np.zeros(count))))
    assert platform.reply(belief, NOTHING, STAY).stops.tolist() == [best]
    for stop in range(count):  # under way to it, it counts as a metre nearer
        sticky = int(np.argmax(utilities(platform, belief, STICK * (np.arange(count) == stop))))
        assert platform.reply(belief, NOTHING, platform.tour(np.array([stop]))).stops.tolist() == [sticky]


def test_the_expected_area_is_the_value_of_the_scan_in_square_metres() -> None:
    belief, platform = frozen(hidden=0.0, worth=layers.plain()), CostUtilityPlatform(SPEC)
    placed(platform, belief)
    assert platform.stops is not None
    alone = [platform.impact(belief, platform.tour(np.array([k]))) for k in range(len(platform.stops))]
    nats = np.array([OBJECTIVE.value(belief, impact) for impact in alone])
    np.testing.assert_allclose(expected_areas(belief, platform.stops), nats / LN2 * 0.1**2, rtol=1e-5)


def test_cost_utility_does_not_ask_where_the_others_are_or_go() -> None:
    belief, places = frozen(), [(-0.5, 7.1), (0.1, 7.3)]
    alone, mate = CostUtilityPlatform(SPEC), CostUtilityPlatform(SPEC)
    placed(alone, belief, *places[0])
    joined(mate, belief, places[0], places)
    taken = alone.impact(belief, alone.reply(belief, NOTHING, STAY))
    assert mate.reply(belief, taken, STAY).stops.tolist() == alone.reply(belief, NOTHING, STAY).stops.tolist()


# -- makespan ------------------------------------------------------------------------------------------


def plane(seed: int, robots_: int, stops: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Path lengths in the open plane: from the robots to the stops, and between these [m]."""
    rng = np.random.default_rng(seed)
    start, goal = rng.uniform(0.0, 20.0, (robots_, 1, 2)), rng.uniform(0.0, 20.0, (stops, 2))
    return np.hypot(*(start - goal).transpose(2, 0, 1)), np.hypot(*(goal[:, None] - goal).transpose(2, 0, 1))


def least_cost(first: NDArray[np.float64], between: NDArray[np.float64]) -> float:
    """Try every division of the stops among the robots, and every order."""
    stops = range(first.shape[1])

    def shortest(robot: int, part: tuple[int, ...]) -> float:
        if not part:
            return 0.0
        orders = itertools.permutations(part)
        return min(first[robot, o[0]] + sum(between[a, b] for a, b in itertools.pairwise(o)) for o in orders)

    parts = [part for size in range(len(stops) + 1) for part in itertools.combinations(stops, size)]
    path = {(robot, part): shortest(robot, part) for robot in range(len(first)) for part in parts}
    best = INF
    for owners in itertools.product(range(len(first)), repeat=len(stops)):
        divided = [tuple(s for s in stops if owners[s] == robot) for robot in range(len(first))]
        lengths = [path[robot, part] for robot, part in enumerate(divided)]
        best = min(best, max(lengths) + TIE * sum(lengths))
    return best


def test_routes_are_within_a_quarter_of_the_best_of_all_and_mostly_the_best() -> None:
    ratios = []
    for seed in range(40):
        first, between = plane(seed, 1 + seed % 3, 1 + seed % 5)
        graph = Graph.of(first, between)
        cost = float(graph.cost(graph.lengths(plan_routes(first, between))))
        ratios.append(cost / least_cost(first, between))
    assert min(ratios) > 1.0 - 1e-9
    assert max(ratios) <= 1.25
    assert np.mean(ratios) <= 1.01
    assert np.mean(np.array(ratios) < 1.0 + 1e-6) >= 0.9


@pytest.mark.parametrize("seed", range(4))
def test_routes_are_no_worse_than_their_start_and_visit_every_stop_once(seed: int) -> None:
    first, between = plane(seed, 3, 25)
    first[:, 7] = between[:, 7] = between[7] = INF  # nobody gets there
    first[0] = INF  # boxed in
    graph = Graph.of(first, between)

    def cost(routes: Routes) -> float:
        return float(graph.cost(graph.lengths(routes)))

    routes = plan_routes(first, between)
    assert cost(routes) < min(cost(insert_all(graph, True)), cost(insert_all(graph, False)))
    assert not routes[0]
    assert sorted(itertools.chain(*routes)) == [stop for stop in range(25) if stop != 7]
    assert routes == plan_routes(first, between)


@pytest.mark.parametrize("places", TEAMS)
def test_each_robot_drives_to_the_first_stop_of_its_own_route(places: Places) -> None:
    belief, firsts = frozen(), set()
    for place in places:
        platform = MakespanPlatform(SPEC)
        joined(platform, belief, place, places)
        assert platform.stops is not None
        assert platform.lengths[platform.row] == pytest.approx(platform.stops.first_leg * SPEC.speed)
        route = platform.routes[platform.row]
        assert platform.reply(belief, NOTHING, STAY).stops.tolist() == route[:1]
        firsts.add(tuple(platform.stops.targets[route[0]]))
    assert len(firsts) == len(places)


def test_a_robot_on_a_route_keeps_its_stop_if_that_costs_at_most_a_metre() -> None:
    belief, platform = frozen(), MakespanPlatform(SPEC)
    placed(platform, belief)
    platform.lengths[:, 5:] = INF  # few enough to try every order
    first, between = platform.lengths[:, :5], platform.between[:5, :5]
    platform.routes = plan_routes(platform.lengths, platform.between)
    shortest = least_cost(first, between) / (1.0 + TIE)
    kept = []
    for stop in range(5):
        rest = [other for other in range(5) if other != stop]
        onwards = least_cost(between[[stop]][:, rest], between[np.ix_(rest, rest)]) / (1.0 + TIE)
        current = platform.tour(np.array([stop]))
        kept.append(platform.reply(belief, NOTHING, current).stops.tolist() == [stop])
        assert kept[-1] == (first[0, stop] + onwards <= shortest + STICK)
    assert any(kept)
    assert not all(kept)


def test_a_robot_without_a_route_goes_only_where_nobody_else_would() -> None:
    belief, places = frozen(), [(-0.5, 7.1), (-0.2, 7.1)]
    platform = MakespanPlatform(SPEC)
    joined(platform, belief, places[0], places)
    assert platform.stops is not None
    platform.routes[platform.row] = []
    somebody = platform.impact(belief, platform.tour(np.array([0])))
    assert not len(platform.reply(belief, somebody, STAY))
    nearest = int(np.argmin(platform.stops.first_leg))
    assert platform.reply(belief, NOTHING, STAY).stops.tolist() == [nearest]


# -- optimal -------------------------------------------------------------------------------------------


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10_000))
def test_the_joint_optimum_is_that_of_trying_everything(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = frozen(worth=layers.rate())
    unknown = np.flatnonzero(dense(belief.weights))[:60]  # few, so that impacts overlap

    def impact() -> Impact:
        cells = np.sort(rng.choice(unknown, int(rng.integers(1, 30)), replace=False))
        keys = (cells * LAYERS + int(rng.integers(0, 4))).astype(np.uint32)
        return Impact(keys, rng.integers(1, 256, len(keys)).astype(np.uint8))

    candidates = [[impact() for _ in range(int(rng.integers(1, 6)))] for _ in range(int(rng.integers(1, 5)))]
    choice, value = joint_optimum(belief, candidates)
    best = exhaustive(OBJECTIVE, belief, candidates)
    assert value == pytest.approx(best.value, rel=1e-6)
    team = NOTHING
    for own, k in zip(candidates, choice, strict=True):
        team = OBJECTIVE.combine(team, own[k])
    assert OBJECTIVE.value(belief, team) == pytest.approx(value, rel=1e-6)


@pytest.mark.parametrize("places", TEAMS)
def test_a_team_that_plans_optimally_has_the_value_of_trying_everything(places: Places) -> None:
    belief = frozen(worth=layers.rate(), hidden=0.0)
    candidates, team = [], NOTHING
    for place in places:
        platform = OptimalPlatform(SPEC, max_stops=1, measured="distance")
        joined(platform, belief, place, places)
        assert platform.stops is not None
        stops = range(len(platform.stops))
        candidates.append([platform.impact(belief, platform.tour(np.array([k]))) for k in stops])
        reply = platform.reply(belief, NOTHING, STAY)
        team = OBJECTIVE.combine(team, platform.impact(belief, reply))
    assert OBJECTIVE.value(belief, team) == pytest.approx(exhaustive(OBJECTIVE, belief, candidates).value)


def test_at_the_optimum_a_robot_keeps_its_stop_unless_another_adds_clearly_more() -> None:
    belief, places = frozen(worth=layers.rate(), hidden=0.0), TEAMS[2]
    platforms = [OptimalPlatform(SPEC, max_stops=1, measured="distance") for _ in places]
    for platform, place in zip(platforms, places, strict=True):
        joined(platform, belief, place, places)
    impacts = [
        [p.impact(belief, p.tour(np.array([k]))) for k in range(len(p.stops or ()))] for p in platforms
    ]
    best = exhaustive(OBJECTIVE, belief, impacts).value
    kept = []
    for stop in range(len(impacts[0])):
        keeping = exhaustive(OBJECTIVE, belief, [[impacts[0][stop]], *impacts[1:]])
        mates = OBJECTIVE.combine(impacts[1][keeping.choice[1]], impacts[2][keeping.choice[2]])
        rest = OBJECTIVE.value(belief, mates)
        clearly = best - rest > (1.0 + STICKINESS) * (1.0 + HYSTERESIS) * (keeping.value - rest)
        reply = platforms[0].reply(belief, NOTHING, platforms[0].tour(np.array([stop])))
        kept.append(reply.stops.tolist() == [stop])
        assert kept[-1] == (not clearly or stop == platforms[0].best[0])
    assert any(kept)
    assert not all(kept)


def test_more_than_four_robots_are_refused_in_one_line() -> None:
    line = "planner 'optimal' is for at most 4 robots, not 5; use 'rate'"
    with pytest.raises(InputError, match=line):
        planner("optimal", robots=5)
    platform = OptimalPlatform(SPEC)
    platform.place(0.0, 7.1, [], [(robot, 0.3 * robot, 7.1) for robot in range(5)], 0.0)
    with pytest.raises(InputError, match=line):
        platform.prepare(frozen())
    assert planner("optimal", robots=4) is PLANNERS["optimal"]


# -- greedy and jacobi ---------------------------------------------------------------------------------


def test_greedy_robots_reply_once_to_those_before_them_and_nobody_begins_with_anything() -> None:
    belief, places = frozen(), TEAMS[2]
    before = expected = NOTHING
    for place in places:
        greedy, plain = GreedyPlatform(SPEC), MappingPlatform(SPEC)
        for platform in (greedy, plain):
            placed(platform, belief, *place)
        assert not len(greedy.carry_over(STAY))
        reply = greedy.reply(belief, before, STAY)
        best = plain.reply(belief, expected, STAY)
        assert reply.stops.tolist() == best.stops.tolist()
        before = OBJECTIVE.combine(before, greedy.impact(belief, reply))
        expected = OBJECTIVE.combine(expected, plain.impact(belief, best))
        assert greedy.reply(belief, expected, reply) is reply  # a second time round nobody changes


def test_greedy_has_the_hysteresis_of_all_planners_though_it_begins_with_nothing() -> None:
    belief, greedy, plain = frozen(), GreedyPlatform(SPEC, max_stops=1), MappingPlatform(SPEC, max_stops=1)
    for platform in (greedy, plain):
        placed(platform, belief)
    assert plain.stops is not None
    for stop in range(len(plain.stops)):
        current = plain.tour(np.array([stop]))
        assert not len(greedy.carry_over(current))
        reply = greedy.reply(belief, NOTHING, STAY)
        assert reply.stops.tolist() == plain.reply(belief, NOTHING, current).stops.tolist()


def test_a_lost_round_does_not_cost_a_greedy_robot_its_tour() -> None:
    def stop_of(tour: Tour) -> list[int]:
        return tour.stops.tolist()

    belief, greedy = frozen(), GreedyPlatform(SPEC, max_stops=1)
    placed(greedy, belief)
    assert greedy.stops is not None
    present = greedy.tour(np.array([int(np.argmax(greedy.stops.first_leg))]))
    greedy.carry_over(present)
    once = stop_of(replace_round(greedy, belief, answered=True))
    greedy.carry_over(present)
    assert stop_of(replace_round(greedy, belief, answered=False)) == once


def replace_round(greedy: GreedyPlatform, belief: MapBelief, *, answered: bool) -> Tour:
    """Reply in this round, or lose it and reply in the next."""
    if not answered:
        greedy.carry_over(STAY)
    return greedy.reply(belief, NOTHING, STAY)


def test_jacobi_differs_from_rate_by_its_scheme_alone() -> None:
    rate, jacobi = planner("rate"), planner("jacobi")
    assert (rate.scheme, jacobi.scheme) == (None, "jacobi")
    assert (rate.hidden, rate.return_price) == (jacobi.hidden, jacobi.return_price)
    assert np.array_equal(rate.layers.weights, jacobi.layers.weights)
    a, b = rate.platform(SPEC), jacobi.platform(SPEC)
    assert (type(a), a.max_stops, a.measured) == (type(b), b.max_stops, b.measured)


# -- all of them ---------------------------------------------------------------------------------------

ROOMS = """
################
#      #       #
#              #
#      #       #
#      #       #
### ####### ####
#              #
#              #
################
"""


@pytest.mark.parametrize("name", ["jacobi", "greedy", "optimal", "cost-utility", "hungarian", "makespan"])
def test_a_mission_with_each_planner_is_completed(name: str) -> None:
    scheme = planner(name).scheme or "token"
    _, report = run(drawn(ROOMS), robots(2, range=4.0), planner=name, scheme=scheme)
    check_complete(report)


@pytest.mark.parametrize("kind", [HungarianPlatform, MakespanPlatform, OptimalPlatform])
def test_planning_again_gives_the_same(kind: type[TeamPlatform]) -> None:
    belief, chosen = frozen(), []
    for _ in range(2):
        platform = kind(SPEC)
        joined(platform, belief, TEAMS[2][0], TEAMS[2])
        chosen.append(platform.reply(belief, NOTHING, STAY).stops.tolist())
    assert chosen[0] == chosen[1]


@pytest.mark.parametrize(("name", "rows"), [("rate", (0, 2)), ("entropy", (0, 2)), ("tours", (2, 14))])
def test_the_papers_planners_learn_sightings_by_distance_and_tours_by_unknown_length(
    name: str, rows: tuple[int, int]
) -> None:
    belief = frozen(worth=PLANNERS[name].layers)
    platform = PLANNERS[name].platform(SPEC)
    before = platform.model(belief).table
    for first, last in ((0, 2), (2, 14)):
        counts = belief.counts.copy()
        counts[first:last:2], counts[first + 1 : last : 2] = 10**6, 10**5  # one in ten was seen
        learned = platform.model(replace(belief, counts=counts)).table
        assert np.array_equal(learned, before) == ((first, last) != rows)
