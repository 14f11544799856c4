"""Parts of somebody's own: found by name or as module:NAME, and what is wrong with them said in one line."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.support.commands import Command, refused
from tests.support.own_parts import example, installed, module
from vedette import parts, run
from vedette.domains.mapping.planners import PLANNER, planner
from vedette.errors import InputError
from vedette.net.own import OwnSettings
from vedette.parts import PartKind, look_in
from vedette.team import PlatformSpec

NUMBER: PartKind[int] = PartKind(
    "numbers", "number", {"one": 1}, lambda part: None if isinstance(part, int) else "is no number", "a.md"
)
BROKEN = """
from dataclasses import dataclass
from vedette.domains.mapping import layers
from vedette.domains.mapping.planners import Planner
from vedette.domains.mapping.platform import MappingPlatform

class Raises(MappingPlatform):
    def reply(self, belief, others, current):
        return 1 / 0

class Nothing(MappingPlatform):
    def reply(self, belief, others, current):
        return None

class Few(MappingPlatform):
    def reply(self, belief):
        return None

class Second(MappingPlatform):
    def reply(self, belief, others, current):
        if self.spec.name == "robot-2":
            raise ValueError("not me")
        return super().reply(belief, others, current)

class Lost(MappingPlatform):
    def prepare(self, belief):
        self.stops = []

class Bare(MappingPlatform):
    def __init__(self, spec):
        self.mine = []

def dear(spec):
    raise OSError("no licence\\nleft")

RAISES, NOTHING, FEW, SECOND, LOST, BARE = (
    Planner("", layers.rate(), kind) for kind in (Raises, Nothing, Few, Second, Lost, Bare)
)
DEAR = Planner("", layers.rate(), dear)
OTHER = Planner("", layers.rate(), lambda spec: spec)
FLAT = Planner("", None, Raises)
ODD = Planner("", layers.rate(), Raises, scheme="tokn")
PRICED = Planner("", layers.rate(), Raises, return_price="much")
FEWEST = Planner("", layers.rate(), Raises, most_robots=0)
"""


@pytest.fixture(autouse=True)
def _forget(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Run in a folder of its own; what is looked in, and what is installed, is forgotten afterwards."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setattr(parts, "_FOLDERS", {})
    parts._entries.cache_clear()


def test_a_part_is_found_by_the_houses_name_an_entry_points_or_its_module(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed(tmp_path, "numbers", monkeypatch, two=f"{module(tmp_path, 'TWO = 2')}:TWO", one="nowhere:ONE")
    assert [NUMBER.find(name) for name in ("one", "two")] == [1, 2]  # the house's come first
    assert NUMBER.find(f"{module(tmp_path, 'THREE = 3')}:THREE") == 3
    assert NUMBER.names == ["one", "two"]


def test_the_environment_comes_before_the_folder_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "json.py").write_text("loads = 7\n")
    look_in(tmp_path)
    with pytest.raises(InputError, match="is no number; see a"):
        NUMBER.find("json:loads")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("tow", "unknown number 'tow'; known: one"),
        ("ones", "unknown number 'ones'; did you mean 'one'?"),
        (":one", "unknown number ':one'; did you mean 'one'?"),
        ("nowhere_at_all:ONE", "number: cannot import nowhere_at_all: ModuleNotFoundError: No module named"),
        ("math:p", "number: math has no 'p'; did you mean 'pi'?"),
        ("math:sin", "number math:sin: is no number; see a.md"),
    ],
)
def test_a_part_that_there_is_not_is_told_in_a_line(name: str, said: str) -> None:
    with pytest.raises(InputError) as told:
        NUMBER.find(name)
    assert str(told.value).startswith(said)
    assert "\n" not in str(told.value)


def test_a_module_that_breaks_when_it_is_imported_is_told_in_a_line(tmp_path: Path) -> None:
    look_in(tmp_path)
    for code, said in (
        ("1 / 0\n", "ZeroDivisionError"),
        ("def (:\n", "SyntaxError"),
        ("raise SystemExit(3)\n", "SystemExit"),
    ):
        with pytest.raises(
            InputError, match=rf"number: cannot import own_part_\d+: {said}: .*line 1\); mend it"
        ):
            NUMBER.find(f"{module(tmp_path, code)}:ONE")


def test_the_fingerprint_of_a_part_changes_with_all_code_beside_it_that_it_uses(tmp_path: Path) -> None:
    look_in(tmp_path)
    helper = module(tmp_path, "def three(): return 3\n")
    user = module(tmp_path, f"import math\nfrom {helper} import three\nTHREE = three()\n")
    idle = module(tmp_path, "")

    def fingerprint() -> str | None:
        for name in (user, helper, idle):
            sys.modules.pop(name, None)
        importlib.invalidate_caches()
        parts._fingerprint.cache_clear()
        NUMBER.find(f"{user}:THREE")
        return NUMBER.fingerprint(f"{user}:THREE")

    first = fingerprint()
    assert fingerprint() == first
    (tmp_path / f"{idle}.py").write_text("# more\n")
    assert fingerprint() == first
    (tmp_path / f"{helper}.py").write_text("def three(): return 1 + 2\n")
    assert fingerprint() != first
    assert NUMBER.fingerprint("one") is None


def test_a_body_is_found_by_an_entry_point(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    installed(tmp_path, "bodies", monkeypatch, hall=f"{example('own_body', tmp_path)}:HallRobot")
    body = OwnSettings("hall", {"size": [9.0, 6.0]}).body(PlatformSpec(start=(1.0, 1.0, 0.0)), tmp_path)
    assert body.pose == (1.0, 1.0, 0.0)


# -- planners -----------------------------------------------------------------------------------------


def test_the_example_of_a_planner_finishes_a_mission_by_its_module_and_by_an_entry_point(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = example("own_planner", tmp_path)
    installed(tmp_path, "planners", monkeypatch, sides=f"{name}:SIDES")
    names = ("sides", f"{name}:SIDES", "tours")
    ends = [run.explore("maze", 2, seed=1, planner=each, max_time=60.0) for each in names]
    assert ends[0].time_s == ends[1].time_s
    assert ends[0].path_m != ends[2].path_m
    assert PLANNER.names[-1] == "sides"


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("RAISES", "reply: ZeroDivisionError: division by zero (own_part_{}.py, line 9)"),
        ("NOTHING", "reply: TypeError: gives NoneType; a Tour is asked for"),
        ("FEW", "reply: TypeError: Few.reply() takes 2 positional arguments but 4 were given"),
        ("SECOND", "reply: ValueError: not me (own_part_{}.py, line 22)"),  # who replies to a message
        ("DEAR", "platform: OSError: no licence left (own_part_{}.py, line 34)"),
        ("OTHER", "platform: TypeError: gives PlatformSpec; a MappingPlatform is asked for"),
        ("FLAT", " needs layers, a TimeLayers, and a platform that can be called"),
        ("PRICED", "has 'much' as return_price, not a number from 0 to 1e+06"),
        ("FEWEST", "has 0 as most_robots, not a whole number > 0 or None"),
        ("LOST", "prepare: TypeError: leaves list in self.stops; Stops are asked for"),
        ("BARE", "platform: TypeError: its __init__ does not call that of MappingPlatform"),
    ],
)
def test_what_a_planner_does_wrong_is_told_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], name: str, said: str
) -> None:
    own = module(tmp_path, BROKEN)
    command = Command(monkeypatch, capsys, "explore")
    ran = command("maze", "--robots", 2, "--planner", f"{own}:{name}", "--out", "out")
    assert ran.status == 2
    last = ran.err.splitlines()[-1]
    assert last.startswith(f"vedette: planner {own}:{name}: {said.strip().format(own.rpartition('_')[2])}")
    assert "Traceback" not in ran.err


def test_a_planner_with_a_scheme_that_there_is_not_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ran = Command(monkeypatch, capsys, "explore")("--planner", f"{module(tmp_path, BROKEN)}:ODD")
    refused(ran, "unknown scheme of planner own_part_", "'tokn'; did you mean 'token'?")


def test_an_own_planners_contract_is_asked_of_each_robot_apart(tmp_path: Path) -> None:
    look_in(tmp_path)
    found = planner(f"{example('own_planner', tmp_path)}:SIDES")
    spec = run.Explore("maze", 1, max_time=1.0).simulation.specs[0]
    first, other = found.platform(spec), found.platform(spec)
    assert first is not other
    assert type(first).__name__ == "SidesPlatform"


# -- worlds -------------------------------------------------------------------------------------------

HALLS = """
import numpy as np
from vedette.maps import GridFrame
from vedette.maps.world import World

