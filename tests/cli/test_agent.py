"""``vedette agent`` and ``vedette status``: one clear line for whatever is wrong, and a robot on its own."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from msgspec import yaml

from tests.support.commands import Command
from tests.support.net_team import issue, real_time, wait_until
from tests.support.schemas import valid
from tests.support.small_missions import TWO_ROOMS, drawn
from vedette.cli.status import status as status_command
from vedette.net.endpoints import free_port

pytestmark = real_time

START = 30.0  # a process may take so long to start on a busy host [s]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a map and the keys of a team of three."""
    folder = tmp_path_factory.mktemp("agent")
    drawn(TWO_ROOMS).save(folder)
    issue(folder / "keys", 3)
    return folder


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The command, run in this process."""
    return Command(monkeypatch, capsys)


def config(folder: Path, name: str = "robot.yaml", **changes: Any) -> Path:
    """A robot's file that would do, with some fields changed; a dict changes fields of its own."""
    fields: dict[str, Any] = {
        "team": "office",
        "robot": 1,
        "links": {"listen": [f"tls/127.0.0.1:{free_port()}"], "keys": "keys/robot-1"},
        "body": {"map": "map.yaml", "start": [1.0, 1.0, 0.0]},
    }
    for key, value in changes.items():
        fields[key] = {**fields[key], **value} if isinstance(value, dict) and key in fields else value
    path = folder / name
    path.write_bytes(yaml.encode(fields))
    return path


FLYING = {"map": None, "start": None, "speed": 2.0}
MISTAKES: list[tuple[dict[str, Any], str]] = [
    ({"robot": 0}, "robot: must be a whole number from 1 to 65536; got 0"),
    ({"robt": 2}, "unknown field 'robt'; did you mean 'robot'?"),
    ({"robots": 0}, "robots: must be a whole number from 1 to 65536"),
    ({"team": "a/b"}, "team must be 1 to 32 letters"),
    ({"team": "garden"}, "is of team 'office', not 'garden'"),
    ({"robot": 2}, "is for office/robot-1, not for office/robot-2"),
    ({"links": {"keys": "keys/robot-9"}}, "copy the folder whole"),
    ({"links": {"keys": "keys/operator"}}, "is for office/operator, not for office/robot-1"),
    ({"links": {"keys": None}}, "make them with 'vedette keys'"),
    ({"links": {"insecure": True}}, "leave out one of them"),
    ({"links": {"listen": ["tcp/127.0.0.1:7447"]}}, "plain TCP needs 'insecure: true'"),
    ({"links": {"listen": ["tls/127.0.0.1"]}}, "endpoint must be tls/HOST:PORT"),
    ({"links": {"listen": "tls/127.0.0.1:7447"}}, "links.listen"),
    ({"links": {"listen": ["tls/198.51.100.7:7447"]}}, "this machine has no such address"),
    ({"links": {"connect": ["tls/0.0.0.0:7447"]}}, "name the other robot's host"),
    ({"links": {"lease": 0.01}}, "links.lease: must be a number from 0.2 to 60"),
    ({"explore": {"planner": "tour"}}, "explore.planner: unknown planner 'tour'; did you mean 'tours'?"),
    ({"explore": {"scheme": "tokens"}}, "explore.scheme: unknown scheme 'tokens'"),
    ({"explore": {"fusion": "none"}}, "explore.fusion: unknown fusion 'none'"),
    ({"explore": {"frames": "odd"}}, "explore: unknown frames 'odd'"),
    ({"body": {"frame": [1.0, 2.0, 0.0]}}, "body.frame: is not for robots that share a frame; leave it out"),
    ({"body": {"map": "no-map.yaml"}}, "no-map.yaml"),
    ({"body": {"start": [1.0, 1.0]}}, "body.start: must be a list of 3 numbers"),
    ({"body": {"start": [100.0, 1.0, 0.0]}}, "start 100,1 is outside the map"),
    ({"body": {"speed": -1.0}}, "speed must be 0.01 to 10 m/s; got -1.0"),
    ({"body": {"map": None}}, "body.map: missing; name the world"),
    ({"body": {"start": None}}, "body.start: missing; give x, y and heading"),
    ({"explore": {}, "track": {}}, "track: a robot has one mission, and explore is given too"),
    ({"track": {}}, "begins: missing; vehicles plan by a common clock"),
    ({"track": {}, "begins": "2027-01-31 12:00"}, "begins"),
    ({"track": {}, "begins": "2027-01-31T12:00:00Z"}, "body.map: vehicles fly over their scenario's area"),
    ({"track": {"coordination": "optimum"}}, "track.coordination: unknown coordination 'optimum'"),
    ({"search": {"fusion": "channel"}}, "search.fusion: unknown fusion 'channel'"),
    (
        {"track": {}, "begins": "2027-01-31T12:00:00Z", "body": FLYING},
        "body.speed: the scenario says how each",
    ),
    ({"links": {"delay": 0.1}}, "links.delay: is for vehicles, which reckon with it; leave it out"),
    (
        {"explore": {"planner": "jacobi", "scheme": "token"}},
        "planner jacobi negotiates by jacobi, which is part",
    ),
    (
        {"begins": "tomorrow"},
        "begins: must be a time with its zone, such as 2027-01-31T12:00:00Z; got 'tomorrow'",
    ),
    ({"scenario": "raft.yaml"}, "scenario: is for vehicles, not for robots that explore; leave it out"),
    ({"faults": "storm.yaml"}, "begins: missing; faults need the time at which the mission begins"),
]


