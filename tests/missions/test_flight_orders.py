"""Orders to vehicles: they hold, come home, keep out, and see first to what matters more."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from tests.support import monitor_scenes, search_missions, track_scenes
from vedette.agent.orders import (
    End,
    Exclude,
    LookThere,
    NoGo,
    Order,
    Pause,
    Priority,
    Recall,
    Remove,
    Resume,
    Stay,
)
from vedette.errors import InputError
from vedette.maps.area import Area
from vedette.outcome import Outcome
from vedette.run import DomainMission, Search, Track
from vedette.sim.domains import domain_of
from vedette.sim.orders import OrderAt

FAR = {"target": {"start": [1190, 790]}}  # nobody finds it in time
MIDDLE = ((130.0, 100.0), (190.0, 100.0), (190.0, 160.0), (130.0, 160.0))


def at(*orders: tuple[float, Order]) -> tuple[OrderAt, ...]:
    """Orders with their times."""
    return tuple(OrderAt(time, order) for time, order in orders)


def tracking(*orders: tuple[float, Order], **changes: Any) -> Track:
    """Three vehicles of 45 m radius that track."""
    return Track(track_scenes.content(**changes), orders=at(*orders))


def searching(*orders: tuple[float, Order], **changes: Any) -> Search:
    """Three vehicles of 75 m radius that search."""
    return Search(search_missions.SMALL | FAR | changes, orders=at(*orders))


def monitoring(*orders: tuple[float, Order], **changes: Any) -> DomainMission[Any]:
    """A rover of 1 m/s and a heron of 2 m/s that stand where they like."""
    return DomainMission(domain_of("monitor"), monitor_scenes.SMALL | changes, orders=at(*orders))


def own(*orders: tuple[float, Order]) -> DomainMission[Any]:
    """The skeleton of a domain of somebody's own."""
    return DomainMission(domain_of("vedette.missions.own.skeleton:Skeleton"), orders=at(*orders))


def flown(mission: Any, until: float) -> np.ndarray:
    """Where everybody is at each tick, (N, n, 3)."""
    poses = []
    while mission.over is None and mission.now < until - 1e-6:
        mission.step()
        poses.append(mission.poses)
    return np.array(poses)


@pytest.mark.parametrize(
    ("make", "radius", "word"),
    [(tracking, 45.0, "paused"), (searching, 75.0, "paused"), (monitoring, 0.0, "paused")],
)
def test_a_paused_vehicle_circles_or_stands_and_works_again_when_resumed(
    make: Callable[..., Any], radius: float, word: str
) -> None:
    mission = make((5.0, Pause(robot=2)), (15.0, Resume(robot=2)))
    flown(mission, 6.0)
    held = flown(mission, 15.0)[:, 1, :2]
    assert mission.states[1] == word
    assert "paused" not in (mission.states[0], *mission.states[2:])
    assert np.hypot(*(held - held[0]).T).max() <= 2.0 * radius + 1e-6
    flown(mission, 23.0)
    assert mission.states[1] in ("flying", "driving")
    assert np.hypot(*(mission.poses[1, :2] - held[-1])) > (2.0 if radius == 0.0 else 20.0)


def test_while_a_vehicle_is_held_the_others_reckon_with_nothing_of_it() -> None:
    mission = tracking((5.0, Pause(robot=2)))
    flown(mission, 12.0)
    impacts = [deciding.impact for deciding in mission.deciding]
    assert len(impacts[1].targets) == 0
    assert len(impacts[0].targets) + len(impacts[2].targets) > 0


@pytest.mark.parametrize(("make", "near"), [(tracking, 115.0), (searching, 190.0), (monitoring, 1.0)])
def test_a_recalled_team_comes_home_and_the_mission_is_over_by_order(
    make: Callable[..., Any], near: float
) -> None:
    mission = make((6.0, Recall()), duration=120)
    starts = mission.poses[:, :2]
    while mission.step() is None:
        pass
    assert mission.over is Outcome.ORDERED
    assert mission.now < 60.0
    assert set(mission.states) == {"done"}
    assert (np.hypot(*(mission.poses[:, :2] - starts).T) <= near).all()


def test_one_that_is_to_look_goes_there_and_then_works_on() -> None:
    mission = tracking((3.0, LookThere(robot=1, at=(250.0, 30.0))))
    poses = flown(mission, 30.0)[:, 0, :2]
    closest = np.hypot(*(poses - (250.0, 30.0)).T)
    assert closest.min() < 8.0
    assert mission.states[0] == "flying"


