"""Scenario files: what is right is read, and every mistake is one line that names field, value and remedy."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
import pytest

from vedette.errors import InputError
from vedette.maps import read_map
from vedette.missions.search.case import read_case
from vedette.missions.search.scenario import SearchScenario
from vedette.missions.track.scenario import TrackScenario, read_scenario
from vedette.net.config import AgentConfig, load_config
from vedette.scenario import as_scenario, load_scenario
from vedette.sim.faults import Schedule, load_faults
from vedette.study.spec import Spec, load_spec
from vedette.team import PlatformSpec, load_team


class Bearing(msgspec.Struct, tag="bearing", tag_field="type", forbid_unknown_fields=True, frozen=True):
    noise: Annotated[float, msgspec.Meta(gt=0, le=3)] = 1.0


class Range(msgspec.Struct, tag="range", tag_field="type", forbid_unknown_fields=True, frozen=True):
    noise: Annotated[float, msgspec.Meta(gt=0)] = 1.0
    reach: float = 9.0


class Vehicle(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    start: tuple[float, float]
    sensor: Bearing | Range = Bearing()
    paint: Literal["red", "green"] = "red"


class Scene(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    vehicles: Annotated[list[Vehicle], msgspec.Meta(min_length=1)]


def load(tmp_path: Path, text: str) -> Scene:
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    return load_scenario(path, Scene)


def test_what_is_left_out_has_its_default_and_numbers_may_have_exponents(tmp_path: Path) -> None:
    scene = load(
        tmp_path, "vehicles: [{start: [1, -2e1], sensor: {type: range, noise: 5e-2}}, {start: [0, 0]}]"
    )
    assert scene == Scene([Vehicle((1.0, -20.0), Range(0.05)), Vehicle((0.0, 0.0))])


MISTAKES = {
    "vehicles: []": "vehicles: must be a list of 1 or more entries; got []",
    "vehicles: [{start: [1, 2], sensor: {type: bering}}]": (
        "vehicles[0].sensor.type: unknown type 'bering'; did you mean 'bearing'?"
    ),
    "vehicles: [{start: [1, 2], sensro: 3}]": ("vehicles[0]: unknown field 'sensro'; did you mean 'sensor'?"),
    "vehicles: [{start: [1, 2], sensor: {type: range, raech: 3}}]": (
        "vehicles[0].sensor: unknown field 'raech'; did you mean 'reach'?"
    ),
    "vehicles: [{start: [1, 2], paint: grene}]": (
        "vehicles[0].paint: unknown paint 'grene'; did you mean 'green'?"
    ),
    "vehicles: [{start: [1, 2, 3]}]": "vehicles[0].start: must be a list of 2 numbers; got [1, 2, 3]",
    "vehicles: [{start: [1, .nan]}]": "vehicles[0].start[1]: must be a finite number; got nan",
    "vehicles: [{start: [1, 2], sensor: {type: range, noise: -1}}]": (
        "vehicles[0].sensor.noise: must be a number > 0; got -1"
    ),
    "vehicles: [{start: [a, 2]}]": "vehicles[0].start[0]: must be a number; got 'a'",
    "": "vehicles is missing; add it, a list of 1 or more entries",
    "[1, 2]": "must be 'field: value' pairs; got [1, 2]",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_a_mistake_is_told_with_its_place_and_remedy(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError) as caught:
        load(tmp_path, text)
    assert str(caught.value) == f"{tmp_path / 'scene.yaml'}: {MISTAKES[text]}"


MISSIONS = {
    "map": "image: map.pgm\nresolution: 0.1",
    "team file": "platforms: [{}]",
    "robot's file": "team: office\nrobot: 1",
    "tracking scenario": "area: [0, 0, 9, 9]\nvehicles: []\ntargets: []",
    "search scenario": "area: [0, 0, 9, 9]\nvehicles: []\nprior: []",
    "study's spec": "planners: [tours]",
    "fault schedule": "faults: [{at: 5, fault: heal}]",
}
READERS: dict[str, Callable[[Path], object]] = {
    "map": read_map,
    "team file": load_team,
    "robot's file": load_config,
    "tracking scenario": read_scenario,
    "search scenario": read_case,
    "study's spec": load_spec,
    "fault schedule": lambda path: load_faults(str(path), 3),
}


@pytest.mark.parametrize("given", MISSIONS)
@pytest.mark.parametrize("asked", READERS)
def test_a_file_in_anothers_place_is_called_by_its_name(tmp_path: Path, asked: str, given: str) -> None:
    path = tmp_path / "file.yaml"
    path.write_text(MISSIONS[given])
    line = f"{path} is a {given}, not a {asked}; it goes with: "
    if asked == given:
        with contextlib.suppress(InputError):
            READERS[asked](path)
    else:
        with pytest.raises(InputError, match=re.escape(line)):
            READERS[asked](path)


JARGON = re.compile(r"`|array|float|\bint\b|\bstr\b|null|object|length|None|regex|RFC")
KINDS = {"robot.yaml": AgentConfig, "spec.yaml": Spec, "faults.yaml": Schedule, "track.yaml": TrackScenario}
KINDS |= {"search.yaml": SearchScenario, "robots.yaml": PlatformSpec}
WRONG = (None, True, -1e300, "", "word", [], [None], [[1, "x"]], {}, {"model": 3}, 10**400, ["x"] * 2000)


@pytest.mark.parametrize("name", KINDS)
def test_no_message_about_a_field_speaks_of_the_types_of_a_program(name: str) -> None:
    kind: type[Any] = KINDS[name]
    required = {field.name: {} for field in msgspec.inspect.type_info(kind).fields if field.required}
    told: list[str] = []
    for field in msgspec.inspect.type_info(kind).fields:
        for value in WRONG:
            try:
                as_scenario({**required, field.encode_name: value}, kind, name)
            except InputError as error:
                told.append(str(error).split("; got ")[0])
    assert len(told) >= len(WRONG) - 1
    assert [line for line in told if JARGON.search(line) or not line.startswith(f"{name}: ")] == []


def test_a_file_that_is_missing_or_no_yaml_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot read scenario .*none.yaml: No such file"):
        load_scenario(tmp_path / "none.yaml", Scene)
    with pytest.raises(InputError, match=r"scene.yaml, line 1: not valid YAML"):
        load(tmp_path, "vehicles: [")
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"bytes.yaml: not a YAML text"):
        load_scenario(tmp_path / "bytes.yaml", Scene)
