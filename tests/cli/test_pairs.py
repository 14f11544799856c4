"""Options that do not go together are refused or told; none is overridden in silence."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from tests.support.commands import Command, check_files, refused
from tests.support.track_scenes import content
from vedette.domains.mapping.planners import PLANNERS
from vedette.errors import InputError, InputWarning
from vedette.negotiation import SCHEMES
from vedette.net.config import load_config
from vedette.run import Explore, Track
from vedette.study.combinations import runs_of
from vedette.study.spec import load_spec

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
    refused(ran, f"planner {planner} negotiates by {own}, which is part of it; leave out scheme {other}")


@pytest.mark.parametrize("scheme", [(), ("--scheme", "jacobi")])
def test_a_scheme_that_is_the_planners_own_or_not_given_is_none_to_speak_of(
    vedette: Command, scheme: tuple[str, ...]
) -> None:
    ran = vedette("explore", "--planner", "jacobi", *scheme, "--max-time", 1, "--out", "out", "--json")
    assert (ran.err, json.loads(ran.out)["scheme"]) == ("", "jacobi")


def by_agents_file(planner: str, scheme: str) -> object:
    Path("robot.yaml").write_text(
        "team: office\nrobot: 1\nlinks: {insecure: true}\nbody: {map: map.yaml, start: [1, 1, 0]}\n"
        f"explore: {{planner: {planner}, scheme: {scheme}}}"
    )
    return load_config("robot.yaml")


def by_spec(planner: str, scheme: str) -> object:
    Path("spec.yaml").write_text(
        f"planners: [tours, {planner}]\nworlds: [{{kind: maze}}]\nsetup: {{scheme: [{scheme}]}}"
    )
    return runs_of(load_spec(Path("spec.yaml")), Path("spec.yaml"))


def from_python(planner: str, scheme: str) -> object:
    return Explore((np.zeros((30, 30)), 0.1), 2, planner=planner, scheme=scheme)


DOORS = [by_agents_file, by_spec, from_python]


@pytest.mark.parametrize("door", DOORS)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("planner", PLANNERS)
def test_by_every_door_a_scheme_is_refused_told_to_be_in_vain_or_what_is_agreed_by(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    door: Callable[[str, str], Any],
    planner: str,
    scheme: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    own = {"jacobi": "jacobi", "greedy": "token"}.get(planner, scheme)
    alone = planner in ("nearest", "cost-utility", "burgard", "hungarian", "makespan", "optimal")
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", InputWarning)
        if own != scheme:
            with pytest.raises(InputError, match=f"planner {planner} negotiates by {own}.*scheme {scheme}"):
                door(planner, scheme)
        else:
            made = door(planner, scheme)
            agreed = (
                "token" if alone and scheme in ("multistart", "fork", "async") else scheme
            )  # which would take back
            if isinstance(made, Explore):
                assert {agent.scheme for agent in made.simulation.agents} == {agreed}
    vain = "; scheme jacobi asks it more than once" if scheme == "jacobi" else ", whatever scheme"
    lines = [f"planner {planner} chooses without negotiating{vain}"] if alone else []
    if door is not by_agents_file:  # which is also read by others than the agent
        assert [str(line.message) for line in told] == lines


@pytest.mark.parametrize("planner", ["tours", "jacobi", "greedy"])
def test_without_a_scheme_a_study_tells_by_which_each_planner_negotiated(
    tmp_path: Path, planner: str
) -> None:
    path = tmp_path / "spec.yaml"
    path.write_text(f"planners: [{planner}]\nworlds: [{{kind: maze}}]")
    (run,) = runs_of(load_spec(path), path)
    assert run.columns()["scheme"] == {"jacobi": "jacobi"}.get(planner, "token")


def test_a_resolution_that_replaces_the_maps_own_is_told_and_the_same_one_is_not(vedette: Command) -> None:
    vedette("world", "maze", "--width", 10, "--height", 10, "--out", "maze")
    run = ("explore", "maze/map.yaml", "--robots", 1, "--max-time", 1, "--json", "--out")
    assert vedette(*run, "a", "--resolution", 0.1).err == ""
    said = vedette(*run, "b", "--resolution", 0.12).err
    assert said == "vedette: resolution 0.12 replaces that of maze/map.yaml, 0.1 m\n"


def test_a_start_that_replaces_the_team_files_is_told(vedette: Command) -> None:
    vedette("world", "maze", "--width", 10, "--height", 10, "--out", "maze")
    Path("team.yaml").write_text(TEAM)
    run = ("explore", "maze/map.yaml", "--team", "team.yaml", "--max-time", 1, "--json", "--out")
    assert vedette(*run, "a").err == ""
    ran = vedette(*run, "b", "--starts", "0.5,0.5")
    assert (ran.status, ran.err) == (1, "vedette: --starts replaces the team file's start of scout\n")


def test_robots_of_a_team_file_that_are_left_out_are_named(vedette: Command) -> None:
    Path("team.yaml").write_text(TEAM)
    run = ("explore", "--team", "team.yaml", "--max-time", 1, "--json", "--out")
    assert vedette(*run, "a", "--robots", 2).err == ""
    assert vedette(*run, "b", "--robots", 1).err == "vedette: --robots 1 leaves out mule of team.yaml\n"


def test_a_death_after_the_end_is_told_and_a_second_one_refused(vedette: Command) -> None:
    run = ("explore", "--robots", 2, "--max-time", 2, "--json", "--out")
    assert vedette(*run, "a", "--kill", "2@1").err == ""
    said = vedette(*run, "b", "--kill", "2@9").err
    assert said == "vedette: robot 2 does not die at 9 s: the mission is over after 2 s\n"
    refused(vedette(*run, "c", "--kill", "2@1", "--kill", "2@1.5"), "kills: robot 2 dies twice")


def test_one_robot_alone_is_told_what_needs_others(vedette: Command) -> None:
    run = ("explore", "--robots", 1, "--max-time", 1, "--json", "--out")
    assert vedette(*run, "a").err == ""
    said = vedette(*run, "b", "--scheme", "jacobi", "--fusion", "channel", "--radio", 5).err
    assert said == "vedette: one robot alone tells nobody anything, whatever scheme, fusion, radio\n"


def test_an_objective_that_replaces_the_scenarios_is_told() -> None:
    with pytest.warns(
        InputWarning, match="objective trajectory replaces that of the scenario, final-entropy"
    ):
        Track(content(duration=6, objective="final-entropy"), objective="trajectory")
    with warnings.catch_warnings():
        warnings.simplefilter("error", InputWarning)
        Track(content(duration=6, objective="final-entropy"), objective="final-entropy")
        Track(content(duration=6), objective="final-entropy")


@pytest.mark.parametrize("coordination", ["shared", "optimum"])
def test_a_scheme_is_in_vain_where_no_plans_are_told(coordination: str) -> None:
    few = content(duration=6, decisions=2)
    with pytest.warns(
        InputWarning, match=f"with coordination {coordination} nobody negotiates, whatever sch"
    ):
        Track(few, coordination=coordination, scheme="jacobi")


@pytest.mark.parametrize("command", ["track", "search"])
def test_what_is_in_vain_since_vehicles_tell_each_other_nothing_is_told(
    vedette: Command, command: str
) -> None:
    run = (command, "--coordination", "none", "--max-time", 4, "--json", "--no-compare", "--out")
    assert vedette(*run, "a").err == ""
    said = vedette(*run, "b", "--scheme", "jacobi", "--link-loss", 0.5, "--radio", 50).err
    assert said == (
        "vedette: with coordination none nobody tells anybody anything, whatever scheme, radio, link loss\n"
    )
    sent = json.loads(Path("b/summary.json").read_text())["messages"].values()
    assert not any(kinds["negotiation"] or kinds["fusion"] for kinds in sent)


@pytest.mark.parametrize("command", ["track", "search"])
def test_the_scenario_that_is_built_in_is_flown_and_compared_and_leaves_its_files(
    vedette: Command, command: str
) -> None:
    assert vedette(command, "--max-time", 4, "--out", "out").err == ""
    check_files(Path("out"), command)


def test_a_limit_beyond_the_end_of_a_scenario_is_told(vedette: Command) -> None:
    Path("short.yaml").write_text(yaml.safe_dump(content(duration=6)))
    ran = vedette("track", "short.yaml", "--max-time", 99999, "--no-compare", "--json", "--out", "out")
    assert json.loads(ran.out)["time_s"] == pytest.approx(6.0)
    assert ran.err == "vedette: max-time 99999 is beyond the scenario's end, 6 s: it ends there\n"


def test_jobs_on_a_cluster_that_has_its_own_workers_are_refused(
    vedette: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DASK_SCHEDULER_ADDRESS", "tcp://127.0.0.1:1")
    refused(vedette("study", "ten-minutes", "--backend", "dask", "--jobs", 2, "--out", "out"), "--jobs")
