"""Robots' processes that share no frame: bodies in frames of their own, what an operator sees, missions."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from msgspec import structs

from tests.fuzz.decoders import conditions
from tests.support.net_team import real_time
from tests.support.small_missions import robots, small_office
from vedette.agent.effects import Drive, Route
from vedette.agent.events import Pose, Scan
from vedette.agent.orders import LookThere, NoGo, Order, Pause, Priority, Recall
from vedette.agent.orders import decode as decode_order
from vedette.align import FramePose
from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED, GridFrame
from vedette.maps.transform import IDENTITY, Transform
from vedette.missions.explore.assemble import assemble, terms_of
from vedette.missions.explore.options import ExploreOptions
from vedette.net.config import load_config
from vedette.net.explore.content import FramesTold, PlacedTold, content
from vedette.net.explore.frames import FramesSeen
from vedette.net.explore.picture import ExploreOnlooker, picture_of
from vedette.net.explore.plan import ExplorePlan
from vedette.net.explore.watch import unheard
from vedette.net.feed import TeamFeed
from vedette.net.orders import TAKEN, Gate, explorer_judge
from vedette.net.report import Condition, OrderReport, Report, encode, read_report
from vedette.record.explore.joins import JoinWatch, TrueFrame, Whereabouts
from vedette.record.explore.views import RobotView
from vedette.sim.own_body import OwnBody
from vedette.sim.shown import decode
from vedette.team import Most

WORLD = small_office(7)
TURNED = FramePose.of(3.0, -2.0, 1.1)  # T_world_own
START = (1.5, 1.5, 0.4)


def body(frame: FramePose | None) -> OwnBody:
    """One robot alone in an office."""
    return OwnBody.put(WORLD, robots(1)[0], START, 0, 2, np.random.default_rng(3), frame)


def plan(count: int) -> ExplorePlan:
    """A team that shares no frame."""
    options = ExploreOptions(frames="unknown")
    starts = np.array([[1.5 + i, 1.5, 0.0] for i in range(count)])
    return ExplorePlan(WORLD, robots(count), starts, options, 7, 4.0)


# -- bodies -------------------------------------------------------------------------------------------


def test_a_body_is_told_all_in_its_frame_and_shows_itself_in_the_world() -> None:
    plain, framed = body(None), body(TURNED)
    for each in (plain, framed):
        each.sense(0.1)
    (pose, scan), (own, seen) = plain.sense(0.2), framed.sense(0.2)
    assert isinstance(pose, Pose)
    assert isinstance(own, Pose)
    assert isinstance(scan, Scan)
    assert isinstance(seen, Scan)
    assert TURNED.places(np.array([[own.x, own.y]]))[0] == pytest.approx((pose.x, pose.y))
    assert own.heading + 1.1 == pytest.approx(pose.heading)
    assert seen.angles + 1.1 == pytest.approx(scan.angles)
    np.testing.assert_array_equal(seen.ranges, scan.ranges)
    assert framed.pose == pytest.approx((own.x, own.y, own.heading))
    shown = decode(framed.show(0.2))
    assert (shown.x, shown.y, shown.heading) == pytest.approx(START)


def test_a_body_drives_where_a_route_of_its_frame_leads() -> None:
    framed = body(TURNED)
    goal = TURNED.inverse().places(np.array([START[:2], (2.5, 1.5)]))
    frame = GridFrame(0.1, 800, 800, -40.0, -40.0)
    framed.carry_out(Drive(Route(goal, np.ones(frame.shape, np.bool_), frame)), 0.0)
    for tick in range(1, 60):
        framed.sense(0.1 * tick)
    shown = decode(framed.show(6.0))
    assert (shown.x, shown.y) == pytest.approx((2.5, 1.5), abs=0.1)


def test_a_robot_that_is_started_again_is_where_it_was_and_in_another_frame() -> None:
    team = plan(2)
    before, first = team.frames[1], team.config(1, None)["body"]
    assert first["frame"] == pytest.approx([before.x, before.y, math.degrees(before.angle)])
    own = before.inverse().after(FramePose(4.0, 5.0, 0.5))
    again = team.config(1, (own.x, own.y, own.angle))["body"]
    assert again["start"] == pytest.approx([4.0, 5.0, math.degrees(0.5)])
    assert again["frame"] != first["frame"]
    assert again["frame"] == pytest.approx(
        [team.frames[1].x, team.frames[1].y, math.degrees(team.frames[1].angle)]
    )


def test_places_of_whoever_started_the_team_are_told_in_robots_frames_and_come_back_as_they_were() -> None:
    team = plan(2)
    for order, of in (
        (LookThere(at=(4.0, 5.0), robot=2), 1),
        (NoGo(area="a", corners=((1.0, 1.0), (3.0, 1.0), (3.0, 2.0))), 0),
        (Recall(to=(4.0, 5.0), robot=1), 0),
    ):
        told = team.as_told(order)
        (place,) = (getattr(told, name) for name in ("at", "to", "corners") if getattr(told, name, None))
        (world,) = (getattr(order, name) for name in ("at", "to", "corners") if getattr(order, name, None))
        there = team.frames[of].places(np.array(place).reshape(-1, 2))
        np.testing.assert_allclose(there, np.reshape(world, (-1, 2)), atol=0.003)
        seen = FramesSeen(team)
        seen.take(condition(0, 9, report(0, 9, 5, ())), report(0, 9, 5, ()).content)
        unturned = view_of_start(team, 0)
        holds = replace(unturned, sample=replace(unturned.sample, orders=(told,)))
        (back,) = seen.in_world([holds, view_of_start(team, 1)])[0].sample.orders
        (again,) = (getattr(back, name) for name in ("at", "to", "corners") if getattr(back, name, None))
        np.testing.assert_allclose(np.reshape(again, (-1, 2)), np.reshape(world, (-1, 2)), atol=0.005)
    assert team.as_told(Pause(robot=1)) == Pause(robot=1)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ("explore: {frames: unknown, fusion: channel}", "fusion channel cannot move what it has added up"),
        ("explore: {frames: unknown, prior: old.yaml}", "an old map lies in a frame that nobody has"),
        ("explore: {frames: odd}", "explore: unknown frames 'odd'"),
        ("explore: {frames: unknown, area: [[0, 0], [9, 0], [9, 9]]}", "an area would be in a frame"),
    ],
)
def test_what_needs_a_common_frame_is_refused_in_a_line(changes: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(f"team: t\nrobot: 1\nbody: {{map: m.yaml, start: [1, 1, 0]}}\n{changes}\n")
    with pytest.raises(InputError, match=message) as told:
        load_config(path)
    assert "\n" not in str(told.value)


def test_a_frame_of_its_own_is_for_a_simulated_robot_of_a_team_that_shares_none(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    text = "team: t\nrobot: 1\nbody: {map: m.yaml, start: [1, 1, 0], frame: [1, 2, 30]}\n"
    path.write_text(text)
    with pytest.raises(InputError, match=r"body\.frame: is not for robots that share a frame"):
        load_config(path)
    path.write_text(text + "explore: {frames: unknown}\n")
    assert load_config(path).body.frame == (1.0, 2.0, 30.0)


def test_an_order_that_names_a_place_is_looked_at_where_its_frame_is_known_and_taken_elsewhere() -> None:
    spec = robots(1)[0]
    options = ExploreOptions(frames="unknown")
    lattice = options.lattice_on(WORLD.frame)
    agent = assemble(lattice, spec, options, 0, 1, robots=2, most=Most.of([spec]))
    agent.rounds.admitted = 2
    judge = explorer_judge(agent, Gate("m", None, local=True))
    corners = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))
    far = tuple((x + 1e6, y) for x, y in corners)
    for order in (
        NoGo(area="a", corners=corners),
        NoGo(area="a", corners=far, frame=2),
        Priority(area="a", corners=corners, frame=1),
        LookThere(at=(1.0, 1.0)),
        LookThere(at=(1e6, 1.0), frame=2),
        Recall(robot=2, to=(1e6, 1.0)),
        Recall(),
        Pause(robot=1),
    ):
        assert judge.objection(order) is None
    for order, says in (
        (NoGo(area="a", corners=far), "lies outside"),
        (LookThere(robot=2, at=(1e6, 1.0), frame=1), "lies outside"),
        (Recall(to=(1.0, 1.0), frame=3), "no robot 3"),
    ):
        assert says in (judge.objection(order) or "")


# -- what an operator sees ----------------------------------------------------------------------------

FRAME = GridFrame(0.1, 10, 20)


def report(robot: int, boot: int, cells: int, graph: tuple[PlacedTold, ...], x: float = 1.0) -> Report:
    """A robot's report; ``cells`` of its map are known, the last of these a wall."""
    (condition,) = conditions()
    classes = np.zeros(FRAME.shape, np.uint8)
    classes.flat[:cells], classes.flat[cells - 1] = FREE, OCCUPIED
    known = slice(0, FRAME.rows), slice(0, FRAME.cols)
    told = content(FRAME, known, classes, classes > 0, None, found=FramesTold(graph, {"look-alike": robot}))
    changed = structs.replace(condition, robot=robot, boot=boot, x=x, y=0.5, heading=0.0)
    return read_report(encode(Report(changed, told)))


