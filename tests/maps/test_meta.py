"""A map's .yaml is taken as map_server takes it, for which yaml-cpp looks at the text of a value alone."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from vedette.errors import InputError, InputWarning
from vedette.maps.meta import MapMeta, read_meta

PLAIN = """image: room.pgm
resolution: 0.05
origin: [-1.5, 2.0, 0.25]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def meta(folder: Path, text: str | bytes) -> MapMeta:
    path = folder / "room.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_meta(path)


def changed(old: str, new: str) -> str:
    assert old in PLAIN
    return PLAIN.replace(old, new)


@pytest.mark.parametrize(
    "text",
    [
        changed("0.05", '"0.05"'),
        changed("[-1.5, 2.0, 0.25]", "['-1.5', \"2.0\", '+.25e0']"),
        changed("origin: [-1.5, 2.0, 0.25]", "origin:\n- -1.5\n- 2.\n- 25e-2"),
        changed("negate: 0", 'negate: "0"'),
        changed("negate: 0", "negate: No"),
        changed("negate: 0", "negate: FALSE"),
        changed("0.65", "'0.65'"),
        changed("0.196", "!!str 0.196"),
        PLAIN + "mode: Trinary\n",
        PLAIN + "mode: 'TRINARY'\n",
        PLAIN + "stamp: !ros/time {secs: 1}\n",
        PLAIN + "who: !me [1, 2]\n",
        PLAIN + "count: !!int many\n",
        PLAIN + "---\nimage: other.pgm\n",
        PLAIN + "...\n--- [\n",
        "%YAML 1.1\n---\n" + PLAIN,
        PLAIN.replace("\n", "\r\n"),
        f"# café\n{PLAIN}".encode("latin-1"),
        f"# “café” – 5 €\n{PLAIN}".encode("cp1252"),
        f"# café\n{PLAIN}".encode("utf-8-sig"),
        f"# café\n{PLAIN}".encode("utf-16"),
        "base: &base {resolution: 0.05, negate: 0}\n"
        "image: room.pgm\n<<: *base\norigin: [-1.5, 2.0, 0.25]\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
    ],
)
def test_however_it_is_written_it_says_the_same(tmp_path: Path, text: str | bytes) -> None:
    assert meta(tmp_path, text) == meta(tmp_path, PLAIN)


@pytest.mark.parametrize(
    "name", ["2024.10", "0010", "yes", "null.pgm", "1e3", "2024-06-01", "12:30:00", "~a"]
)
def test_an_image_is_named_by_its_text_whatever_yaml_would_make_of_it(tmp_path: Path, name: str) -> None:
    assert meta(tmp_path, changed("room.pgm", name)).image == tmp_path / name


def test_what_may_be_left_out_may_be(tmp_path: Path) -> None:
    short = meta(tmp_path, "image: room.pgm\nresolution:\n")
    assert (short.resolution, short.origin, short.negate) == (None, (0.0, 0.0, 0.0), False)
    assert (short.free_thresh, short.occupied_thresh, short.mode) == (0.196, 0.65, "trinary")
    assert meta(tmp_path, changed("[-1.5, 2.0, 0.25]", "[3, 4]")).origin == (3.0, 4.0, 0.0)


@pytest.mark.parametrize("mode", ["scale", "Scale", "SCALE", "raw", "Raw", "RAW"])
@pytest.mark.parametrize("negate", ["1", "1.0", "true", "Yes", "ON"])
def test_modes_and_truth_are_read_in_any_case(tmp_path: Path, mode: str, negate: str) -> None:
    read = meta(tmp_path, changed("negate: 0", f"negate: {negate}") + f"mode: {mode}\n")
    assert (read.mode, read.negate) == (mode.lower(), True)


def test_equal_thresholds_leave_nothing_unknown_and_are_taken(tmp_path: Path) -> None:
    read = meta(tmp_path, changed("0.196", "0.65"))
    assert read.free_thresh == read.occupied_thresh == 0.65


def test_a_yaw_in_degrees_is_told(tmp_path: Path) -> None:
    told = r"room\.yaml: yaw 90 \[rad\] is beyond a whole turn; for 90 deg write 1\.5708"
    with pytest.warns(InputWarning, match=told):
        read = meta(tmp_path, changed("0.25]", "90]"))
    assert read.origin[2] == pytest.approx(90 - 14 * 2 * math.pi)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("image: a.pgm\nimage: b.pgm\n", "line 2: 'image' is given twice, first in line 1; keep one"),
        (
            changed("image: ", "image:\t"),
            "line 1: not valid YAML, found character '\\t' that cannot start any token",
        ),
        (
            changed("resolution: ", "resolution:"),
            "line 3: not valid YAML, could not find expected ':'",
        ),
        (changed("0.25]", "0.25"), "line 4: not valid YAML, expected ',' or ']'"),
    ],
)
def test_what_is_no_yaml_is_told_with_line_and_cause(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        meta(tmp_path, text)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