@pytest.mark.parametrize(("changes", "message"), MISTAKES)
def test_a_mistake_in_a_robots_file_is_told_in_one_line_that_names_the_file(
    vedette: Command, folder: Path, changes: dict[str, Any], message: str
) -> None:
    path = config(folder, **changes)
    ran = vedette("agent", path)
    assert ran.status == 2
    assert ran.out == ""
    assert len(ran.err.splitlines()) == 1, ran.err
    assert ran.err.startswith(f"vedette: {path}: ")
    assert message in ran.err


def test_a_port_in_use_is_told_in_one_line(vedette: Command, folder: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        ran = vedette("agent", config(folder, links={"listen": [f"tls/127.0.0.1:{port}"]}))
    assert ran.status == 2
    assert "the port is in use" in ran.err
    assert len(ran.err.splitlines()) == 1


def test_a_file_that_is_not_there_and_a_speed_that_cannot_be_are_told_in_one_line(
    vedette: Command, folder: Path
) -> None:
    for arguments, message in [
        ((folder / "no.yaml",), "no.yaml"),
        ((config(folder), "--speed", 0), "--speed must be above 0"),
        ((config(folder), "--speed", 1000), "at most 50 times real time"),
    ]:
        ran = vedette("agent", *arguments)
        assert ran.status == 2
        assert message in ran.err
        assert len(ran.err.splitlines()) == 1


# -- a robot on its own ------------------------------------------------------------------------------------


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP], ids=lambda n: n.name)
def test_a_robot_without_neighbours_explores_alone_over_plain_tcp_with_a_warning(
    folder: Path, number: signal.Signals
) -> None:
    links = {"insecure": True, "keys": None, "listen": [f"tcp/127.0.0.1:{free_port()}"]}
    path = config(folder, "alone.yaml", links=links)
    command = [sys.executable, "-m", "vedette", "agent", str(path), "--speed", "10"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as agent:
        try:
            wait_until(lambda: state_of(path) == "done", 2 * START)
            agent.send_signal(number)
            out, err = agent.communicate(timeout=START)
        finally:
            agent.kill()  # else a failure waits for an agent that nobody ends
    assert agent.returncode == 0
    warning = "links are plain TCP: whoever reaches the port can read and write, and nothing is signed"
    assert err == f"vedette: {warning}\n"
    assert out.startswith("robot 1 of team office: listens on tcp/127.0.0.1:")
    assert out.endswith("robot 1: stopped\n")


def state_of(path: Path) -> str | None:
    """What ``vedette status`` says that a robot does; None: no answer."""
    shown = CliRunner().invoke(status_command, [str(path), "--json", "--wait", "1"])
    said = valid("status", shown.output)["robots"]["robot-1"]
    assert shown.exit_code == (1 if said is None else 0)
    return None if said is None else str(said["state"])


# -- the operator ------------------------------------------------------------------------------------------


def test_the_operator_needs_its_own_keys_and_one_team(vedette: Command, folder: Path) -> None:
    path, keys = config(folder), folder / "keys"
    other = config(folder, "other.yaml", team="garden")
    for arguments, message in [
        ((path,), "--keys is missing"),
        ((path, other, "--keys", keys / "operator"), "of different teams"),
        ((path, "--keys", keys / "robot-1"), "is for office/robot-1, not for office/operator"),
        ((path, "--keys", keys), "cannot read"),
        ((path, "--keys", keys / "operator", "--wait", 0), "--wait must be above 0"),
    ]:
        ran = vedette("status", *arguments)
        assert ran.status == 2, ran
        assert message in ran.err
        assert len(ran.err.splitlines()) == 1


def test_a_team_that_is_not_there_does_not_answer(vedette: Command, folder: Path) -> None:
    path = config(folder)
    ran = vedette("status", path, "--keys", folder / "keys" / "operator", "--wait", 0.5)
    assert ran.status == 1
    assert "none answered" in ran.out
