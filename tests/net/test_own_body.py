"""A class of one's own as a robot's body: a pair of real processes, and what is refused in one line."""

from __future__ import annotations

import math
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from msgspec import yaml

from tests.support.net_team import real_time, wait_until
from tests.support.places import ROOT
from tests.support.schemas import valid
from vedette.agent.body import BodyFigures
from vedette.agent.effects import Drive, Motion
from vedette.agent.events import Event, Pose, Scan, Stuck
from vedette.cli.agent import agent as agent_command
from vedette.cli.status import status as status_command
from vedette.errors import InputError
from vedette.net.config import load_config
from vedette.net.endpoints import free_port
from vedette.net.own import OwnSettings
from vedette.net.own_body import CheckedBody
from vedette.team import PlatformSpec

EXAMPLE = ROOT / "examples" / "own_body.py"
WIDTH, HEIGHT = 9.0, 6.0  # of its hall [m]
SPEC = PlatformSpec(start=(1.0, 1.0, 0.0))


def write(folder: Path, robot: int, ports: list[int], **body: Any) -> Path:
    """A robot's file beside the example."""
    own = {"make": "own_body:HallRobot", "settings": {"size": [WIDTH, HEIGHT]}}
    fields = {
        "team": "hall",
        "robot": robot,
        "robots": 2,
        "links": {
            "insecure": True,
            "listen": [f"tcp/127.0.0.1:{ports[robot - 1]}"],
            "connect": [f"tcp/127.0.0.1:{port}" for port in ports[: robot - 1]],
        },
        "body": {"own": own, "start": [1.0, float(robot), 0.0], "range": 3.0, "beams": 180, **body},
    }
    path = folder / f"robot-{robot}.yaml"
    path.write_bytes(yaml.encode(fields))
    return path


def told(paths: list[Path]) -> list[dict[str, Any] | None]:
    """What each robot says of itself; None: no answer."""
    shown = CliRunner().invoke(status_command, [*map(str, paths), "--json", "--wait", "2"])
    return list(valid("status", shown.output)["robots"].values())


@real_time
def test_two_processes_with_bodies_of_ones_own_explore_a_hall_together(tmp_path: Path) -> None:
    (tmp_path / "own_body.py").write_text(EXAMPLE.read_text())
    ports = [free_port(), free_port()]
    paths = [write(tmp_path, robot, ports) for robot in (1, 2)]
    with ExitStack() as stack:
        agents = [
            stack.enter_context(
                subprocess.Popen(
                    [sys.executable, "-m", "vedette", "agent", str(path), "--speed", "10"],
                    stdout=subprocess.PIPE,
                    stderr=subprocess.PIPE,
                    text=True,
                )
            )
            for path in paths
        ]
        try:
            wait_until(lambda: [said and said["state"] for said in told(paths)] == ["done", "done"], 90.0)
            robots = told(paths)
        finally:
            for agent in agents:
                agent.terminate()
        ends = [agent.communicate(timeout=30.0) for agent in agents]
    assert [agent.returncode for agent in agents] == [0, 0], ends
    one, other = robots
    assert one is not None
    assert other is not None
    assert one["digest"] == other["digest"]
    assert one["known"] is None  # nobody has told them how far their ground goes
    ring = 2 * 0.1 * (WIDTH + HEIGHT)  # of walls, a cell thick
    assert WIDTH * HEIGHT <= one["known_m2"] <= WIDTH * HEIGHT + 2.0 * ring
    assert one["frontiers"] == 0


