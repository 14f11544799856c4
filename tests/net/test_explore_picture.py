"""What an operator is told of an exploring team: who believes whom, energy, traffic, orders, full disks."""

from __future__ import annotations

import numpy as np
from msgspec import structs

from tests.fuzz.decoders import conditions
from vedette.agent.orders import Pause
from vedette.maps import FREE, GridFrame
from vedette.net.explore.content import StopAhead, content
from vedette.net.explore.picture import picture_of
from vedette.net.report import OrderReport, Report, encode, read_report

FRAME = GridFrame(0.1, 10, 20)


def report(
    robot: int, *, signs: bool = True, out: tuple[int, ...] = (), way_left: float | None = None
) -> Report:
    """A robot's report, as it comes over the network."""
    (condition,) = conditions()
    classes = np.full(FRAME.shape, FREE, np.uint8)
    known = slice(0, FRAME.rows), slice(0, FRAME.cols)
    tour = (StopAhead(1.0, 0.5, 3.0, 0.25),)
    told = content(FRAME, known, classes, classes > 0, None, (), tour, way_left)
    orders = (OrderReport(1, "operator", Pause(robot=2)),) if robot == 0 else ()
    changed = structs.replace(
        condition, robot=robot, signs=signs, out=out, orders=orders, bytes={"fusion": 900, "beacons": 100}
    )
    return read_report(encode(Report(changed, told)))


def test_of_each_robot_is_told_what_it_holds_has_sent_and_can_still_drive() -> None:
    _, snapshot = picture_of("office", {0: report(0, way_left=12.5), 1: report(1)}, {})
    first, second = snapshot.robots
    assert (first.way_left, second.way_left) == (12.5, None)
    assert (first.rounds, first.sent) == (7, 1000)
    assert (first.orders, second.orders) == ((Pause(robot=2),), ())
    assert [tuple(stop) for stop in first.tour] == [(1.0, 0.5, 3.0, 0.25)]


def test_who_believes_a_robot_is_told_where_robots_sign() -> None:
    team = {0: report(0, out=(2,)), 1: report(1, out=(2,)), 2: report(2)}
    _, snapshot = picture_of("office", team, {})
    assert [robot.trust for robot in snapshot.robots] == [
        "believed",
        "believed",
        "not believed by robot-1, robot-2",
    ]
    _, unsigned = picture_of("office", {0: report(0, signs=False)}, {})
    assert unsigned.robots[0].trust == ""
