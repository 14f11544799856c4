"""A team file lists platforms; every field has a default, every mistake one clear line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from vedette.errors import InputError
from vedette.team import PlatformSpec, load_team


def team(folder: Path, text: str) -> Path:
    path = folder / "team.yaml"
    path.write_text(text)
    return path


def test_every_field_has_a_default_and_names_count_from_one(tmp_path: Path) -> None:
    specs = load_team(team(tmp_path, "platforms:\n- {}\n-\n- {name: scout}\n"))
    assert specs == [PlatformSpec(), PlatformSpec(name="robot-2"), PlatformSpec(name="scout")]


def test_every_field_is_read_in_its_type(tmp_path: Path) -> None:
    path = team(
        tmp_path,
        "platforms:\n"
        "- {name: a.b_c-1, speed: 1, turn_rate: 2, radius: 3e-1, range: 12, view: 270, beams: 540,\n"
        "   rate: 10, range_noise: 0, start: [1, -2.5, 90]}\n"
        "- {start: [1, 2]}\n",
    )
    first, second = load_team(path)
    assert first == PlatformSpec("a.b_c-1", 1.0, 2.0, 0.3, 12.0, 270.0, 540, 10.0, 0.0, (1.0, -2.5, 90.0))
    assert isinstance(first.speed, float)
    assert isinstance(first.beams, int)
    assert second.start == (1.0, 2.0)


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("speeed: 1", "platform 2: unknown field 'speeed'; did you mean 'speed'?"),
        ("3: 1", "platform 2: unknown field 3"),
        ("speed: 0", "platform 2: speed must be 0.01 to 10 m/s; got 0"),
        ("speed: -1", "speed must be"),
        ("speed: .nan", "speed: must be a finite number; got nan"),
        ("speed: fast", "speed: must be a number; got 'fast'"),
        ("speed: true", "speed: must be a number; got true"),
        ("speed: null", "speed: must be a number; got nothing"),
        ("speed: [1]", "speed: must be a number; got [1]"),
        ("speed: " + "9" * 400, "speed: must be a number of at most 308 digits; got 99"),
        ("turn_rate: 100", "turn_rate must be"),
        ("radius: 6", "radius must be 0.02 to 5 m"),
        ("range: 0.1", "range must be 0.2 to 200 m"),
        ("view: 361", "view must be 1 to 360 deg"),
        ("beams: 7", "beams must be 8 to 4096"),
        ("beams: 9.5", "beams: must be a whole number; got 9.5"),
        ("rate: 0.1", "rate must be 0.2 to 50 Hz"),
        ("range_noise: 1.5", "range_noise must be 0 to 1 m"),
        ("name: robot-1", "platform 2: the name 'robot-1' is used twice"),
        ("name: 7", "name: must be text; got 7"),
        ("name: a/b", "name must be"),
        ("name: ''", "name must be"),
        ("start: 3", "start: must be a list of numbers; got 3"),
        ("start: [1]", "start must be [x, y] or [x, y, heading in deg]; got [1.0]"),
        ("start: [1, .inf]", "start[1]: must be a finite number; got inf"),
        ("start: [1, here]", "start[1]: must be a number; got 'here'"),
    ],
)
def test_a_bad_field_is_one_line_that_names_file_platform_and_field(
    tmp_path: Path, entry: str, message: str
) -> None:
    path = team(tmp_path, f"platforms:\n- {{}}\n- {{{entry}}}\n")
    with pytest.raises(InputError) as caught:
        load_team(path)
    assert message in str(caught.value)
    assert str(caught.value).startswith(f"{path}: platform 2: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a list under 'platforms:'"),
        ("platforms: []", "a list under 'platforms:' of at least one, for instance '- {}'"),
        ("platforms:", "a list under 'platforms:'"),
        ("{}", "a list under 'platforms:'"),
        ("platforms: {name: x}", "a list under 'platforms:'"),
        ("- {}", "a list under 'platforms:'"),
        (
            "robots: [{}]",
            "a list under 'platforms:' of at least one, for instance '- {}'; got {'robots': [{}]}",
        ),
        ("platform: [{}]", "a list under 'platforms:'"),
        ("platforms: [3]", "platform 1: must be 'field: value' pairs; got 3"),
        ("platforms:\n- {", "line 2: not valid YAML"),
        ("a\0b", "YAML"),
    ],
)
def test_what_is_no_team_is_one_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        load_team(team(tmp_path, text))
    assert message in str(caught.value)
    assert "team.yaml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_file_a_folder_and_a_binary_are_bad_input(tmp_path: Path) -> None:
    (tmp_path / "noise").write_bytes(bytes(range(256)))
    for name, said in (("gone.yaml", "No such file"), (".", "Is a directory"), ("noise", "not a YAML text")):
        with pytest.raises(InputError, match=said):
            load_team(tmp_path / name)


def test_a_spec_made_in_code_is_checked_too() -> None:
    with pytest.raises(InputError, match="radius must be"):
        replace(PlatformSpec(), radius=float("nan"))


@pytest.mark.parametrize(
    ("field", "line"),
    [
        ({"speed": "fast"}, "speed must be 0.01 to 10 m/s; got 'fast'"),
        ({"speed": True}, "speed must be 0.01 to 10 m/s; got True"),
        ({"range": float("nan")}, "range must be 0.2 to 200 m; got nan"),
        ({"beams": 9.5}, "beams must be a whole number; got 9.5"),
        ({"name": 7}, "name must be letters, digits, '-', '_' or '.', at most 64; got 7"),
        ({"start": 7}, "start must be [x, y] or [x, y, heading in deg]; got 7"),
        ({"start": (1.0, "2")}, "start must be [x, y] or [x, y, heading in deg]; got [1.0, '2']"),
    ],
)
def test_a_platform_made_in_python_is_checked_too(field: dict[str, Any], line: str) -> None:
    with pytest.raises(InputError) as refused:
        PlatformSpec(**field)
    assert str(refused.value) == line
