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
        ("vedette world ", [f"plain,{name}" for name in GENERATORS]),
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