def placed(robot: int, boot: int, anchor: tuple[int, int], there: Transform = IDENTITY) -> PlacedTold:
    return PlacedTold(robot, boot, anchor, *there)


def test_who_is_joined_is_shown_on_one_map_and_who_is_not_beside_it() -> None:
    quarter = Transform(4000, 0, 1 << 14)  # T_0_1: by hand, (1, 0.5) of robot 1 is (3.5, 1) of robot 0
    graph = placed(0, 9, (0, 9)), placed(1, 8, (0, 9), quarter), placed(2, 7, (2, 7))
    reports = {0: report(0, 9, 50, graph), 1: report(1, 8, 20, graph), 2: report(2, 7, 30, graph)}
    scene, snapshot = picture_of("office", reports, {})
    first, second, third = snapshot.robots
    assert (first.x, first.y) == pytest.approx((1.0, 0.5))
    assert (second.x, second.y) == pytest.approx((3.5, 1.0))
    assert second.heading == pytest.approx(math.pi / 2)
    assert third.x == pytest.approx(1.0 + 2.0 + 2.0)  # beside a map of 2 m, 2 m away
    assert scene.frame.cols == 20 + 20 + 20
    assert np.count_nonzero(snapshot.classes) == 50 + 30


def shown_apart(orders: tuple[OrderReport, ...] = ()) -> dict[int, Report]:
    """Robots 0 and 1, who are joined, and 2 beside them: its frame is drawn 4 m to the right."""
    quarter = Transform(4000, 0, 1 << 14)
    graph = placed(0, 9, (0, 9)), placed(1, 8, (0, 9), quarter), placed(2, 7, (2, 7))
    reports = {0: report(0, 9, 50, graph), 1: report(1, 8, 20, graph), 2: report(2, 7, 30, graph)}
    first = structs.replace(reports[0].condition, orders=orders, mission="m")
    return reports | {0: structs.replace(reports[0], condition=first)}