def hall(rng, width, height, resolution):
    solid = np.ones((round(height / resolution), round(width / resolution)), bool)
    solid[2:-2, 2:-2] = False
    solid[5:8, rng.integers(10, solid.shape[1] - 10)] = True
    return World(GridFrame(resolution, *solid.shape), solid, "hall")

def rock(rng, width, height, resolution):
    return World(GridFrame(1.0, 9, 9), np.ones((9, 9), bool), "rock")

def words(rng, width, height, resolution):
    return "a hall"
"""


def test_a_world_of_ones_own_is_made_explored_and_saved_by_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    own, vedette = module(tmp_path, HALLS), Command(monkeypatch, capsys)
    ran = vedette("world", f"{own}:hall", "--width", 10, "--height", 10, "--seed", 3, "--out", "made")
    assert ran.status == 0, ran.err
    assert ran.out.startswith(f"{own}:hall, seed 3: 10 x 10 m at 0.1 m")
    explored = run.explore(f"{own}:hall", 1, seed=3, max_time=1.0)
    again, other = (run.Explore(f"{own}:hall", 1, seed=seed).world.solid for seed in (3, 4))
    assert np.array_equal(explored.frame.shape, again.shape)
    assert not np.array_equal(again, other)
    ran = vedette("explore", f"{own}:hall", "--robots", 1, "--max-time", 2, "--json")
    assert ran.status == 1, ran.err
    assert '"world": "hall"' in ran.out


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("words", "TypeError: gives str; a World is asked for"),
        ("rock", "ValueError: gives a world without free space"),
        ("np", "is module, not a function that returns a World; see docs/how-to/worlds.md"),
    ],
)
def test_what_makes_no_world_is_told_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], name: str, said: str
) -> None:
    own = module(tmp_path, HALLS)
    for command in (["world", f"{own}:{name}", "--out", "out"], ["explore", f"{own}:{name}"]):
        refused(Command(monkeypatch, capsys)(*command), f"kind {own}:{name}: {said}")
