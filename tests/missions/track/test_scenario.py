"""Scenario files of tracking: what is wrong with one is told in one line, naming file and field."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from tests.support.places import ROOT
from tests.support.track_scenes import content, scenario
from vedette.errors import InputError, InputWarning
from vedette.missions.track.scenario import TrackScenario, checked, default_scenario, read_scenario
from vedette.scenario import as_scenario


def refusal(plain: dict[str, Any], tmp_path: Path) -> str:
    """Return the line with which a scenario file is refused."""
    path = tmp_path / "bad.yaml"
    path.write_text(yaml.safe_dump(plain))
    with pytest.raises(InputError) as refused:
        read_scenario(path)
    line = str(refused.value)
    assert line.startswith(f"{path}: ")
    assert "\n" not in line
    return line.removeprefix(f"{path}: ")


def target(**changes: Any) -> dict[str, Any]:
    """A moving target with some fields changed; those that are None left out."""
    whole = {"model": "constant-velocity", "mean": [10, 10, 1, 1], "sd": [5, 5, 1, 1]} | changes
    return {key: value for key, value in whole.items() if value is not None}


def vehicle(**changes: Any) -> dict[str, Any]:
    """A vehicle with some fields changed; those that are None left out."""
    whole = {"start": [10, 10, 0], "sensor": {"type": "bearing"}} | changes
    return {key: value for key, value in whole.items() if value is not None}


NOT_PD = [[1.0, 2.0, 0, 0], [2.0, 1.0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
SKEW = [[1.0, 0.5, 0, 0], [0, 1.0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"vehicles": []}, ["vehicles", "1 to 64 entries"]),
        ({"targets": []}, ["targets", "1 to 1000 entries"]),
        ({"horizn": 5}, ["horizn", "did you mean 'horizon'?"]),
        ({"horizon": 0}, ["horizon", "1"]),
        ({"horizon": 2.5}, ["horizon", "2.5"]),
        ({"decisions": 6}, ["decisions"]),
        ({"objective": "trajectroy"}, ["trajectroy", "did you mean 'trajectory'?"]),
        ({"step": 0.25}, ["step", "multiple", "0.1"]),
        ({"step": 0}, ["step"]),
        ({"duration": 0}, ["duration"]),
        ({"duration": 0.5}, ["duration", "at least a step"]),
        ({"duration": float("nan")}, ["duration", "finite"]),
        ({"area": [0, 0, 0, 100]}, ["area", "at least 1 m"]),
        ({"area": [0, 0, 100]}, ["area"]),
        ({"vehicles": [vehicle(start=None)]}, ["vehicles[0]", "start"]),
        ({"vehicles": [vehicle(start=[10, 10])]}, ["vehicles[0].start"]),
        ({"vehicles": [vehicle(start=[10, 1000, 0])]}, ["vehicles[0].start", "outside the area", "0 to 260"]),
        ({"vehicles": [vehicle(sped=3)]}, ["vehicles[0]", "sped", "did you mean 'speed'?"]),
        ({"vehicles": [vehicle(speed="fast")]}, ["vehicles[0].speed", "fast"]),
        ({"vehicles": [vehicle(turn_rate=0.0)]}, ["vehicles[0].turn_rate", "above 0"]),
        ({"vehicles": [vehicle(name="a b")]}, ["vehicles[0].name"]),
        ({"vehicles": [vehicle(name="a"), vehicle(name="a")]}, ["vehicles[1].name", "'a' is used twice"]),
        ({"vehicles": [vehicle(name="vehicle-2"), vehicle()]}, ["vehicles[1].name", "used twice"]),
        ({"vehicles": [vehicle(sensor=None)]}, ["vehicles[0]", "sensor"]),
        ({"vehicles": [vehicle(sensor={})]}, ["vehicles[0].sensor", "unknown type"]),
        ({"vehicles": [vehicle(sensor={"type": "baering"})]}, ["vehicles[0].sensor", "'bearing'?"]),
        ({"vehicles": [vehicle(sensor={"type": "bearing", "rang": 3})]}, ["'rang'", "'range'?"]),
        ({"vehicles": [vehicle(sensor={"type": "bearing", "range": -3})]}, ["range must be", "-3"]),
        ({"vehicles": [vehicle(sensor={"type": "bearing", "range": [3]})]}, ["range: must be a number"]),
        ({"targets": [target(model="static")]}, ["targets[0].mean", "4 numbers", "needs 2"]),
        ({"targets": [target(model="statik")]}, ["targets[0]", "statik", "static"]),
        ({"targets": [target(model=None)]}, ["targets[0]", "model"]),
        ({"targets": [target(mean=[10, 10])]}, ["targets[0].mean", "2 numbers", "needs 4"]),
        ({"targets": [target(mean=[-10, 10, 0, 0])]}, ["targets[0].mean", "outside the area"]),
        ({"targets": [target(mean=[10, float("inf"), 0, 0])]}, ["targets[0].mean[1]", "finite"]),
        ({"targets": [target(sd=None)]}, ["targets[0]", "either sd or covariance"]),
        ({"targets": [target(covariance=NOT_PD)]}, ["targets[0]", "either sd or covariance"]),
        ({"targets": [target(sd=[5, 5, 0, 1])]}, ["targets[0].sd", "0.001 to 1e6"]),
        ({"targets": [target(sd=[5, 5])]}, ["targets[0].sd", "2 numbers", "needs 4"]),
        (
            {"targets": [target(sd=None, covariance=NOT_PD)]},
            ["targets[0].covariance", "positive definite", "-1"],
        ),
        ({"targets": [target(sd=None, covariance=SKEW)]}, ["targets[0].covariance", "symmetric"]),
        ({"targets": [target(sd=None, covariance=[[1, 0], [0, 1]])]}, ["2 rows of 2", "4 x 4"]),
        ({"targets": [target(sd=None, covariance=[])]}, ["no rows", "4 x 4"]),
        ({"targets": [target(start=[7e4, 9, 0, 0])]}, ["targets[0].start: 70000, 9 is outside the area"]),
        ({"targets": [target(start=[1, 2])]}, ["targets[0].start", "2 numbers", "needs 4"]),
        ({"targets": [target(q=-1)]}, ["targets[0].q"]),
        ({"targets": [target(name="a"), target(name="a")]}, ["targets[1].name", "'a' is used twice"]),
    ],
)
def test_what_is_wrong_with_a_scenario_is_told_in_one_line(
    changes: dict[str, Any], words: list[str], tmp_path: Path
) -> None:
    line = refusal(content(**changes), tmp_path)
    for word in words:
        assert word in line, line


@pytest.mark.parametrize(
    ("text", "word"),
    [("", "missing"), ("- 1\n", "pairs"), ("area: [\n", "YAML"), ("just text", "pairs"), ("\0", "YAML")],
)
def test_files_that_are_no_scenario_are_refused(text: str, word: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=word):
        read_scenario(path)
    with pytest.raises(InputError, match="cannot read"):
        read_scenario(tmp_path)
    with pytest.raises(InputError, match="cannot read"):
        read_scenario(tmp_path / "missing.yaml")


def test_the_default_scenario_is_the_example() -> None:
    examples = ROOT / "examples" / "scenarios"
    shipped = ROOT / "src" / "vedette" / "missions" / "scenarios" / "track.yaml"
    assert (examples / "track.yaml").read_bytes() == shipped.read_bytes()
    assert read_scenario(shipped) == default_scenario()
    for path in examples.glob("track*.yaml"):
        read_scenario(path)


def test_names_are_given_where_there_are_none_and_true_states_come_from_the_prior() -> None:
    of = scenario()
    assert of.vehicle_names == ["vehicle-1", "vehicle-2", "vehicle-3"]
    assert of.target_names == ["target-1", "target-2", "target-3"]
    drawn = np.array([of.draw(np.random.default_rng(seed)) for seed in range(2000)])
    np.testing.assert_allclose(drawn.mean(axis=0)[0], [140, 80, 3, 1], atol=1.5)
    np.testing.assert_allclose(drawn.std(axis=0)[0], [20, 20, 1, 1], rtol=0.06)
    assert (drawn[:, 2, 2:] == 0.0).all()


def test_a_true_start_may_be_given_and_changes_nothing_for_the_others() -> None:
    plain = content()
    plain["targets"][1]["start"] = [50, 190, 0, 0]
    given = checked(as_scenario(plain, TrackScenario, "test"), "test").draw(np.random.default_rng(1))
    free = scenario().draw(np.random.default_rng(1))
    assert given[1].tolist() == [50, 190, 0, 0]
    assert (given[[0, 2]] == free[[0, 2]]).all()


def test_a_target_that_goes_out_of_every_picture_is_told(tmp_path: Path) -> None:
    path = tmp_path / "far.yaml"
    path.write_text(yaml.safe_dump(content(targets=[target(mean=[10, 10, 600, 0])], duration=120)))
    with pytest.warns(InputWarning, match=r"targets\[0\]: at 600 m/s it is 7\d{4} m outside the area when"):
        read_scenario(path)