@real_time
def test_a_robot_at_the_end_of_all_room_says_once_that_what_it_sees_beyond_is_left_out(
    tmp_path: Path,
) -> None:
    (tmp_path / "own_body.py").write_text(EXAMPLE.read_text())
    own = {"make": "own_body:HallRobot", "settings": {"size": [412.0, HEIGHT]}}
    path = write(tmp_path, 1, [free_port()], own=own, start=[408.0, 3.0, 0.0])
    path.write_bytes(yaml.encode(yaml.decode(path.read_bytes()) | {"robots": 1}))
    command = [sys.executable, "-m", "vedette", "agent", str(path), "--speed", "10"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as agent:
        beyond = []
        wait_until(
            lambda: [beyond.append(said["beyond"]) for said in told([path]) if said] and beyond[-1], 60.0
        )
        agent.terminate()
        _, err = agent.communicate(timeout=30.0)
    line = "vedette: what the robot sees beyond x -409.6 to 409.6 m, y -409.6 to 409.6 m is left out: "
    assert [each.startswith(line) for each in err.splitlines()].count(True) == 1, err


def test_the_example_takes_at_most_forty_lines_and_is_the_one_that_is_explained() -> None:
    code = EXAMPLE.read_text(encoding="utf-8")
    assert len(code.splitlines()) <= 40
    assert f"```python\n{code}```" in (ROOT / "docs" / "how-to" / "own-body.md").read_text(encoding="utf-8")


BODIES = """
from vedette.errors import InputError

class Wheels:
    hull = pose = figures = None
    def __init__(self, spec): pass
    def carry_out(self, motion, now): pass

def refused(spec, port): raise InputError(f"port {port}: no robot there")

def broken(spec): raise OSError("no such\\nport")
"""


@pytest.mark.parametrize(
    ("make", "settings", "said"),
    [
        ("Wheels", {}, "body.own.make: 'Wheels' must be module:NAME, as my_robot:MyRobot"),
        ("own_bodys:Wheels", {}, "cannot import own_bodys: ModuleNotFoundError: No module named 'own_bodys'"),
        ("bodies:Weels", {}, "body.own.make: bodies has no 'Weels'; did you mean 'Wheels'?"),
        ("bodies:Wheels", {}, "what bodies:Wheels makes is no body: it lacks sense, stop; see docs/how-to"),
        ("bodies:Wheels", {"port": 3}, "bodies:Wheels cannot be made: TypeError: Wheels.__init__() got an"),
        ("bodies:refused", {"port": 3}, "port 3: no robot there"),
        ("bodies:broken", {}, "bodies:broken cannot be made: OSError: no such port; mend body.own.settings"),
        ("halved:Wheels", {}, "cannot import halved: SyntaxError: "),
    ],
)
def test_what_is_no_body_is_told_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, make: str, settings: dict[str, Any], said: str
) -> None:
    (tmp_path / "bodies.py").write_text(BODIES)
    (tmp_path / "halved.py").write_text("class Wheels(:\n")
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "bodies", raising=False)
    with pytest.raises(InputError) as told:
        OwnSettings(make, settings).body(SPEC, tmp_path)
    assert said in str(told.value)
    assert "\n" not in str(told.value)


class Scripted:
    """A body that senses what it is given, or raises it."""

    figures, pose = BodyFigures(), (0.0, 0.0, 0.0)

    def __init__(self, spec: PlatformSpec, sensed: Any) -> None:
        self.hull, self.sensed = spec, sensed

    def sense(self, now: float) -> list[Event]:
        if isinstance(self.sensed, Exception):
            raise self.sensed
        return self.sensed  # type: ignore[no-any-return]

    def carry_out(self, motion: Motion, now: float) -> None:
        raise OSError("the motors\nare off")

    def stop(self, now: float) -> None:
        pass


def scan(angles: int, ranges: list[float]) -> Scan:
    return Scan(np.zeros(angles), np.array(ranges))


@pytest.mark.parametrize(
    ("sensed", "said"),
    [
        (OSError("no such\nport"), "OSError: no such port"),
        (None, "TypeError: 'NoneType' object is not iterable"),
        ([Pose(math.nan, 0.0, 0.0)], "ValueError: a Pose is at nan, 0.0, 0.0; give finite m and rad"),
        ([Pose(1e300, 0.0, 0.0)], "ValueError: a Pose is at 1e+300, 0.0, 0.0; give finite m and rad"),
        ([scan(3, [1.0, 2.0])], "ValueError: a Scan has angles (3,) and ranges (2,); give (B,) of both"),
        ([scan(2, [1.0, -2.0])], "ValueError: a Scan has an angle or offset that is not finite, or a range"),
        (["a scan"], "ValueError: str is nothing that a body senses; see docs/how-to/own-body.md"),
    ],
)
def test_what_a_body_does_wrong_on_the_way_is_told_in_a_line(sensed: Any, said: str) -> None:
    body = CheckedBody("bodies:Scripted", Scripted(SPEC, sensed), SPEC)
    with pytest.raises(InputError) as told:
        body.sense(0.0)
    assert str(told.value).startswith(f"body.own: sense of bodies:Scripted: {said}")
    with pytest.raises(InputError, match=r"carry_out of bodies:Scripted: OSError: the motors are off"):
        body.carry_out(Drive(None), 0.0)


