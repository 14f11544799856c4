"""Scenario files: what is right is read, and every mistake is one line that names field, value and remedy."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import msgspec
import pytest

from vedette.errors import InputError
from vedette.scenario import load_scenario


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
    "vehicles: []": "vehicles: expected `array` of length >= 1; it is []",
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
    "vehicles: [{start: [1, 2, 3]}]": (
        "vehicles[0].start: expected `array` of length 2, got 3; it is [1, 2, 3]"
    ),
    "vehicles: [{start: [1, .nan]}]": "vehicles[0].start[1]: must be a finite number; got nan",
    "vehicles: [{start: [1, 2], sensor: {type: range, noise: -1}}]": (
        "vehicles[0].sensor.noise: expected `float` > 0.0; it is -1"
    ),
    "vehicles: [{start: [a, 2]}]": "vehicles[0].start[0]: expected `float`, got `str`; it is 'a'",
    "": "object missing required field `vehicles`",
    "[1, 2]": "must be 'field: value' pairs; got [1, 2]",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_a_mistake_is_told_with_its_place_and_remedy(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError) as caught:
        load(tmp_path, text)
    assert str(caught.value) == f"{tmp_path / 'scene.yaml'}: {MISTAKES[text]}"


def test_a_file_that_is_missing_or_no_yaml_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot read scenario .*none.yaml: No such file"):
        load_scenario(tmp_path / "none.yaml", Scene)
    with pytest.raises(InputError, match=r"scene.yaml, line 1: not valid YAML"):
        load(tmp_path, "vehicles: [")
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"bytes.yaml: not a YAML text"):
        load_scenario(tmp_path / "bytes.yaml", Scene)
