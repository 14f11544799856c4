"""Objectives of somebody's own: worth what they say, obeying the laws, and told of in one line if not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from tests.support.commands import Command
from tests.support.own_parts import example, module
from tests.support.places import ROOT
from tests.support.search_missions import SMALL
from vedette import InputError, run
from vedette.domains.search.worth import Worth, worth_of
from vedette.domains.tracking.objective import TrackingObjective, objective
from vedette.missions.search.case import read_case
from vedette.testing import check_objective

SCENARIO = """
area: [0, 0, 300, 260]
duration: 6
horizon: 3
decisions: 2
vehicles:
  - {start: [60, 40, 90], speed: 18, turn_rate: 0.4, sensor: {type: range-bearing, range: 120}}
  - {start: [90, 40, 90], speed: 18, turn_rate: 0.4, sensor: {type: bearing, range: 150}}
targets:
  - {model: static, mean: [60, 120], sd: [20, 20]}
  - {model: static, mean: [120, 90], sd: [20, 20]}
"""
OWN = """
from vedette.domains.search.worth import Worth
from vedette.domains.tracking.objective import TrackingObjective

class Nothing: pass

class Raises(TrackingObjective):
    def values(self, belief, others, own): return [1 / 0]

class Long(TrackingObjective):
    def values(self, belief, others, own): return [1.0] * (len(own) + 1)

class Endless(TrackingObjective):
    def values(self, belief, others, own): return [float("nan")] * len(own)

def half(horizon, gamma, tail): return Worth([1.0] * (horizon - 1) + [0.5], horizon)

def short(horizon, gamma, tail): return Worth([1.0], 1)

def rising(horizon, gamma, tail): return Worth(list(range(horizon)), horizon)
"""


def scenario(folder: Path, own: str) -> Path:
    path = folder / "own.yaml"
    path.write_text(f"{SCENARIO}objective: {own}\n")
    return path


def test_the_example_counts_its_target_ten_times_and_keeps_the_laws(tmp_path: Path) -> None:
    name = f"{example('own_objective', tmp_path)}:Guarding"
    mission = run.Track(scenario(tmp_path, name), max_time=3.0)
    while mission.step() is None and mission.now < 2.0:
        pass
    tracker = mission.simulation.missions[0]
    belief, plain, own = tracker.freeze(mission.now), TrackingObjective(), objective(name)
    tracker.vehicle.prepare(belief)
    impacts = [tracker.vehicle.impact(belief, course) for course in tracker.vehicle.courses[:5]]
    check_objective(own, belief, impacts)
    for impact in impacts:
        first = impact.targets == 0
        alone = type(impact)(impact.targets[first], impact.blocks[first])
        expected = plain.value(belief, impact) + 9.0 * plain.value(belief, alone)
        assert own.value(belief, impact) == pytest.approx(expected)
    assert type(tracker.objective).__name__ == "Guarding"


def test_an_own_objective_leads_a_team_elsewhere(tmp_path: Path) -> None:
    guarding = f"{example('own_objective', tmp_path)}:Guarding"
    ways = [
        run.track(scenario(tmp_path, name)).log.snapshots[-1].vehicles for name in (guarding, "trajectory")
    ]
    assert [(each.x, each.y) for each in ways[0]] != [(each.x, each.y) for each in ways[1]]


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("Nothing", "TypeError: gives Nothing; a TrackingObjective is asked for"),
        ("Raises", "values: ZeroDivisionError: division by zero (own_part_"),
        ("Long", "values: ValueError: gives ("),
        ("Endless", "values: ValueError: gives nan; a finite number is asked for"),
    ],
)
def test_what_an_objective_does_wrong_is_told_in_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], name: str, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    own = f"{module(tmp_path, OWN)}:{name}"
    ran = Command(monkeypatch, capsys, "track")(scenario(tmp_path, own), "--no-compare", "--out", "out")
    assert ran.status == 2
    assert ran.err.splitlines()[-1].startswith(f"vedette: objective {own}: {said}")
    assert "Traceback" not in ran.err


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("trajectroy", "unknown objective 'trajectroy'; did you mean 'trajectory'?"),
        ("nowhere_at_all:X", "objective: cannot import nowhere_at_all: ModuleNotFoundError"),
        (
            "math:pi",
            "objective math:pi: is float, not a class of objectives; see docs/how-to/own-obj",
        ),
    ],
)
def test_an_objective_that_there_is_not_is_told_with_the_file(tmp_path: Path, name: str, said: str) -> None:
    path = scenario(tmp_path, name)
    with pytest.raises(InputError) as told:
        run.Track(path)
    assert str(told.value).startswith(f"{path}: ")
    assert said in str(told.value)


def test_an_own_worth_is_that_of_the_team(tmp_path: Path) -> None:
    own = module(tmp_path, OWN)
    path = tmp_path / "search.yaml"
    path.write_text(yaml.safe_dump(SMALL | {"worth": f"{own}:half"}))
    weights = read_case(path).scenario.weights
    assert isinstance(weights, Worth)
    assert weights.weights.tolist() == [1.0] * (SMALL["horizon"] - 1) + [0.5]
    for name, said in (
        ("short", f"worth {own}:short: TypeError: gives Worth; a Worth of"),
        ("rising", "worth: weights must be >= 0 and never rise"),
        ("hlaf", f"worth: {own} has no 'hlaf'; did you mean 'half'?"),
    ):
        path.write_text(yaml.safe_dump(SMALL | {"worth": f"{own}:{name}"}))
        with pytest.raises(InputError) as told:
            read_case(path)
        assert said in str(told.value)
        assert str(told.value).startswith(f"{path}: ")


def test_the_houses_worths_are_what_they_were() -> None:
    assert worth_of("plain", 4, 0.5, 0.0).weights.tolist() == [1.0] * 4
    assert worth_of("discounted", 3, 0.5, 0.0).weights.tolist() == [1.0, 0.5, 0.25]
    assert np.allclose(worth_of("mean-time", 4, 0.5, 0.0).weights, [1.0, 0.75, 0.5, 0.25], atol=0.0)


def test_the_example_is_the_one_that_is_explained() -> None:
    code = (ROOT / "examples" / "own_objective.py").read_text(encoding="utf-8")
    page = (ROOT / "docs" / "how-to" / "own-objective.md").read_text(encoding="utf-8")
    assert f"```python\n{code}```" in page