@pytest.mark.parametrize(
    ("clicked", "told"),
    [
        (LookThere(at=(1.5, 0.5), robot=2), LookThere(at=(1.5, 0.5), robot=2, frame=1)),
        (LookThere(at=(5.5, 0.5), robot=3), LookThere(at=(1.5, 0.5), robot=3, frame=3)),
        (LookThere(at=(5.5, 0.5)), LookThere(at=(1.5, 0.5), frame=3)),
        (Recall(to=(-3.0, 0.5), robot=2), Recall(to=(-3.0, 0.5), robot=2, frame=1)),
        (
            NoGo(area="a", corners=((2.5, 0.0), (6.5, 0.0), (6.5, 1.0))),
            NoGo(area="a", corners=((-1.5, 0.0), (2.5, 0.0), (2.5, 1.0)), frame=3),
        ),
        (Priority(area="a", corners=((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)), frame=2), None),
        (Recall(robot=2), None),
        (Pause(robot=2), None),
    ],
)
def test_an_order_from_a_picture_carries_the_frame_that_is_drawn_where_its_place_is(
    clicked: Order, told: Order | None, tmp_path: Path
) -> None:
    given: list[bytes] = []
    operator: Any = SimpleNamespace(
        subscribe=lambda *what: None, order=lambda data: given.append(data) or {0: TAKEN}
    )
    access: Any = SimpleNamespace(credentials=None)
    feed = TeamFeed(operator, access, ExploreOnlooker("office"), tmp_path)
    feed.hearing.reports.update(shown_apart())
    assert feed.give(clicked) == "taken by robot-1"
    assert decode_order(given[0]).order == (told or clicked)


