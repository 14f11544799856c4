"""What the command says when it is called by halves, or mistyped; and what a shell completes."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

import vedette as package
from tests.support.commands import Command, refused
from tests.support.places import ROOT
from vedette.domains.mapping.planners import PLANNERS
from vedette.sim.worlds import GENERATORS


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys)


@pytest.mark.parametrize("group", [(), ("team",)])
def test_a_group_without_a_command_prints_its_help_line_by_line(
    vedette: Command, group: tuple[str, ...]
) -> None:
    bare, asked = vedette(*group), vedette(*group, "--help")
    assert (bare.status, bare.out, bare.err) == (2, "", asked.out)
    assert bare.err.startswith("Usage: vedette")
    assert len(bare.err.splitlines()) > 5


@pytest.mark.parametrize(
    ("typed", "meant"),
    [(("explroe",), "explore"), (("serach", "x.yaml"), "search"), (("team", "trak"), "track")],
)
def test_a_mistyped_command_gets_the_nearest_one(
    vedette: Command, typed: tuple[str, ...], meant: str
) -> None:
    refused(vedette(*typed), f"id you mean {meant!r}?")


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        (("explore", "--robot", 3), "unknown option '--robot'; did you mean '--robots'?"),
        (("track", "--no-compaer"), "unknown option '--no-compaer'; did you mean '--no-compare'?"),
        (("team", "search", "--leese", 3), "unknown option '--leese'; did you mean '--lease'?"),
        (("--verson",), "unknown option '--verson'; did you mean '--version'?"),
        (("explore", "--zzz"), "unknown option '--zzz'; see vedette explore --help"),
        (("study",), "SPEC is missing; see vedette study --help"),
        (("world", "office"), "--out DIR is missing; see vedette world --help"),
        (("keys", "pair"), "DIR is missing; see vedette keys make --help"),
    ],
)
def test_a_mistyped_option_gets_the_nearest_one_and_a_missing_argument_its_help(
    vedette: Command, typed: tuple[str, ...], said: str
) -> None:
    refused(vedette(*typed), said)


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        (("explore", "agent.yaml"), "agent.yaml is a robot's file, not a map; it goes with: vedette agent"),
        (
            ("agent", "track.yaml"),
            "track.yaml is a tracking scenario, not a robot's file; it goes with: vedette t",
        ),
        (
            ("track", "search.yaml"),
            "search.yaml is a search scenario, not a tracking scenario; it goes with: ",
        ),
        (("search", "track.yaml"), "track.yaml is a tracking scenario, not a search scenario"),
        (("explore", "--team", "agent.yaml"), "agent.yaml is a robot's file, not a team file"),
        (("explore", "--faults", "track.yaml"), "track.yaml is a tracking scenario, not a fault schedule"),
        (("study", "agent.yaml"), "agent.yaml is a robot's file, not a study's spec"),
    ],
)
def test_a_file_given_to_another_command_is_sent_to_its_own(
    vedette: Command, typed: tuple[str, ...], said: str
) -> None:
    Path("agent.yaml").write_text("team: office\nrobot: 1\nlinks: {insecure: true}\n")
    Path("track.yaml").write_text("area: [0, 0, 9, 9]\nvehicles: []\ntargets: []\n")
    Path("search.yaml").write_text("area: [0, 0, 9, 9]\nvehicles: []\nprior: []\n")
    refused(vedette(*typed), said)


def test_two_files_of_one_robot_are_not_asked_as_one(vedette: Command) -> None:
    text = "team: office\nrobot: 1\nlinks: {insecure: true}\nbody: {map: map.yaml, start: [1, 1, 0]}\n"
    for name in ("a.yaml", "b.yaml"):
        Path(name).write_text(text)
    refused(vedette("status", "a.yaml", "b.yaml"), "a.yaml and b.yaml are both of robot 1; leave one out")
    Path("b.yaml").write_text(text.replace("robot: 1", "robot: 2").replace("insecure", "scouting"))
    refused(vedette("status", "a.yaml", "b.yaml"), "some of the files have secured links and some have not")


@pytest.mark.parametrize(
    ("said", "refusal"),
    [
        ("explore --seed x", "--seed must be a whole number, 0 or more; got 'x'"),
        ("explore --seed -1", "--seed must be a whole number, 0 or more; got '-1'"),
        ("world maze --out w --seed 1.5", "--seed must be a whole number, 0 or more; got '1.5'"),
        ("replay a.log --robots 65", "--robots must be a whole number, 1 to 64; got '65'"),
        ("replay a.log --robots 1_0", "--robots must be a whole number, 1 to 64; got '1_0'"),
        (f"replay a.log --robots {'9' * 5000}", "--robots must be a whole number, 1 to 64; got '99999"),
        ("watch run --port -2", "--port must be a whole number, 0 to 65535; got '-2'"),
        ("watch run --foxglove 65536", "--foxglove must be a whole number, 0 to 65535; got '65536'"),
        ("study s.yaml --jobs 0", "--jobs must be a whole number, 1 to 1024; got '0'"),
        ("search --trials some", "--trials must be a whole number, 0 to 1000000; got 'some'"),
    ],
)
def test_a_number_that_must_be_whole_is_asked_for_with_its_limits(
    vedette: Command, said: str, refusal: str
) -> None:
    refused(vedette(*said.split()), refusal)


def test_force_without_a_folder_is_told_to_be_in_vain(vedette: Command) -> None:
    ran = vedette("explore", "--robots", 1, "--max-time", 0.5, "--json", "--force")
    assert ran.err == "vedette: --force changes nothing without --out: the results go into a new folder\n"


def test_a_robots_file_that_is_not_there_is_not_called_a_scenario(vedette: Command) -> None:
    refused(vedette("agent", "nowhere.yaml"), "cannot read robot's file nowhere.yaml")


def test_a_place_for_one_robot_alone_is_told_in_the_singular(vedette: Command) -> None:
    vedette("world", "maze", "--width", 10, "--height", 10, "--seed", 1, "--out", "maze")
    Path("wide.yaml").write_text("platforms: [{radius: 1}, {radius: 1}, {radius: 1}]")
    ran = vedette("explore", "maze/map.yaml", "--team", "wide.yaml", "--out", "out")
    refused(ran, "3 robots do not fit in maze; only 1 does: use fewer or smaller ones")


def test_the_version_is_that_of_the_project_wherever_one_asks(vedette: Command) -> None:
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert package.__version__ == version
    assert vedette("--version").out == f"vedette, version {version}\n"


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("vedette wo", ["plain,world"]),
        ("vedette explore --planner ", [f"plain,{name}" for name in PLANNERS]),
        ("vedette explore --planner ja", ["plain,jacobi"]),
        ("vedette world ", [f"plain,{name}" for name in (*GENERATORS, "log")]),
        ("vedette explore my-w", ["file,my-w"]),
        ("vedette track --out my-w", ["file,my-w"]),
        ("vedette status pair", ["file,pair"]),
    ],
)
def test_a_shell_completes_commands_planners_worlds_and_files(
    vedette: Command, monkeypatch: pytest.MonkeyPatch, typed: str, offered: list[str]
) -> None:
    words = re.split(" ", typed)
    monkeypatch.setenv("_VEDETTE_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(len(words) - 1))
    assert vedette().out.splitlines() == offered