def test_what_a_body_senses_comes_through_as_it_is() -> None:
    events = [Pose(1.0, 2.0, 3.0), scan(3, [1.0, math.inf, math.nan]), Stuck()]
    body = CheckedBody("bodies:Scripted", Scripted(SPEC, events), SPEC)
    assert body.sense(0.0) is events
    assert (body.pose, body.hull, body.figures) == ((0.0, 0.0, 0.0), SPEC, BodyFigures())


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"map": "map.yaml"}, "body.map: is the world of a simulated robot; leave it, or body.own, out"),
        ({"ros2": {}}, "body.own: is a robot of another kind; leave it, or body.ros2, out"),
        ({"own": {"settings": {}}}, "body.own"),
        ({"own": {"make": "a:B", "setings": {}}}, "did you mean 'settings'?"),
        ({"speed": 0.0}, "speed must be 0.01 to 10 m/s"),
    ],
)
def test_what_does_not_go_with_a_body_of_ones_own_is_told_with_the_file(
    tmp_path: Path, changes: dict[str, Any], said: str
) -> None:
    path = write(tmp_path, 1, [17551], **changes)
    with pytest.raises(InputError) as told:
        load_config(path)
    assert str(path) in str(told.value)
    assert said in str(told.value)


NEAR, FAR = [1.0, 1.0, 0.0], [448262.5, 5411932.2, 0.0]


@pytest.mark.parametrize(
    ("start", "explore", "said"),
    [
        (FAR, {}, "and the team's ground is x -409.6 to 409.6 m, y -409.6 to 409.6 m"),
        (NEAR, {"area": [[5, 0], [9, 0], [9, 6]]}, "team's ground is x 5.0 to 9.0 m, y 0.0"),
        (NEAR, {"area": [[1.0, 1.0], [1.01, 1.0], [1.0, 1.01]]}, "no cell of 0.1 m has its middle"),
        (NEAR, {"area": [[0, 0], [9, 0]]}, "explore.area: 2 corners; a polygon has 3 to 1000"),
        (NEAR, {"area": [[0, 0], [9, 0], [18, 0]]}, "explore.area: all corners are on a line"),
        (NEAR, {"area": [[0, 0], [9e4, 0], [9e4, 9e4]]}, "area: 900000 x 900000 cells of 0.1 m"),
        (NEAR, {"unbounded": True}, "explore.unbounded: no real robot is told how far its ground"),
    ],
)  # fmt: skip
def test_ground_that_a_robot_sees_nothing_of_is_told_in_a_line(
    tmp_path: Path, start: list[float], explore: dict[str, Any], said: str
) -> None:
    (tmp_path / "own_body.py").write_text(EXAMPLE.read_text())
    path = write(tmp_path, 1, [17551], start=start)
    path.write_bytes(yaml.encode(yaml.decode(path.read_bytes()) | {"explore": explore}))
    ran = CliRunner().invoke(agent_command, [str(path)])
    assert isinstance(ran.exception, InputError), ran
    assert str(path) in str(ran.exception)
    assert said in str(ran.exception)


def test_vehicles_that_fly_have_no_body_of_ones_own(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(
        '{team: a, robot: 1, track: {}, begins: 2027-01-31T12:00:00Z, body: {own: {make: "a:B"}}}'
    )
    with pytest.raises(InputError, match=r"body\.own: is for robots that explore"):
        load_config(path)
