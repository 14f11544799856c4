"""Options that do not go together are refused or told; none is overridden in silence."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from tests.support.commands import Command, refused
from tests.support.track_scenes import content

TEAM = "platforms:\n  - {name: scout, start: [1.5, 1.5]}\n  - {name: mule}\n"


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys)


@pytest.mark.parametrize("command", [("explore",), ("team", "explore")])
@pytest.mark.parametrize(
    ("planner", "own", "other"), [("jacobi", "jacobi", "token"), ("greedy", "token", "jacobi")]
)
def test_a_scheme_that_the_planner_overrides_is_refused(
    vedette: Command, command: tuple[str, ...], planner: str, own: str, other: str
) -> None:
    ran = vedette(*command, "--planner", planner, "--scheme", other, "--out", "out")
    refused(ran, f"--planner {planner} negotiates by {own}", f"leave out --scheme {other}")


@pytest.mark.parametrize("scheme", [(), ("--scheme", "jacobi")])
def test_a_scheme_that_is_the_planners_own_or_not_given_is_none_to_speak_of(
    vedette: Command, scheme: tuple[str, ...]
) -> None:
    ran = vedette("explore", "--planner", "jacobi", *scheme, "--max-time", 1, "--out", "out", "--json")
    assert (ran.err, json.loads(ran.out)["scheme"]) == ("", "jacobi")


def test_a_resolution_that_replaces_the_maps_own_is_told_and_the_same_one_is_not(vedette: Command) -> None:
    vedette("world", "maze", "--width", 10, "--height", 10, "--out", "maze")
    run = ("explore", "maze/map.yaml", "--robots", 1, "--max-time", 1, "--json", "--out")
    assert vedette(*run, "a", "--resolution", 0.1).err == ""
    said = vedette(*run, "b", "--resolution", 0.12).err
    assert said == "vedette: --resolution 0.12 replaces that of maze/map.yaml, 0.1 m\n"


def test_a_start_that_replaces_the_team_files_is_told(vedette: Command) -> None:
    vedette("world", "maze", "--width", 10, "--height", 10, "--out", "maze")
    Path("team.yaml").write_text(TEAM)
    run = ("explore", "maze/map.yaml", "--team", "team.yaml", "--max-time", 1, "--json", "--out")
    assert vedette(*run, "a").err == ""
    ran = vedette(*run, "b", "--starts", "0.5,0.5")
    assert (ran.status, ran.err) == (1, "vedette: --starts replaces the team file's start of scout\n")


@pytest.mark.parametrize("command", ["track", "search"])
def test_what_is_in_vain_since_vehicles_tell_each_other_nothing_is_told(
    vedette: Command, command: str
) -> None:
    run = (command, "--coordination", "none", "--max-time", 4, "--json", "--no-compare", "--out")
    assert vedette(*run, "a").err == ""
    said = vedette(*run, "b", "--scheme", "jacobi", "--link-loss", 0.5, "--radio", 50).err
    assert said == (
        "vedette: with --coordination none nobody tells anybody anything, "
        "whatever --scheme, --radio, --link-loss\n"
    )
    sent = json.loads(Path("b/summary.json").read_text())["messages"].values()
    assert not any(kinds["negotiation"] or kinds["fusion"] for kinds in sent)


def test_a_limit_beyond_the_end_of_a_scenario_is_told(vedette: Command) -> None:
    Path("short.yaml").write_text(yaml.safe_dump(content(duration=6)))
    ran = vedette("track", "short.yaml", "--max-time", 99999, "--no-compare", "--json", "--out", "out")
    assert json.loads(ran.out)["time_s"] == pytest.approx(6.0)
    assert ran.err == "vedette: --max-time 99999 is beyond the scenario's end, 6 s: it ends there\n"


def test_jobs_on_a_cluster_that_has_its_own_workers_are_refused(
    vedette: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DASK_SCHEDULER_ADDRESS", "tcp://127.0.0.1:1")
    refused(vedette("study", "ten-minutes", "--backend", "dask", "--jobs", 2, "--out", "out"), "--jobs")
