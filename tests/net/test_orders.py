"""Orders to real processes: signed by the operator, passed on, refused in a line where they make no sense."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest
from msgspec import structs

from tests.support.commands import Command
from tests.support.net_team import issue, real_time, wait_until
from tests.support.small_missions import TWO_ROOMS, drawn
from vedette.agent.orders import Given, Pause, Resume
from vedette.net.credentials import credentials
from vedette.net.endpoints import free_port, is_loopback
from vedette.net.notary import CertifiedNotary
from vedette.net.orders import Gate, pen_of, written


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The keys of a team of two, and of another team."""
    folder = tmp_path_factory.mktemp("keys")
    issue(folder / "ours", 2)
    issue(folder / "theirs", 2)
    return folder


def notary(folder: Path, mission: str = "m") -> CertifiedNotary:
    """Whoever's keys lie in a folder."""
    return CertifiedNotary(credentials(folder, datetime.now(UTC)), mission, lambda: 0.0)


def test_an_order_counts_as_it_is_signed_by_the_operator_for_this_mission(keys: Path) -> None:
    robot, operator = notary(keys / "ours" / "robot-1"), notary(keys / "ours" / "operator")
    gate = Gate("m", robot, local=False)
    given = written(Pause(robot=2), "m", [], operator)
    gate.check(given)
    wrong: list[tuple[Given, str]] = [
        (structs.replace(given, order=Pause(robot=1)), "signature is not by the operator's key"),
        (structs.replace(given, counter=given.counter + 1), "signature is not by the operator's key"),
        (structs.replace(given, mission="n"), "of another mission"),
        (written(Pause(), "m", [], None), "certificate"),
        (written(Pause(), "m", [], notary(keys / "ours" / "robot-2")), "certificate is that of"),
        (written(Pause(), "m", [], notary(keys / "theirs" / "operator")), "not one of this team's authority"),
        (
            written(Pause(), "m", [], notary(keys / "ours" / "operator", "n")),
            "signature is not by the operator's key",
        ),
    ]
    for each, message in wrong:
        with pytest.raises(ValueError, match=message):
            gate.check(each)


def test_without_keys_orders_are_taken_on_loopback_alone() -> None:
    given = written(Pause(), "m", [], pen_of(None, "m"))
    Gate("m", None, local=True).check(given)
    with pytest.raises(ValueError, match="loopback alone"):
        Gate("m", None, local=False).check(given)
    ways = ["tcp/127.0.0.1:7447", "tcp/[::1]:7447", "tcp/localhost:7447"]
    assert all(map(is_loopback, ways))
    assert not any(map(is_loopback, ["tcp/0.0.0.0:7447", "tcp/192.168.1.7:7447", "tcp/robot-1.local:7447"]))


def test_a_later_order_has_a_later_counter_whatever_the_clock_says() -> None:
    first = written(Pause(), "m", [], None, lambda: 100.0)
    assert first.counter == 100_000
    assert written(Resume(), "m", [first.counter], None, lambda: 5.0).counter == 100_001


@contextmanager
def agents(folder: Path, keys: Path, count: int) -> Iterator[list[Path]]:
    """A team of agent processes, linked in a row, and their files."""
    ports = [free_port() for _ in range(count)]
    files, running = [], []
    for i in range(count):
        listen, connect = [f"tls/127.0.0.1:{ports[i]}"], [f"tls/127.0.0.1:{ports[i - 1]}"] if i else []
        links = {"listen": listen, "connect": connect, "keys": str(keys / "ours" / f"robot-{i + 1}")}
        body = {"map": "map.yaml", "start": [1.0 + i, 1.0, 0.0], "speed": 0.1}
        path = folder / f"{i + 1}.yaml"
        path.write_text(json.dumps({"team": "office", "robot": i + 1, "links": links, "body": body}))
        files.append(path)
    try:
        for path in files:
            command = [sys.executable, "-m", "vedette", "agent", str(path)]
            running.append(subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
        yield files
    finally:
        for process in running:
            process.send_signal(signal.SIGTERM)
        for process in running:
            process.wait(30.0)


@real_time
def test_a_running_team_obeys_and_refuses_what_makes_no_sense(
    tmp_path: Path, keys: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    drawn(TWO_ROOMS).save(tmp_path)
    vedette = Command(monkeypatch, capsys)
    operator = "--keys", keys / "ours" / "operator"

    def said() -> dict[str, Any]:
        told: dict[str, Any] = json.loads(vedette("status", *files, *operator, "--json").out)["robots"]
        return told

    def order(*what: object) -> Any:
        return vedette("order", files[0], *what, *operator, "--wait", 5)

    with agents(tmp_path, keys, 2) as files:
        wait_until(lambda: order("pause").status == 0, 60.0)
        wait_until(lambda: all(each and each["state"] == "paused" for each in said().values()), 60.0)
        assert [len(each["orders"]) for each in said().values()] == [1, 1]
        ran = order("recall", "--to", "100,1")
        assert (ran.status, ran.out) == (2, "")
        assert ran.err.startswith("robot-1: 100, 1 lies outside")
        assert order("recall", "--robot", "0").status == 2
        assert order("no-go", "--area", "lab").status == 2
        ran = order("remove", "--area", "lab")
        assert (ran.status, ran.err.splitlines()[0]) == (2, "robot-1: there is no area lab; known: none")
        assert [len(each["orders"]) for each in said().values()] == [1, 1]
        assert order("resume", "--robot", 2).status == 0
        wait_until(lambda: said()["robot-2"]["state"] != "paused", 30.0)
        assert said()["robot-1"]["state"] == "paused"
        assert order("end").status == 0
        wait_until(lambda: all(each["state"] == "done" for each in said().values()), 30.0)
        assert {each["ending"] for each in said().values()} == {"ordered"}
