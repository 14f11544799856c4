"""Orders with places in a team that shares no frame: they hold for whoever knows where that frame lies."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from tests.support.small_missions import small_office
from vedette.agent.orders import Given, LookThere, NoGo, Order, OrderBook, Pause, Priority, Recall
from vedette.cli.windows import watched
from vedette.errors import InputError
from vedette.maps import UNKNOWN
from vedette.maps.area import Area
from vedette.maps.transform import Transform
from vedette.missions.ordered import no_go_areas
from vedette.outcome import Outcome
from vedette.run import Explore
from vedette.sim.explore.run import views
from vedette.sim.orders import OrderAt
from vedette.window.picture import picture

WEST = ((0.0, 0.0), (3.0, 0.0), (3.0, 10.0), (0.0, 10.0))


def book(*orders: Order) -> OrderBook:
    held = OrderBook()
    for counter, order in enumerate(orders):
        held.take(Given(counter, "operator", order))
    return held


def ordered(*orders: tuple[float, Order], **options: Any) -> Explore:
    given = [OrderAt(at, order) for at, order in orders]
    return Explore(small_office(seed=1), 2, 7, orders=given, frames="unknown", **options)


@pytest.mark.parametrize(
    ("order", "of"),
    [
        (Pause(robot=2), None),
        (Recall(robot=2), None),
        (Recall(to=(1.0, 2.0)), 0),
        (Recall(robot=2, to=(1.0, 2.0)), 1),
        (LookThere(robot=2, at=(1.0, 2.0), frame=1), 0),
        (NoGo(area="a", corners=WEST, frame=3), 2),
        (Priority(area="a", corners=WEST), 0),
    ],
)
def test_a_place_lies_in_the_frame_of_the_robot_that_is_named_else_ordered_else_first(
    order: Order, of: int | None
) -> None:
    assert order.in_frame_of == of


def test_a_book_seen_from_a_frame_has_its_places_there_and_not_those_of_frames_unknown() -> None:
    there = Transform.of(10.0, -2.0, math.pi / 2)  # (x, y) lies at (10 - y, x - 2)
    held = book(NoGo(area="a", corners=WEST, frame=2), LookThere(at=(1.0, 2.0), frame=3), Pause(robot=1))
    seen = held.seen_from({1: there}.get)
    (area,) = no_go_areas(seen)
    assert np.allclose(area.corners, [(10.0, -2.0), (10.0, 1.0), (0.0, 1.0), (0.0, -2.0)], atol=0.01)
    assert not seen.all_of(LookThere)
    assert seen.in_force(0) is not None
    assert len(held.all) == 3


def test_nobody_goes_where_nobody_may_once_it_is_known_whose_frame_lies_how() -> None:
    mission = ordered((0.0, NoGo(area="west", corners=WEST, frame=1)))
    entered, joined = 0, False
    inside_at_first = {i for i in range(2) if mission.simulation.pose(i)[0] < 3.0}
    while mission.step() is None:
        frames = [each.frames for each in mission.simulation.missions]  # type: ignore[attr-defined]
        joined = joined or all(one.own(1 - i) is not None for i, one in enumerate(frames))
        inside = {i for i in range(2) if mission.simulation.pose(i)[0] < 3.0}
        entered += len((inside - inside_at_first) & ({0, 1} if joined else {0}))
    assert joined
    assert entered == 0
    result = mission.result()
    assert result.outcome in (Outcome.COMPLETE, Outcome.UNREACHED)
    beyond = result.frame.centres(np.flatnonzero(result.map.ravel() == 1))
    assert np.count_nonzero(beyond[:, 0] > 3.5) > 2000  # the rest has been explored


@pytest.mark.parametrize("frame", [1, 2])
def test_what_robots_hold_in_their_frames_is_told_counted_and_checked_where_it_is_in_the_world(
    frame: int,
) -> None:
    order = NoGo(area="west", corners=WEST, frame=frame)
    with ordered((0.0, order)) as mission:
        while mission.now < 3.0:
            mission.step()
        (held,) = mission.books[0].all_of(NoGo)
        assert not np.allclose(held.corners, WEST, atol=1.0)
        for view in views(mission.simulation):
            (told,) = view.sample.orders
            assert isinstance(told, NoGo)
            np.testing.assert_allclose(told.corners, WEST, atol=0.01)
        assert mission.snapshot is not None
        coverage = mission.snapshot.coverage
        world, classes = mission.world, mission.map
        counted = ~world.solid & ~Area(WEST).holds(world.frame)
        known = np.count_nonzero((classes != UNKNOWN) & counted) / np.count_nonzero(counted)
        assert coverage == pytest.approx(known, abs=0.05)
        with pytest.raises(InputError, match="west"):
            mission.order(LookThere(at=(1.5, 5.0)))
        with pytest.raises(InputError, match="no robot 3"):
            mission.order(LookThere(at=(9.0, 5.0), frame=3))


def test_a_click_on_the_page_of_a_simulated_team_means_the_place_in_the_world_that_is_drawn_there() -> None:
    place = (9.0, 5.0)
    with ordered(max_time=100.0) as mission:
        mission.step(400)
        hub = watched(mission, "office")
        assert mission.snapshot is not None
        hub.show(picture(mission.scene, mission.snapshot))
        assert hub.order({"order": "recall", "to": place, "robot": 2}, 0.0) == "given"
        mission.run()
        assert math.dist(mission.simulation.pose(1)[:2], place) < 0.6


def test_a_robot_goes_where_another_ones_frame_says_as_soon_as_it_knows_that_frame() -> None:
    place = (9.0, 5.0)
    mission = ordered((1.0, Recall(robot=2, to=place, frame=1)), max_time=120.0)
    mission.run()
    assert math.dist(mission.simulation.pose(1)[:2], place) < 0.6


@pytest.mark.parametrize(
    ("frames", "frame", "says"),
    [("known", 1, "share one frame"), ("unknown", 3, "no robot 3")],
)
def test_a_frame_that_there_is_not_is_refused_in_a_line(frames: str, frame: int, says: str) -> None:
    order = OrderAt(1.0, Recall(to=(9.0, 5.0), frame=frame))
    with pytest.raises(InputError, match=says):
        Explore(small_office(seed=1), 2, orders=[order], frames=frames)
