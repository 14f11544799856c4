"""Teams of real processes over real sockets: they finish, whatever befalls one of them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from bench.network import network
from tests.support.commands import check_files
from tests.support.net_processes import (
    Diary,
    Fault,
    Mission,
    Ring,
    freeze,
    inner,
    kill,
    leaf,
    plan_of,
    restart,
    root,
    run,
    terminate,
)
from tests.support.net_team import issue, real_time, wait_until
from tests.support.schemas import valid
from tests.support.small_missions import TWO_ROOMS, drawn, robots, small_maze
from vedette.agent.body import TICK
from vedette.agent.effects import Drive, Route
from vedette.cli.status import status as status_command
from vedette.net import Access, Transport, credentials
from vedette.net.launch import TEAM, TeamProcesses
from vedette.outcome import Outcome
from vedette.sim.own_body import OwnBody
from vedette.sim.shown import ShownBody, decode, encode

pytestmark = real_time

SOON = 1.0  # [s]
START = 30.0  # a process may take so long to start on a busy host [s]


@pytest.fixture(scope="module")
def rooms(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The map of two rooms."""
    folder = tmp_path_factory.mktemp("world")
    drawn(TWO_ROOMS).save(folder)
    return folder / "map.yaml"


def team_explore(*arguments: object) -> subprocess.Popen[str]:
    """``vedette team explore``, in a process of its own."""
    command = [sys.executable, "-m", "vedette", "team", "explore", *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def agents_of(starter: int) -> list[int]:
    """The running agent processes that a process has started, by what their command lines say."""
    wanted = f"--starter\0{starter}\0".encode()
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            if wanted in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
        except OSError:  # it has just ended
            continue
    return found


def check_finished(mission: Mission, count: int) -> None:
    """The survivors have the whole map, and the same one."""
    summary = mission.report.summary
    assert summary.outcome is Outcome.COMPLETE, summary
    assert summary.coverage >= 0.995
    assert summary.map_errors == 0
    assert len(mission.survivors) == count
    assert mission.diary.agree(mission.survivors)


def tell(what: str, mission: Mission, others: Sequence[int] | None = None) -> None:
    """Print how fast the others, or all that survived, got over a fault."""
    cost = mission.recovery_of(mission.survivors if others is None else others)
    print(
        f"\n{what}: noticed after {1e3 * cost.noticed:.0f} ms, planned anew after "
        f"{1e3 * cost.replanned:.0f} ms, {cost.overlay_bytes:.0f} B of overlay in the 5 s since; "
        f"complete after {mission.report.summary.time_s:.0f} s"
    )


# -- the command ---------------------------------------------------------------------------------------


def test_a_team_of_processes_completes_and_leaves_every_file(rooms: Path, tmp_path: Path) -> None:
    with team_explore(rooms, "--robots", 2, "--speed", 8, "--out", tmp_path / "out") as team:
        out, err = team.communicate(timeout=120.0)
    assert team.returncode == 0, err
    assert "complete: " in out
    check_files(tmp_path / "out", "explore")
    assert {path.name for path in (tmp_path / "out" / "agents").iterdir()} == {"robot-1.log", "robot-2.log"}
    for log in (tmp_path / "out" / "agents").iterdir():
        assert log.read_text().endswith(": stopped\n")
        assert "Traceback" not in log.read_text()
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["completed"] is True
    assert summary["pose_error_m"] == {"robot-1": 0.0, "robot-2": 0.0}
    assert summary["coverage"] > 0.995
    assert summary["collisions"] == 0
    assert summary["apart_s"] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["fork", "async"])
def test_processes_agree_by_any_scheme(scheme: str, rooms: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with team_explore(rooms, "--robots", 3, "--speed", 4, "--scheme", scheme, "--out", out) as team:
        _, err = team.communicate(timeout=300.0)
    assert team.returncode == 0, err
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["completed"], summary["scheme"]) == (True, scheme)
    assert summary["coverage"] > 0.995


