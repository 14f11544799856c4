"""YAML files are read as plain data, within bounds, or refused in one line that names file and line."""

from __future__ import annotations

import os
import socket
from pathlib import Path
from typing import Any

import pytest
import yaml

from vedette.errors import InputError
from vedette.yaml_file import read_yaml


def read(folder: Path, text: str) -> Any:
    path = folder / "thing.yaml"
    path.write_text(text, encoding="utf-8")
    return read_yaml(path, "thing", "a thing is a list")


def test_numbers_with_exponents_are_numbers_and_quoted_ones_are_text(tmp_path: Path) -> None:
    assert read(tmp_path, "[5e-2, -2e1, 1.5E+3, .5e1, 3, 0.5]") == [0.05, -20.0, 1500.0, 5.0, 3, 0.5]
    assert read(tmp_path, "['5e-2', e5, 5e]") == ["5e-2", "e5", "5e"]
    assert read(tmp_path, "") is None
    assert read(tmp_path, "größe: '\U0001f916'") == {"größe": "\U0001f916"}


def test_what_is_referred_to_is_what_stands_there(tmp_path: Path) -> None:
    assert read(tmp_path, "a: &x [1, {b: 2}]\nc: [*x, *x]") == {
        "a": [1, {"b": 2}],
        "c": [[1, {"b": 2}], [1, {"b": 2}]],
    }
    assert read(tmp_path, "- &x {a: 1, b: 2}\n- {<<: *x, b: 3}") == [{"a": 1, "b": 2}, {"a": 1, "b": 3}]
    many = [[0.0] * 90] * 1000
    assert read(tmp_path, yaml.safe_dump(many)) == many


LAUGHS = "- &l0 [1]\n" + "".join(f"- &l{k + 1} [{', '.join([f'*l{k}'] * 10)}]\n" for k in range(9))
MERGED = "- &l0 {a: 1}\n" + "".join(f"- &l{k + 1} {{<<: [{', '.join([f'*l{k}'] * 10)}]}}\n" for k in range(9))
REFUSED = {
    "a: &a [*a]": "line 1: '*a' stands for something that holds it; write it out",
    "a: &a\n  b: [1, {c: *a}]": "line 2: '*a' stands for something that holds it; write it out",
    "&a {<<: *a}": "line 1: '*a' stands for something that holds it; write it out",
    "a: *b": "line 1: not valid YAML, found undefined alias 'b'; a thing is a list",
    LAUGHS: "line 6: references such as '*l4' stand for more than 100000 values; use fewer",
    MERGED: "line 6: references such as '*l4' stand for more than 100000 values; use fewer",
    'a:\n- "\\ud800"': "line 2: '\\ud800' holds half a character; write the whole",
    "a: [": "line 1: not valid YAML, expected the node content, but found '<stream end>'; a thing is a list",
    "a: !ros/time x": "line 1: not valid YAML, could not determine a constructor for the tag '!ros/time'; "
    "a thing is a list",
    "a: 1\n---\na: 2": "line 2: a second document begins here; keep one",
    "{[1]: 2}": "line 1: not valid YAML, found unhashable key; a thing is a list",
    "a: 1\nb: 2\na: 3": "line 3: 'a' is given twice, first in line 1; keep one",
    "- {a: 1, b: {c: 1, 'c': 2}}": "line 1: 'c' is given twice, first in line 1; keep one",
    "a: &x {b: 1}\nc:\n  <<: *x\n  <<: *x": "line 4: '<<' is given twice, first in line 3; keep one",
    "[" * 5000: "not a YAML text; a thing is a list",
    "9" * 5000: "not a YAML text; a thing is a list",
    "# " + "x" * 1_000_000: "more than 1000000 characters; a thing is a list",
}


@pytest.mark.parametrize("text", REFUSED, ids=range(len(REFUSED)))
def test_what_is_refused_is_told_in_one_line(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    told = str(caught.value).removeprefix(str(tmp_path / "thing.yaml")).lstrip(":, ")
    assert told == REFUSED[text]


def test_a_key_may_override_what_is_merged(tmp_path: Path) -> None:
    """A mapping that merges is itself merged, before and after it is read."""
    text = "a: &a {x: 1, y: 1}\nb: &b {<<: *a, x: 2}\nc: {<<: *b, y: 3}\nd: {<<: [*a, *b], z: 4}"
    assert read(tmp_path, text) == {
        "a": {"x": 1, "y": 1},
        "b": {"x": 2, "y": 1},
        "c": {"x": 2, "y": 3},
        "d": {"x": 1, "y": 1, "z": 4},
    }


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_text_is_read_in_the_encodings_that_editors_write(tmp_path: Path, encoding: str) -> None:
    (tmp_path / "thing.yaml").write_bytes("größe: ['é', ÿ]  # ½".encode(encoding))
    assert read_yaml(tmp_path / "thing.yaml", "thing", "") == {"größe": ["é", "ÿ"]}


def test_a_socket_and_a_device_are_refused_at_once(tmp_path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(tmp_path / "s"))
        with pytest.raises(InputError, match="it is a socket; give a file"):
            read_yaml(tmp_path / "s", "thing", "")
    with pytest.raises(InputError, match="cannot read thing /dev/zero: it is a device; give a file"):
        read_yaml(Path("/dev/zero"), "thing", "")


def test_what_cannot_be_read_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot read thing .*gone.yaml: No such file"):
        read_yaml(tmp_path / "gone.yaml", "thing", "")
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match=r"cannot read thing .*pipe: it is a pipe; give a file"):
        read_yaml(tmp_path / "pipe", "thing", "")
    (tmp_path / "noise").write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match=r"noise: not a YAML text; a thing is a list"):
        read_yaml(tmp_path / "noise", "thing", "a thing is a list")