def test_orders_are_drawn_where_their_frames_are_and_what_nobody_knows_is_not() -> None:
    corners = ((0.0, 0.0), (1.0, 0.0), (1.0, 2.0))
    orders = (
        NoGo(area="a", corners=corners, frame=2),
        NoGo(area="b", corners=corners, frame=4),
        Pause(robot=1),
    )
    held = tuple(OrderReport(n, "operator", order) for n, order in enumerate(orders))
    _, snapshot = picture_of("office", shown_apart(held), {})
    area, pause = snapshot.robots[0].orders
    assert isinstance(area, NoGo)
    np.testing.assert_allclose(area.corners, ((4.0, 0.0), (4.0, 1.0), (2.0, 1.0)), atol=0.01)  # by hand
    assert pause == Pause(robot=1)


def condition(robot: int, boot: int, each: Report) -> Condition:
    return structs.replace(each.condition, robot=robot, boot=boot)


def test_an_operator_sees_joins_and_how_far_they_are_from_the_truth() -> None:
    team = plan(2)
    seen = FramesSeen(team)
    true = team.frames[0].inverse().after(team.frames[1])
    there = Transform.of(true.x + 0.03, true.y - 0.04, true.angle)
    alone = placed(0, 9, (0, 9)), placed(1, 8, (1, 8))
    joined = placed(0, 9, (0, 9)), placed(1, 8, (0, 9), there)
    views = [view_of_start(team, robot) for robot in range(2)]
    for graph, joins in ((alone, 0), (joined, 1), (alone, 1), (joined, 2)):
        for robot, boot in enumerate((9, 8)):
            told = report(robot, boot, 5, graph)
            seen.take(condition(robot, boot, told), told.content)
        found = seen.look(10.0, views, [0, 1])
        assert found is not None
        assert len(found.joins) == joins
    assert found.undone == 1
    assert found.joins[0].error_m == pytest.approx(0.05, abs=0.005)
    assert found.refused == {"look-alike": 1}
    assert found.components == (("robot-1", "robot-2"),)


def view_of_start(team: ExplorePlan, robot: int) -> RobotView:
    return unheard(team.specs[robot].name, team.starts[robot].tolist(), team.lattice.frame)


def test_a_robot_that_starts_anew_takes_no_join_back() -> None:
    watch, at = JoinWatch(["a", "b"]), (0.0, 0.0)
    true = [TrueFrame(FramePose(0.0, 0.0, 0.0), at), TrueFrame(TURNED, at)]
    there = Transform.of(3.0, -2.0, 1.1)
    first = {0: Whereabouts(9, 0, IDENTITY), 1: Whereabouts(8, 0, there)}
    watch.look(1.0, first, true, [0, 1], {})
    again = watch.look(2.0, {**first, 1: Whereabouts(99, 1, IDENTITY)}, true, [0, 1], {})
    assert (len(again.joins), again.undone, again.components) == (1, 0, (("a",), ("b",)))
    last = watch.look(3.0, {**first, 1: Whereabouts(99, 0, there)}, true, [0, 1], {})
    assert [join.time_s for join in last.joins] == [1.0, 3.0]
    assert last.joins[0].error_m < 0.002