@pytest.mark.slow
def test_processes_that_predict_with_an_old_map_agree(rooms: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    how = "--planner", "predicted", "--prior", rooms, "--robots", 2, "--speed", 4
    with team_explore(rooms, *how, "--out", out) as team:
        _, err = team.communicate(timeout=300.0)
    assert team.returncode == 0, err
    summary = json.loads((out / "summary.json").read_text())
    assert (summary["completed"], summary["planner"]) == (True, "predicted")
    assert summary["coverage"] > 0.995


@pytest.mark.slow
def test_processes_whose_odometry_drifts_complete_and_tell_how_far_they_erred(
    rooms: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    with team_explore(rooms, "--robots", 2, "--speed", 5, "--drift", 0.02, "--out", out) as team:
        _, err = team.communicate(timeout=200.0)
    assert team.returncode == 0, err
    summary = json.loads((out / "summary.json").read_text())
    assert summary["pose_error_m"].keys() == {"robot-1", "robot-2"}
    assert all(0.0 < error < 1.0 for error in summary["pose_error_m"].values())
    assert summary["map_error_share"] < 0.01


@pytest.mark.parametrize(
    "number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)], ids=lambda n: n.name
)
def test_a_signal_ends_a_team_in_good_order(rooms: Path, tmp_path: Path, number: signal.Signals) -> None:
    with team_explore(rooms, "--robots", 2, "--speed", 2, "--out", tmp_path / "out") as team:
        wait_until(lambda: listening(tmp_path / "out" / "agents") == 2, START)
        time.sleep(SOON)  # in which the mission may or may not begin
        team.send_signal(number)
        out, err = team.communicate(timeout=60.0)
    assert team.returncode == 130, err
    assert "interrupted: " in out
    check_files(tmp_path / "out", "explore")
    assert agents_of(team.pid) == []


def listening(logs: Path) -> int:
    """Count the agents that say that they can be reached."""
    return sum("listens on" in log.read_text() for log in logs.glob("*.log"))


@pytest.mark.slow
def test_a_team_whose_starter_is_killed_stops_by_itself(rooms: Path, tmp_path: Path) -> None:
    with team_explore(rooms, "--robots", 2, "--speed", 1, "--out", tmp_path / "out") as team:
        wait_until(lambda: listening(tmp_path / "out" / "agents") == 2, START)
        assert len(agents_of(team.pid)) == 2
        team.kill()
    wait_until(lambda: not agents_of(team.pid), 10.0)


@pytest.mark.slow
def test_a_robot_that_cannot_start_is_named_with_its_reason(tmp_path: Path) -> None:
    plan = plan_of(drawn(TWO_ROOMS), 2)

    class Unlucky(TeamProcesses):
        def _command(self, i: int) -> list[str]:
            return [*super()._command(i), *(["--speed", "-1"] if i == 1 else [])]

    with pytest.raises(Exception, match="robot-2 cannot take part: --speed"):
        run(plan, tmp_path, team=Unlucky)


# -- bodies ----------------------------------------------------------------------------------------------


def test_bodies_that_met_unseen_pass_through_each_other_until_they_are_apart() -> None:
    world = drawn(TWO_ROOMS)
    spec = robots(1)[0]
    body = OwnBody.put(world, spec, (1.0, 2.0, 0.0), 0, 2, np.random.default_rng(0))
    other = ShownBody(1.1, 2.0, 0.0, 0.0, 0.0, spec.radius)
    body.carry_out(Drive(Route(np.array([[1.0, 2.0], [3.0, 2.0]]), ~world.solid, world.frame)), 0.0)
    for tick in range(1, 50):
        body.see(1, encode(other), TICK * tick)
        body.sense(TICK * tick)
    assert not other.inside(decode(body.show(5.0)))
    assert body.pose[0] > 2.5
    assert body.figures.collisions == 0


# -- faults in mid-mission ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "role", [root, *(pytest.param(role, marks=pytest.mark.slow) for role in (inner, leaf))]
)
def test_a_robot_is_killed_and_the_others_finish(role: Callable[[Diary], int], tmp_path: Path) -> None:
    mission = run(plan_of(small_maze(), 3), tmp_path, [Fault(0.5, "kill", kill(role))], Ring)
    tell(f"kill -9, {role.__name__}", mission)
    check_finished(mission, 2)
    assert mission.recovery.noticed < SOON
    assert mission.recovery.replanned < 2 * SOON


@pytest.mark.slow
@pytest.mark.parametrize("role", [root, inner, leaf])
def test_one_of_four_in_a_ring_is_killed(role: Callable[[Diary], int], tmp_path: Path) -> None:
    mission = run(plan_of(small_maze(), 4), tmp_path, [Fault(0.4, "kill", kill(role))], Ring)
    tell(f"kill -9 in a ring of four, {role.__name__}", mission)
    check_finished(mission, 3)
    assert mission.recovery.replanned < 2 * SOON


@pytest.mark.slow
def test_a_robot_that_is_stopped_says_goodbye(tmp_path: Path) -> None:
    mission = run(plan_of(small_maze(), 3, lease=10.0), tmp_path, [Fault(0.4, "term", terminate(1))])
    tell("SIGTERM", mission)
    check_finished(mission, 2)
    assert mission.recovery.noticed < SOON
    assert mission.diary.last(1).state == "left"
    assert (mission.report.summary.lost, mission.report.summary.left) == ((), ("robot-2",))
    assert mission.report.log.last.robots[1].fate == "left"


@pytest.mark.slow
@pytest.mark.parametrize("seconds", [0.7, 5.0], ids=["shorter than the lease", "longer than the lease"])
def test_a_robot_freezes_for_a_while(seconds: float, tmp_path: Path) -> None:
    lease = 2.0
    plan = plan_of(small_maze(), 3, speed=3.0, lease=lease)
    mission = run(plan, tmp_path, [Fault(0.3, "freeze", freeze(lambda _: 1, seconds))])
    if seconds > lease:
        tell(f"SIGSTOP for {seconds} s, lease {lease} s", mission, [0, 2])
    check_finished(mission, 3)
    said = [told for i in (0, 2) for told in mission.diary.by_robot[i]]
    trees = {told.said.number for told in said if told.time > mission.struck}
    if seconds < lease:
        assert len(trees) == 1
    else:
        assert len(trees) > 1
        assert mission.recovery_of([0, 2]).replanned < lease + 2 * SOON


@pytest.mark.slow
def test_a_robot_that_freezes_for_good_is_not_waited_for_and_the_mission_not_called_complete(
    tmp_path: Path,
) -> None:
    mission = run(plan_of(small_maze(), 3), tmp_path, [Fault(0.4, "freeze", freeze(lambda _: 1))])
    tell("SIGSTOP for good", mission, [0, 2])
    assert mission.report.summary.outcome is Outcome.UNHEARD
    assert mission.report.summary.lost == ("robot-2",)
    assert mission.report.summary.coverage >= 0.995
    assert mission.diary.agree([0, 2])


@pytest.mark.slow
def test_a_robot_starts_anew_with_empty_memory_and_gets_the_map_back(tmp_path: Path) -> None:
    plan = plan_of(small_maze(), 3, speed=3.0)
    mission = run(plan, tmp_path, [Fault(0.5, "restart", restart(1))])
    tell("kill -9 and restart", mission, [0, 2])
    check_finished(mission, 3)
    told = [each.said for each in mission.diary.by_robot[1]]
    assert len({said.boot for said in told}) == 2
    assert told[-1].known == pytest.approx(mission.diary.last(0).known)


# -- the operator, and strangers -------------------------------------------------------------------------


@contextmanager
def living_team(folder: Path, count: int) -> Iterator[TeamProcesses]:
    """A team that nobody watches."""
    plan = plan_of(drawn(TWO_ROOMS), count, speed=8.0)
    with TeamProcesses(plan, folder / "files", folder / "logs") as team:
        yield team


def ask(team: TeamProcesses, *options: object) -> Result:
    """``vedette status`` of the team."""
    files = sorted(str(path) for path in team.folder.glob("robot-*.yaml"))
    keys = team.folder / "keys" / "operator"
    return CliRunner().invoke(status_command, [*files, "--keys", str(keys), *map(str, options)])


def test_the_operator_is_told_who_answers_on_what_tree_and_strangers_change_nothing(tmp_path: Path) -> None:
    with living_team(tmp_path, 2) as team, ExitStack() as stack:
        wait_until(lambda: states(ask(team, "--json")) == ["done", "done"], 2 * START)
        agreed = "2 of 2 answered; they are on one tree and hold the same map"
        wait_until(lambda: (said := ask(team)).exit_code == 0 and agreed in said.output, START)
        links = team.operator.connect
        foreign = credentials(issue(tmp_path / "foreign", 3) / "robot-3", datetime.now(UTC))
        stack.enter_context(Transport(Access("office", (), links, foreign), 2))
        mate = credentials(team.folder / "keys" / "robot-2", datetime.now(UTC))
        before = all_of(team)
        with Transport(Access(TEAM, (), links[:1], mate), 1) as twin:
            wait_until(lambda: twin.peers == {0}, START)

            def counted() -> bool:  # a datagram may be lost before the session is ready: so more are sent
                twin.send(0, b"Hnonsense")
                return dropped(ask(team, "--json")) >= 5

            wait_until(counted, START)
        after = all_of(team)
        assert set(after) == set(before) == {"robot-1", "robot-2"}
        assert after["robot-1"]["number"] == before["robot-1"]["number"]
        assert [link["robot"] for link in after["robot-1"]["links"]] == [2]  # type: ignore[attr-defined]
        assert "overlay" in ask(team).output  # in the column of what was dropped
        os.kill(team.processes[1].pid, signal.SIGKILL)
        wait_until(lambda: size_of(ask(team, "--json", "--wait", 0.5)) == 1, START)
        shown = ask(team, "--wait", 0.5)
        assert shown.exit_code == 1
        assert json_of(ask(team, "--json", "--wait", 0.5))["robot-2"] is None
        assert "1 of 2 answered" in shown.output


def json_of(result: Result) -> dict[str, dict[str, object]]:
    told: dict[str, dict[str, object]] = valid("status", result.output)["robots"]
    return told


def all_of(team: TeamProcesses) -> dict[str, dict[str, object]]:
    """What all robots say of themselves; one that is busy may answer too late for once."""
    told: list[dict[str, dict[str, object]]] = []

    def answered() -> bool:
        told.append(json_of(ask(team, "--json")))
        return None not in told[-1].values()

    wait_until(answered, START)
    return told[-1]


def states(result: Result) -> list[object]:
    return [said and said["state"] for said in json_of(result).values()]


def size_of(result: Result) -> object:
    first = json_of(result)["robot-1"]
    return first and first["size"]


def dropped(result: Result) -> int:
    first = json_of(result)["robot-1"]
    counts = first["dropped"] if first else {"overlay and links": 0}
    assert isinstance(counts, dict)
    return int(counts["overlay and links"])


# -- the bench ---------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_bench_measures_what_is_asked_and_says_so(tmp_path: Path) -> None:
    ran = CliRunner().invoke(network, ["--quick", "--out", str(tmp_path)])
    assert ran.exit_code == 0, ran.output
    rows = json.loads((tmp_path / "network-quick.json").read_text())["measurements"]
    assert len(rows) == 5
    assert all(row["measured"] > 0 and row["verdict"] in ("MET", "MISSED") for row in rows)
