"""Orders in simulation: who is told to stand stands, nobody enters a no-go area, a recall brings all home."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec import yaml

from tests.support.small_missions import TWO_ROOMS, drawn, small_office
from vedette.agent.orders import (
    Given,
    LookThere,
    NoGo,
    Order,
    OrderBook,
    Pause,
    Priority,
    Recall,
    Remove,
    Resume,
)
from vedette.errors import InputError
from vedette.maps.area import Area
from vedette.outcome import Outcome
from vedette.run import Explore
from vedette.sim.orders import OrderAt, load_orders
from vedette.team import PlatformSpec

RADIUS = 0.2  # of the robots [m]
WEST = ((0.0, 0.0), (3.0, 0.0), (3.0, 10.0), (0.0, 10.0))


def ordered(*orders: tuple[float, Order], **options: Any) -> Explore:
    """A mission of two robots in a small office with orders at times."""
    given = [OrderAt(at, order) for at, order in orders]
    return Explore(small_office(), options.pop("team", 2), orders=given, **options)


def places(mission: Explore, until: float) -> np.ndarray:
    """Where the robots were at each tick up to a time, ``(T, n, 2)`` [m]."""
    seen = []
    while mission.now < until - 1e-9 and mission.step() is None:
        seen.append(mission.poses[:, :2])
    return np.array(seen)


def test_a_paused_robot_stands_the_others_go_on_and_the_mission_with_it() -> None:
    mission = ordered((8.0, Pause(robot=2)), (300.0, Resume(robot=2)), max_time=400.0)
    before, during = places(mission, 9.0), places(mission, 299.0)
    moved = np.hypot(*(during - during[0]).transpose(2, 0, 1)).max(axis=0)
    assert np.hypot(*(before[-1] - before[0]).T).min() > 0.1
    assert moved[1] < 0.05
    assert moved[0] > 2.0
    assert mission.over is None  # though there is nothing left for the other
    assert mission.states[1] == "paused"
    result = mission.run()
    assert result.outcome is Outcome.COMPLETE
    assert result.time_s > 300.0


def test_a_paused_team_is_not_ended_for_want_of_progress() -> None:
    mission = ordered((5.0, Pause()), (700.0, Resume()), max_time=1000.0)
    assert mission.run().outcome is Outcome.COMPLETE


@pytest.mark.parametrize("radio", [None, 40.0])
def test_a_recall_brings_everybody_home(radio: float | None) -> None:
    mission = ordered((20.0, Recall()), radio=radio)
    result = mission.run()
    assert result.outcome is Outcome.ORDERED
    starts = mission.simulation.starts[:, :2]
    assert np.hypot(*(mission.poses[:, :2] - starts).T).max() <= 0.31


def test_one_robot_is_recalled_to_a_place_and_the_other_finishes() -> None:
    mission = Explore(small_office(), 2)
    x, y = mission.simulation.starts[0, :2].tolist()
    mission = ordered((10.0, Recall(robot=2, to=(x, y))))
    result = mission.run()
    assert result.outcome is Outcome.COMPLETE
    assert np.hypot(*(mission.poses[1, :2] - (x, y))) <= 1.0  # the other may have wanted to pass


def test_nobody_enters_a_no_go_area_and_it_leaves_the_denominator() -> None:
    free = Explore(small_office(), 2)
    driven = places(free, 3600.0).reshape(-1, 2)
    assert free.result().no_go_m2 == 0.0
    corners = np.array([(x, y) for x in (0.0, 12.0) for y in (0.0, 10.0)])
    starts = free.simulation.starts[:, :2]
    corner = corners[np.hypot(*(corners[:, None] - starts).transpose(2, 0, 1)).min(axis=1).argmax()]
    area = tuple(
        (float(x), float(y)) for x, y in corner + 3.0 * np.array(((-1, -1), (1, -1), (1, 1), (-1, 1)))
    )
    assert Area(area).distance(driven).min() == 0.0  # without the order somebody drives there
    mission = ordered((0.0, NoGo(area="corner", corners=area)))
    seen = places(mission, 3600.0)
    away = Area(area).distance(seen.reshape(-1, 2))
    assert away.min() >= RADIUS - 1e-6
    result = mission.result()
    assert result.outcome is Outcome.COMPLETE
    assert result.no_go_m2 > 1.0
    assert result.coverage is not None
    assert result.coverage > 0.97


def test_who_is_inside_a_new_no_go_area_leaves_it_and_stays_out() -> None:
    mission = Explore(small_office(), 2)
    places(mission, 15.0)
    x, y = mission.poses[0, :2].tolist()
    square = ((x - 0.6, y - 0.6), (x + 0.6, y - 0.6), (x + 0.6, y + 0.6), (x - 0.6, y + 0.6))
    mission = ordered((15.0, NoGo(area="here", corners=square)), max_time=120.0)
    places(mission, 15.0)
    assert Area(square).distance(mission.poses[:1, :2])[0] == 0.0
    later = places(mission, 120.0)
    away = np.array([Area(square).distance(each).min() for each in later])
    out = int(np.argmax(away >= RADIUS - 1e-6))
    assert out < 80  # ticks of 0.1 s
    assert away[out:].min() >= RADIUS - 1e-6


def test_an_area_that_is_removed_is_explored_after_all() -> None:
    mission = ordered((0.0, NoGo(area="west", corners=WEST)), (30.0, Remove(area="west")))
    result = mission.run()
    assert result.outcome is Outcome.COMPLETE
    assert result.no_go_m2 == 0.0


LEFT_ROOM, RIGHT_ROOM = (2.0, 2.0), (6.0, 2.0)  # [m]
DOOR = ((3.9, 1.0), (4.6, 1.0), (4.6, 3.0), (3.9, 3.0))  # between the two, wall and all


def in_two_rooms(*orders: tuple[float, Order], starts: Sequence[tuple[float, float]]) -> Explore:
    """Robots in two rooms with a door between them, of whom each begins in one."""
    team = [PlatformSpec(f"robot-{i + 1}", start=start) for i, start in enumerate(starts)]
    given = [OrderAt(at, order) for at, order in orders]
    return Explore(drawn(TWO_ROOMS), team, orders=given, max_time=200.0)


def test_what_a_no_go_area_cuts_off_leaves_the_denominator_and_the_summary_says_so() -> None:
    result = in_two_rooms((0.0, NoGo(area="door", corners=DOOR)), starts=[LEFT_ROOM]).run()
    assert result.outcome is Outcome.COMPLETE
    assert result.cut_off_m2 == pytest.approx(6 * 5 * 0.25, rel=0.1)  # the right room, but for the area
    assert result.no_go_m2 == pytest.approx(0.7 * 2.0 - 2 * 0.5 * 0.5, rel=0.35)
    assert result.coverage is not None
    assert result.coverage > 0.97


def test_what_somebody_behind_a_no_go_area_still_gets_to_counts() -> None:
    order = 0.0, NoGo(area="door", corners=DOOR)
    result = in_two_rooms(order, starts=[LEFT_ROOM, RIGHT_ROOM]).run()
    assert result.outcome is Outcome.COMPLETE
    assert result.cut_off_m2 < 0.1
    assert result.coverage is not None
    assert result.coverage > 0.97


def test_what_was_cut_off_returns_when_the_area_is_removed() -> None:
    orders = (0.0, NoGo(area="door", corners=DOOR)), (3.0, Remove(area="door"))
    mission = in_two_rooms(*orders, starts=[LEFT_ROOM])
    places(mission, 2.5)
    assert mission.snapshot is not None
    assert mission.snapshot.coverage is not None
    before = mission.snapshot.coverage
    places(mission, 4.1)
    assert mission.snapshot.coverage < before - 0.1
    result = mission.run()
    assert (result.no_go_m2, result.cut_off_m2) == (0.0, 0.0)
    assert result.coverage is not None
    assert result.coverage > 0.97


def test_the_same_orders_make_the_same_mission() -> None:
    orders = (5.0, Pause(robot=1)), (9.0, Resume()), (12.0, Priority(area="west", corners=WEST))
    first, second = (ordered(*orders, max_time=60.0).run() for _ in range(2))
    assert first.to_json() == second.to_json()


def test_robots_out_of_contact_keep_what_they_heard_last() -> None:
    mission = ordered(
        (5.0, Pause()), (15.0, Resume()), radio=40.0, faults=None, max_time=25.0, kills=[], link_loss=0.0
    )
    places(mission, 14.0)
    assert mission.states == ("paused", "paused")
    apart = ordered((5.0, Pause()), radio=0.3, max_time=25.0)
    places(apart, 14.0)
    assert apart.states[0] == "paused"
    assert apart.states[1] != "paused"


ORDERS: Sequence[Order] = (
    Pause(),
    Pause(robot=1),
    Resume(),
    Resume(robot=1),
    Recall(robot=2),
    NoGo(area="a", corners=WEST),
    Remove(area="a"),
    Priority(area="a", corners=WEST),
)


@settings(max_examples=50, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 5), st.sampled_from("ab"), st.sampled_from(ORDERS)), max_size=12),
    st.randoms(use_true_random=False),
)
def test_whatever_way_orders_come_the_same_are_in_force(told: list[Any], chance: Any) -> None:
    given = [Given(*each) for each in told]
    books = [OrderBook(), OrderBook()]
    for each in given:
        books[0].take(each)
    shuffled = [*given, *given[:3]]
    chance.shuffle(shuffled)
    for each in shuffled:
        books[1].take(each)
    assert books[0].digest == books[1].digest
    latest: dict[str, Given] = {}
    for each in given:
        held = latest.get(each.order.subject)
        latest[each.order.subject] = each if held is None else max(held, each, key=lambda one: one.rank)
    assert books[0].all == sorted(latest.values(), key=lambda one: one.rank)


@pytest.mark.parametrize(
    ("order", "message"),
    [
        ({"at": 5, "order": "paws"}, "orders[0]: order: unknown order 'paws'; did you mean 'pause'?"),
        ({"order": "pause"}, "orders[0]: at is missing"),
        ({"at": 5, "order": "pause", "robot": 0}, "orders[0]: robot: must be a whole number from 1"),
        ({"at": 5, "order": "pause", "robt": 1}, "orders[0]: unknown field 'robt'; did you mean 'robot'?"),
        ({"at": 5, "order": "pause", "robot": 9}, "robot-9 at 5 s: there is no robot 9 in a team of 2"),
        ({"at": 5, "order": "recall", "to": [100, 1]}, "100,1 lies outside; x is 0 to 12 m"),
        ({"at": 5, "order": "recall", "to": [0.01, 0.01]}, "no robot can stand at 0.01,0.01"),
        ({"at": 5, "order": "remove", "area": "x"}, "area-x at 5 s: there is no such area by then"),
        (
            {"at": 5, "order": "no-go", "area": "x", "corners": [[50, 50], [51, 50], [51, 51]]},
            "area-x at 5 s: the area lies outside: x is 0 to 12 m",
        ),
        (
            {"at": 5, "order": "no-go", "area": "x", "corners": [[0, 0], [1, 1], [2, 2]]},
            "orders.yaml: area-x at 5 s: area: all corners are on a line",
        ),
        (
            {"at": 5, "order": "no-go", "area": "a lab", "corners": [[0, 0], [1, 1], [2, 0]]},
            "area: must be 1 to 32 letters, digits, '-' or '_'; got 'a lab'",
        ),
        (
            {"at": 5, "order": "priority", "area": "x", "corners": [[0, 0], [1, 1]]},
            "corners: must be a list of 3 to 64 places [x, y]; got [[0, 0], [1, 1]]",
        ),
        ({"at": 5, "order": "exclude", "robot": 1}, "simulated robots sign nothing"),
    ],
)
def test_orders_that_make_no_sense_are_refused_in_one_line(
    tmp_path: Path, order: dict[str, Any], message: str
) -> None:
    path = tmp_path / "orders.yaml"
    path.write_bytes(yaml.encode({"orders": [order]}))
    with pytest.raises(InputError) as told:
        Explore(small_office(), 2, orders=path)
    assert message in str(told.value)
    assert "\n" not in str(told.value)


def test_an_area_is_removed_but_once() -> None:
    lab = 1.0, NoGo(area="lab", corners=WEST)
    with pytest.raises(InputError, match="area-lab at 3 s: there is no such area by then; known: none"):
        ordered(lab, (2.0, Remove(area="lab")), (3.0, Remove(area="lab")))


@pytest.mark.parametrize("order", [Recall(to=(1.5, 5.0)), LookThere(at=(1.5, 5.0), robot=1)])
def test_nobody_is_sent_into_a_no_go_area(order: Order) -> None:
    west = 1.0, NoGo(area="west", corners=WEST)
    with pytest.raises(InputError, match=r"at 2 s: 1\.5, 5 lies in the no-go area west"):
        ordered(west, (2.0, order))
    ordered(west, (2.0, Remove(area="west")), (3.0, order))


def test_an_area_that_there_never_was_is_no_area_to_remove_and_one_that_was_removed_is_again() -> None:
    book = OrderBook()
    book.take(Given(1, "operator", NoGo(area="lab", corners=WEST)))
    assert book.unknown_area(Remove(area="lap")) == "there is no area lap; did you mean 'lab'?"
    book.take(Given(2, "operator", Remove(area="lab")))
    assert book.unknown_area(Remove(area="lab")) is None


def test_a_file_of_orders_is_read_in_order_of_time(tmp_path: Path) -> None:
    path = tmp_path / "orders.yaml"
    path.write_text("orders:\n  - {at: 9, order: resume}\n  - {at: 2.5, order: recall, to: [1, 2]}\n")
    assert load_orders(path) == (OrderAt(2.5, Recall(to=(1.0, 2.0))), OrderAt(9.0, Resume()))


def test_in_a_file_where_to_look_is_told_as_where_to_drive(tmp_path: Path) -> None:
    path = tmp_path / "orders.yaml"
    path.write_text("orders:\n  - {at: 5, order: look, to: [3, 2.5]}\n")
    (told,) = load_orders(path)
    assert (told.at, told.what) == (5.0, LookThere(at=(3.0, 2.5)))