# -- missions -----------------------------------------------------------------------------------------


def explored(folder: Path, *options: str) -> dict[str, Any]:
    """Let two processes that share no frame explore; return the summary of what they leave."""
    WORLD.save(folder)
    command = [sys.executable, "-m", "vedette", "team", "explore", str(folder / "map.yaml")]
    how = ["--robots", "2", "--seed", "7", "--frames", "unknown", "--out", str(folder / "out")]
    ran = subprocess.run([*command, *how, *options], capture_output=True, text=True, check=False)
    assert ran.returncode in (0, 1), ran.stderr
    for log in (folder / "out" / "agents").iterdir():
        assert "Traceback" not in log.read_text()
        assert "nobody can sign" not in log.read_text()
    summary: dict[str, Any] = json.loads((folder / "out" / "summary.json").read_text())
    assert all(join["error_m"] < 0.1 and join["error_deg"] < 1.0 for join in summary["frames"]["joins"])
    assert summary["map_error_share"] < 0.01
    return summary


@real_time
def test_processes_that_share_no_frame_join_and_map_the_building(tmp_path: Path) -> None:
    summary = explored(tmp_path, "--speed", "6", "--max-time", "150")
    assert summary["frames"]["components"] == [["robot-1", "robot-2"]]
    assert len(summary["frames"]["joins"]) == 1 + summary["frames"]["undone"]
    assert summary["coverage"] > 0.95
    assert (tmp_path / "out" / "map.yaml").exists()
    assert (tmp_path / "out" / "progress.png").exists()


STORM = """
faults:
  - {at: 0, fault: loss, share: 0.2, for: 120}
  - {at: 35, fault: partition, parts: [[1], [2]], for: 20}
  - {at: 70, fault: crash, robot: 2}
  - {at: 73, fault: restart, robot: 2}
"""


@real_time
@pytest.mark.slow
def test_processes_that_share_no_frame_drift_and_obey_orders_with_places_of_the_world(tmp_path: Path) -> None:
    area = {"at": 40, "order": "priority", "area": "a", "corners": [[1, 1], [4, 1], [4, 4], [1, 4]]}
    orders = [area, {"at": 60, "order": "recall", "robot": 2}]
    (tmp_path / "orders.yaml").write_text(json.dumps({"orders": orders}))
    given = "--orders", str(tmp_path / "orders.yaml")
    summary = explored(tmp_path, "--speed", "5", "--max-time", "200", "--drift", "0.002", *given)
    assert summary["frames"]["components"] == [["robot-1", "robot-2"]]
    assert all(0.0 < error < 1.0 for error in summary["pose_error_m"].values())


@real_time
@pytest.mark.slow
def test_frames_are_found_again_through_loss_partition_kill_and_restart_and_nothing_is_lost(
    tmp_path: Path,
) -> None:
    (tmp_path / "storm.yaml").write_text(STORM)
    faults = "--faults", str(tmp_path / "storm.yaml")
    summary = explored(tmp_path, "--speed", "4", "--max-time", "400", *faults)
    assert summary["outcome"] == "complete"
    assert summary["coverage"] > 0.99
    assert summary["frames"]["components"] == [["robot-1", "robot-2"]]
    assert max(join["time_s"] for join in summary["frames"]["joins"]) > 70.0  # of the second start as well
    assert len(summary["maps"]) == 1


def test_robots_whose_files_differ_in_frames_or_in_rendezvous_differ_in_terms() -> None:
    lattice = ExploreOptions(frames="unknown").lattice_on(WORLD.frame)
    ways = [{"frames": "known"}, {"frames": "unknown"}, {"frames": "unknown", "rendezvous": True}]
    terms = [terms_of(lattice, ExploreOptions(**way)) for way in ways]  # type: ignore[arg-type]
    assert len({tuple(sorted(each.items())) for each in terms}) == 3
    assert terms[0].keys() <= terms[1].keys()