@pytest.mark.parametrize("make", [tracking, searching, monitoring])
def test_the_team_ends_where_it_is(make: Callable[..., Any]) -> None:
    mission = make((4.0, End()))
    while mission.step() is None:
        pass
    assert mission.over is Outcome.ORDERED
    assert mission.now <= 5.0


def test_who_is_to_stay_is_done_and_the_others_go_on() -> None:
    mission = tracking((4.0, Stay(robot=3)))
    while mission.step() is None:
        pass
    assert mission.over is Outcome.COMPLETE
    assert mission.states[2] == "done"


@pytest.mark.parametrize(
    ("make", "corners"),
    [
        (tracking, MIDDLE),
        (searching, ((300.0, 350.0), (500.0, 350.0), (500.0, 550.0), (300.0, 550.0))),
        (monitoring, ((6.0, 3.0), (10.0, 3.0), (10.0, 9.0), (6.0, 9.0))),
        (own, ((80.0, 80.0), (120.0, 80.0), (120.0, 120.0), (80.0, 120.0))),
    ],
)
def test_a_no_go_area_is_never_entered_once_it_is_heard_of(
    make: Callable[..., Any], corners: tuple[tuple[float, float], ...]
) -> None:
    free, bound = make(), make((0.0, NoGo(area="a", corners=corners)))
    area = Area(corners)
    places = [flown(mission, 1e9)[..., :2].reshape(-1, 2) for mission in (free, bound)]
    assert area.distance(places[0]).min() == 0.0  # without the order somebody goes there
    assert area.distance(places[1]).min() > 0.0
    assert bound.over is Outcome.COMPLETE or bound.over is Outcome.TIME_LIMIT


@pytest.mark.parametrize("seed", [1, 2])
def test_one_inside_a_new_no_go_area_leaves_it_and_does_not_come_back(seed: int) -> None:
    corners = ((20.0, 20.0), (90.0, 20.0), (90.0, 90.0), (20.0, 90.0))  # where two of three start
    area, order = Area(corners), NoGo(area="a", corners=corners)
    mission = Track(track_scenes.content(), seed, orders=at((1.0, order)))
    poses = flown(mission, 1e9)[..., :2]
    for i in range(3):
        inside = area.distance(poses[:, i]) <= 0.0
        changes = [(a, b) for a, b in pairwise(inside[15:].tolist()) if a != b]
        assert changes in ([], [(True, False)])
        assert not inside[-1]


