"""The bench of monitoring: SGP-Tools' ways, asked for in its own environment, are gone as they are given."""

from __future__ import annotations

import json
import sys
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from bench import monitoring
from bench.sgp import planner, ways
from vedette.domains.monitoring.patrols import strip
from vedette.domains.monitoring.ways import Way
from vedette.errors import InputError
from vedette.record.monitor.observer import MonitorReport
from vedette.run import DomainMission
from vedette.sim.domain import Domain
from vedette.sim.domains import domain_of

SMALL: dict[str, Any] = {
    "area": [0, 0, 20, 16],
    "field": {"type": "drawn"},
    "model": {"mean": 20, "deviation": 3, "length": 6},
    "sensor": {"noise": 0.5},
    "vehicles": [{"start": [3, 3]}, {"start": [4, 3]}],
    "duration": 30,
}
CASE = domain_of("monitor").case(SMALL)
run_lawnmower = partial(DomainMission[MonitorReport], scenario=SMALL, seed=4, coordination="lawnmower")


def report(domain: Domain[Any, Any, Any, Any, MonitorReport]) -> MonitorReport:
    return run_lawnmower(domain).run(compare=False)


def test_ways_that_are_given_are_gone_like_any_patrol() -> None:
    strips = [strip(CASE.scenario.frame, CASE.scenario.vehicles[i].pose[:2], i, 2, 30.0) for i in range(2)]
    own, given = report(domain_of("monitor")), report(ways.Given(ways.Ways(tuple(strips), 1.0)))
    assert (given.summary.rmse, given.summary.rmse_mean) == (own.summary.rmse, own.summary.rmse_mean)
    across = ways.Ways((Way(((3.0, 3.0), (3.0, 15.0))), Way(((4.0, 3.0), (19.0, 3.0)))), 1.0)
    final = report(ways.Given(across)).log.snapshots[-1].vehicles
    assert [place for each in final for place in (each.x, each.y)] == pytest.approx([3.0, 15.0, 19.0, 3.0])


def test_the_planner_is_told_what_our_robots_know_too() -> None:
    assert ways.task(CASE, 4) == {
        "seed": 4,
        "area": (0, 0, 20, 16),
        "deviation": 3,
        "length": 6,
        "noise": 0.5,
        "starts": [(3, 3), (4, 3)],
        "budget": 30.0,
    }


def test_task_and_ways_are_handed_over_as_files(tmp_path: Path) -> None:
    answer, python = tmp_path / "answer.json", tmp_path / "python"
    answer.write_text(json.dumps({"ways": [[[3, 3], [9, 9]], [[4, 3], [4, 3]]], "cpu_s": 7.0}))
    python.write_text(
        f'#!/bin/sh\ntest "$1" = {planner.__file__} && cp "$2" {tmp_path}/asked && cp {answer} "$3"\n'
    )
    python.chmod(0o755)
    told = ways.ask(str(python), CASE, 4)
    assert told == ways.Ways((Way(((3, 3), (9, 9))), Way(((4, 3), (4, 3)))), 7.0)
    assert json.loads((tmp_path / "asked").read_text()) == json.loads(json.dumps(ways.task(CASE, 4)))


@pytest.mark.parametrize("python", [None, "/no/such/python", sys.executable])
def test_without_its_environment_one_line_says_how_to_make_one(python: str | None, tmp_path: Path) -> None:
    options = ["--coordinations", "sgptools", "--out", str(tmp_path)]
    options += [] if python is None else ["--sgptools", python]
    ran = CliRunner().invoke(monitoring.monitoring, options)
    assert isinstance(ran.exception, InputError)
    assert str(ran.exception).count("\n") == 0
    assert "pip install sgptools" in str(ran.exception)
    assert not list(tmp_path.iterdir())
