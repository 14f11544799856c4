"""A robot's mission: what goes into its map and what does not, and two robots that tell each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs
from numpy.typing import NDArray

from tests.support.explorers import HERE, exchange, explorer, mate_at, scan_from
from tests.support.mapping_scenes import FRAME, RESOLUTION, SPEC, building
from vedette.agent.events import Pose
from vedette.agent.mates import Mate
from vedette.domains.mapping import views
from vedette.domains.mapping.planners import planner
from vedette.domains.mapping.sightings import BINS, ROWS
from vedette.domains.mapping.stops import CLEARANCES
from vedette.domains.mapping.tour import STAY
from vedette.fusion import ReplicatedEvidence
from vedette.kernels.frontier import traversable
from vedette.kernels.tiles import TiledGrid
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.maps.lattice import Lattice
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.failures import AVOID_TIME, CHANCES, TRIES
from vedette.team import PlatformSpec

THERE = Pose(3.04, 7.08, 0.0)


def look(mission: Exploring, pose: Pose, times: int = 10, seed: int = 0) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(times):
        mission.observe(scan_from(pose, rng), pose, [], 0.0)
    mission.publish(0.0)


def occupied_near(mission: Exploring, mate: Mate) -> NDArray[np.bool_]:
    mission.publish(0.0)
    away = np.hypot(*(FRAME.centres(np.arange(FRAME.size)) - (mate.x, mate.y)).T)
    near = np.flatnonzero(away < mate.radius + 0.1)
    return np.equal(mission.fusion.classes.window().flat[near], OCCUPIED)


def test_team_mates_of_any_size_do_not_get_into_the_map() -> None:
    for mate in (mate_at(1.0, 7.2), mate_at(1.4, 7.1, radius=0.45)):
        aware, unaware = explorer(), explorer()
        rng = np.random.default_rng(0)
        for _ in range(10):
            scan = scan_from(HERE, rng, mates=(mate,))
            aware.observe(scan, HERE, [mate], 0.1)
            unaware.observe(scan, HERE, [], 0.1)
        assert occupied_near(unaware, mate).any()
        assert not occupied_near(aware, mate).any()


def test_a_mate_that_drove_on_since_its_beacon_does_not_get_into_the_map() -> None:
    mission, told, there = explorer(), mate_at(1.0, 7.2), mate_at(1.15, 7.2)
    mission.observe(scan_from(HERE, np.random.default_rng(0), mates=(there,)), HERE, [told], 0.3)
    assert not occupied_near(mission, there).any()


def test_what_noisy_scans_show_is_right_up_to_one_cell_from_the_true_walls() -> None:
    mission = explorer()
    look(mission, HERE, times=20)
    classes, solid = mission.fusion.classes.window(), np.pad(building(), 1, mode="edge")
    around = [solid[1 + r : 102 + r, 1 + c : 144 + c] for r in (-1, 0, 1) for c in (-1, 0, 1)]
    deep_in_walls, deep_in_rooms = np.all(around, axis=0), ~np.any(around, axis=0)
    assert not (classes[deep_in_walls] == FREE).any()
    assert not (classes[deep_in_rooms] == OCCUPIED).any()
    assert np.count_nonzero(classes == FREE) > 1000
    assert np.count_nonzero(classes == OCCUPIED) > 50


def test_sightings_are_counted_only_of_what_was_unknown() -> None:
    mission = explorer()
    look(mission, HERE, times=1)
    first = mission.own.counts.copy()
    tried, seen = first[[0, 2]], first[[1, 3]]
    assert np.all(seen <= tried)
    assert np.all(seen[:, 0] == tried[:, 0])  # everything near was seen
    assert not tried[0, int(SPEC.range / 0.25) :].any()
    look(mission, HERE, times=1, seed=1)
    assert (mission.own.counts[1] - first[1]).sum() < 0.2 * first[1].sum()


def test_two_robots_that_exchange_hold_the_same_map_and_freeze_the_same_belief() -> None:
    one, other = explorer(0), explorer(1)
    look(one, HERE)
    look(other, THERE, seed=1)
    assert one.fusion.digest != other.fusion.digest
    exchange(one, other)
    assert one.fusion.digest == other.fusion.digest
    np.testing.assert_array_equal(one.fusion.counts, (one.own.counts + other.own.counts).ravel())
    a, b = one.freeze(0.0), other.freeze(0.0)
    for name in ("classes", "frontier_cells", "frontier_starts", "counts"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
    np.testing.assert_array_equal(a.weights.window, b.weights.window)
    known = np.count_nonzero(one.fusion.classes.window() != UNKNOWN)
    assert known > np.count_nonzero(one.own.log_odds.window()) > 0


def prepared(mission: Exploring, now: float = 0.0, mates: Sequence[Mate] = ()) -> None:
    belief = mission.freeze(0.0)
    mission.prepare(belief, HERE, mates, False, now)
    mission.strategy = mission.platform.reply(belief, mission.objective.nothing(belief), mission.strategy)


def reachable(mission: Exploring, target: list[float]) -> bool:
    stops = mission.platform.stops
    assert stops is not None
    return bool(np.isfinite(stops.first_leg[stops.targets.tolist().index(target)]))


def at(place: NDArray[np.float64]) -> Pose:
    return Pose(float(place[0]), float(place[1]), 0.0)


def test_a_released_stop_is_left_alone_for_a_while_and_a_reached_one_is_followed_by_the_next() -> None:
    mission = explorer()
    look(mission, HERE)
    prepared(mission)
    first, second = mission.strategy.targets[:2].tolist()
    mission.reached(at(mission.strategy.views[0]), [], 1.0)
    assert mission.strategy.targets[0].tolist() == second
    mission.release(1.0)
    assert mission.goal() is None
    prepared(mission, now=1.0 + 0.5 * AVOID_TIME)
    assert not reachable(mission, second)  # avoided
    assert not reachable(mission, first)  # given up: the visit changed nothing
    prepared(mission, now=1.1 + AVOID_TIME)
    assert reachable(mission, second)
    assert not reachable(mission, first)


def test_a_robot_that_is_kept_from_work_claims_and_ends_nothing_and_holds_nothing_against_a_stop() -> None:
    mission = explorer()
    look(mission, HERE)
    prepared(mission)
    first = mission.strategy.targets[0].tolist()
    mission.stand_by()
    assert mission.goal() is None
    belief = mission.freeze(0.0)
    mission.prepare(belief, replace(HERE, at_work=False), [], False, 1.0)
    nothing = mission.objective.nothing(belief)
    assert mission.platform.reply(belief, nothing, mission.strategy) == STAY
    assert mission.platform.slack(belief, nothing) == 0.0
    assert not mission.nothing_left(0.0, 1.0)
    prepared(mission, now=1.1)
    assert reachable(mission, first)


def test_a_goal_is_served_when_a_mate_has_seen_most_of_what_it_was_to_reveal() -> None:
    mission = explorer()
    look(mission, HERE)
    prepared(mission)
    assert not mission.served()
    x, y = mission.strategy.targets[0].tolist()
    row, col = FRAME.cell(x, y)
    near = np.arange(FRAME.size).reshape(FRAME.shape)[row - 6 : row + 7, col - 6 : col + 7].ravel()
    mission.own.log_odds.put(near, np.full(len(near), -4, np.int8))
    mission.fusion.publish(mission.own.log_odds, None, None)
    assert mission.served()


def before_a_passage(width: int) -> NDArray[np.uint8]:
    """Return the map of a room that has one way on, a passage of so many cells into the unknown."""
    classes = np.full(FRAME.shape, OCCUPIED, np.uint8)
    classes[30:70, 10:60] = FREE
    classes[45 : 45 + width, 60:115] = FREE
    classes[45 : 45 + width, 115:] = UNKNOWN
    return classes


def broad_explorer(classes: NDArray[np.uint8]) -> Exploring:
    """Return the mission of a robot 0.48 m across that knows this map."""
    fusion = ReplicatedEvidence(0, 1, FRAME.shape, ROWS * BINS)
    fusion.publish(TiledGrid.of(np.array([0, -20, 20], np.int8)[classes]), None, None)
    spec = PlatformSpec(range=4.0, radius=0.24)
    return Exploring(Lattice(FRAME), spec, planner("tours"), fusion)


def test_a_robot_takes_a_narrow_way_where_there_is_no_wider_one_and_none_that_its_body_does_not_fit() -> None:
    for width, fits in ((3, False), (4, False), (5, True), (8, True)):
        mission = broad_explorer(before_a_passage(width))
        prepared(mission)
        assert (mission.goal() is not None) == fits, width
        deep = (FRAME.origin_x + 11.0, FRAME.origin_y + 4.5 + 0.05 * width)
        assert (mission.route(HERE, deep, [], False, 0.0) is not None) == fits, width


def test_a_robot_keeps_its_usual_clearance_wherever_that_leads_to_something() -> None:
    classes = before_a_passage(8)
    classes[60:65, 60:115] = FREE  # another way on, for the lesser clearance only
    classes[60:65, 115:] = UNKNOWN
    mission = broad_explorer(classes)
    prepared(mission)
    ground, goal = mission.platform.ground, mission.goal()
    assert ground is not None
    assert goal is not None
    usual = traversable(classes, mission.spec.radius + CLEARANCES[0], RESOLUTION)
    assert ground.passable.sum() == usual.sum()
    route = mission.route(HERE, goal, [], False, 0.0)
    assert route is not None
    np.testing.assert_array_equal(route.passable, usual)


def test_a_stop_that_cannot_be_carried_out_is_left_alone_longer_each_time_and_given_up_in_the_end() -> None:
    mission = explorer()
    look(mission, HERE)
    prepared(mission)
    now, waits = 0.0, []
    tour = mission.strategy
    for _ in range(TRIES - 1):
        mission.strategy = tour
        mission.release(now)
        waits.append(mission.platform.left_alone.avoided[-1][2] - now)
        now += waits[-1] + 1.0
    assert waits == sorted(set(waits))
    two_rounds = 8.0  # that agree on the end, at most [s]
    assert sum(waits) + two_rounds <= 40.0  # so long a mission may last with nothing new and nobody driving
    assert not mission.platform.left_alone.given_up
    mission.strategy = tour
    mission.release(now)
    assert [(spot.x, spot.y) for spot in mission.platform.left_alone.given_up] == [tuple(tour.targets[0])]


def test_a_stop_that_mates_kept_a_robot_from_is_taken_up_again_when_one_of_them_has_gone() -> None:
    mission, now = explorer(), 0.0
    look(mission, HERE)
    prepared(mission)
    tour = mission.strategy
    target = tour.targets[0].tolist()
    for chance in range(CHANCES + 1):
        there = structs.replace(mate_at(HERE.x + 1.0 + 1.6 * (chance % 2), HERE.y), heard=now)
        for _ in range(TRIES):
            mission.strategy = tour
            prepared(mission, now, [there])
            mission.strategy = tour
            mission.release(now)
            now += 20.0
            there = structs.replace(there, heard=now)
        prepared(mission, now, [there])
        assert not reachable(mission, target)  # while the mate stands there
        gone = structs.replace(there, x=there.x + (-1.6 if chance % 2 else 1.6), heard=now)
        prepared(mission, now, [gone])
        assert reachable(mission, target) == (chance < CHANCES)


def test_a_round_that_is_cut_short_is_not_taken_for_a_quiet_one(monkeypatch: pytest.MonkeyPatch) -> None:
    mission = explorer()
    prepared(mission)
    assert mission.nothing_left(0.0, now=0.0)  # nothing is known, so there is no frontier
    look(mission, HERE)
    monkeypatch.setattr(views, "MOST_WORK", 0)
    prepared(mission)
    assert mission.goal() is None
    assert not mission.nothing_left(0.0, now=0.0)