def test_who_stands_by_order_stays_in_a_new_no_go_area_and_who_works_leaves_it() -> None:
    corners = ((0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (0.0, 5.0))
    mission = monitoring((1.0, Pause(robot=1)), (2.0, NoGo(area="a", corners=corners)))
    poses = flown(mission, 20.0)
    assert np.hypot(*(poses[-1, 0, :2] - poses[25, 0, :2])) < 1e-9
    working = monitoring((2.0, NoGo(area="a", corners=corners)))
    flown(working, 20.0)
    assert Area(corners).distance(working.poses[:1, :2])[0] > 0.0


def test_recalled_vehicles_go_round_what_is_forbidden() -> None:
    wall = ((100.0, 0.0), (120.0, 0.0), (120.0, 200.0), (100.0, 200.0))
    mission = tracking(
        (0.0, NoGo(area="a", corners=wall)), (0.5, Recall(robot=1, to=(200.0, 60.0))), duration=90
    )
    poses = flown(mission, 89.0)[:, 0, :2]
    assert Area(wall).distance(poses).min() > 0.0
    assert np.hypot(*(poses[-1] - (200.0, 60.0))) <= 115.0
    assert mission.states[0] == "done"


def test_a_target_in_a_priority_area_is_seen_to_first() -> None:
    scenario = {
        "area": [0, 0, 400, 200], "duration": 12, "horizon": 6, "decisions": 3,
        "vehicles": [
            {"start": [200, 40, 90], "speed": 18, "turn_rate": 0.5, "sensor": track_scenes.MIXED[0]}
        ],
        "targets": [
            {"model": "static", "mean": [x, 120], "sd": [25, 25]} for x in (100, 300)
        ],
    }  # fmt: skip
    nearer = []
    for corners in (
        ((50, 50), (150, 50), (150, 190), (50, 190)),
        ((250, 50), (350, 50), (350, 190), (250, 190)),
    ):
        mission = Track(scenario, orders=at((0.0, Priority(area="a", corners=corners, factor=50.0))))
        flown(mission, 11.0)
        nearer.append(float(mission.poses[0, 0]))
    assert nearer[0] < 180.0
    assert nearer[1] > 220.0


def test_where_it_matters_more_a_search_looks_first() -> None:
    scenario = search_missions.SMALL | FAR
    scenario["prior"] = [{"type": "gaussian", "mean": [x, 400], "sigma": 60} for x in (250, 950)]
    scenario["vehicles"] = [{"start": [600, 200, 90], "speed": 30, "turn_rate": 0.4}]
    ends = []
    for x in (250.0, 950.0):
        corners = ((x - 150, 250.0), (x + 150, 250.0), (x + 150, 550.0), (x - 150, 550.0))
        mission = Search(scenario, orders=at((0.0, Priority(area="a", corners=corners, factor=50.0))))
        flown(mission, 14.0)
        ends.append(float(mission.poses[0, 0]))
    assert ends[0] < 560.0
    assert ends[1] > 640.0


def test_where_it_matters_more_a_field_is_measured_first() -> None:
    one = [{"name": "rover", "start": [8, 6], "speed": 1}]
    ends = []
    for x in (0.0, 10.0):
        corners = ((x, 0.0), (x + 6.0, 0.0), (x + 6.0, 12.0), (x, 12.0))
        mission = monitoring((0.0, Priority(area="a", corners=corners, factor=50.0)), vehicles=one)
        flown(mission, 8.0)
        ends.append(float(mission.poses[0, 0]))
    assert ends[0] < 7.0
    assert ends[1] > 9.0


def test_the_same_orders_make_the_same_mission() -> None:
    orders = ((2.0, Pause(robot=1)), (4.0, NoGo(area="a", corners=MIDDLE)), (9.0, Resume()))
    first, second = (flown(tracking(*orders), 20.0) for _ in range(2))
    np.testing.assert_array_equal(first, second)


OUTSIDE = ((900.0, 900.0), (950.0, 900.0), (950.0, 950.0))


@pytest.mark.parametrize(
    ("make", "orders", "words"),
    [
        (tracking, [Pause(robot=4)], "there is no robot 4 in a team of 3"),
        (tracking, [NoGo(area="a", corners=OUTSIDE)], "the area lies outside: x is 0 to 300 m"),
        (tracking, [NoGo(area="a", corners=((0, 0), (1, 1), (2, 2)))], "all corners are on a line"),
        (tracking, [Recall(to=(500.0, 0.0))], "500, 0 lies outside"),
        (tracking, [LookThere(at=(50.0, 50.0))], "trackers weigh targets, not places"),
        (tracking, [Exclude(robot=1)], "robots that explore alone"),
        (tracking, [Remove(area="b")], "there is no such area by then"),
        (
            tracking,
            [NoGo(area="yard", corners=MIDDLE), Recall(to=(150.0, 120.0))],
            "150, 120 lies in the no-go area yard",
        ),
        (own, [Priority(area="a", corners=((10, 10), (90, 10), (90, 90)))], "a domain of somebody's own"),
        (searching, [Recall(to=(-5.0, 0.0))], "-5, 0 lies outside: x is 0 to 1200 m"),
    ],
)
def test_an_order_that_makes_no_sense_is_refused_in_a_line(
    make: Callable[..., Any], orders: list[Order], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        make(*((1.0, order) for order in orders))
    mission = make()
    for order in orders[:-1]:
        mission.order(order)
    mission.step(ticks=2)
    with pytest.raises(InputError, match=words):
        mission.order(orders[-1])
    assert all(len(book.all) == len(orders) - 1 for book in mission.books)


def test_robots_on_the_ground_are_not_sent_where_there_is_no_way_and_flyers_are() -> None:
    yard = [[10, 2], [14, 2], [14, 6], [10, 6]]
    with pytest.raises(InputError, match="no robot on the ground can be at 12, 4"):
        monitoring((1.0, Recall(robot=1, to=(12.0, 4.0))), no_go=[yard])
    mission = monitoring((1.0, Recall(robot=2, to=(12.0, 4.0))), no_go=[yard])
    flown(mission, 20.0)
    assert mission.poses[1, :2] == pytest.approx((12.0, 4.0), abs=1.0)
