"""Maps come in and go out as ROS map_server has them; everything else is one clear line."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from PIL import Image

from vedette.errors import InputError, InputWarning
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame, read_map, write_map

U, F, X = UNKNOWN, FREE, OCCUPIED
pytestmark = pytest.mark.filterwarnings("ignore::vedette.errors.InputWarning")


def pair(folder: Path, pixels: np.ndarray, suffix: str = ".png", **fields: object) -> Path:
    """Write an image and its .yaml; ``None`` leaves a field out."""
    Image.fromarray(pixels).save(folder / f"map{suffix}")
    values = {
        "image": f"map{suffix}",
        "resolution": 0.05,
        "origin": "[-1.0, 2.0, 0.0]",
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
    } | fields
    path = folder / "map.yaml"
    path.write_text("".join(f"{key}: {value}\n" for key, value in values.items() if value is not None))
    return path


@given(
    classes=hnp.arrays(np.uint8, hnp.array_shapes(min_dims=2, max_dims=2), elements=st.integers(0, 2)),
    resolution=st.floats(0.005, 10),
    origin=st.tuples(st.floats(-2e7, 2e7), st.floats(-2e7, 2e7)),
    mode=st.sampled_from(["trinary", "raw"]),
)
@settings(deadline=None, max_examples=50)
def test_what_is_written_is_read_back_exactly(
    tmp_path_factory: pytest.TempPathFactory,
    classes: np.ndarray,
    resolution: float,
    origin: tuple[float, float],
    mode: str,
) -> None:
    rows, cols = classes.shape
    frame = GridFrame(resolution, rows, cols, *origin)
    stem = tmp_path_factory.mktemp("maps") / "a: 'strange' name"
    write_map(stem, frame, classes, mode)
    again, read = read_map(f"{stem}.yaml")
    assert again == frame
    np.testing.assert_array_equal(read, classes)


def test_the_written_pair_is_map_savers_with_the_top_row_first(tmp_path: Path) -> None:
    write_map(tmp_path / "m", GridFrame(0.05, 2, 3, -1.5, 0.25), np.array([[U, F, X], [X, X, F]], np.uint8))
    assert (tmp_path / "m.pgm").read_bytes() == b"P5\n3 2\n255\n" + bytes([0, 0, 254, 205, 254, 0])
    text = (tmp_path / "m.yaml").read_text()
    assert 'image: "m.pgm"\nmode: trinary\nresolution: 0.05\norigin: [-1.5, 0.25, 0.0]\nnegate: 0\n' in text
    assert sorted(path.name for path in tmp_path.iterdir()) == ["m.pgm", "m.yaml"]


def as_nav2(pixel: int, mode: str, negate: bool, occupied: float, free: float) -> int:
    """Class a grey level as Nav2's map_io does since 2025, one pixel at a time, all in float32."""
    if mode == "raw":
        occ = np.float32(pixel / 100) if pixel <= 100 else np.float32(np.nan)
    else:
        occ = np.float32(pixel) / np.float32(255)
        occ = occ if negate else np.float32(1) - occ
    return F if occ <= np.float32(free) else X if occ >= np.float32(occupied) else U


@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
@pytest.mark.parametrize("negate", [0, 1])
@pytest.mark.parametrize(
    ("occupied", "free"), [(0.65, 0.196), (0.45, 0.3), (0.9, 0.5), (0.6, 0.2), (1.0, 0.0)]
)
def test_every_grey_level_is_classed_as_nav2_does(
    tmp_path: Path, mode: str, negate: int, occupied: float, free: float
) -> None:
    levels = np.arange(256, dtype=np.uint8).reshape(16, 16)
    fields = {"mode": mode, "negate": negate, "occupied_thresh": occupied, "free_thresh": free}
    expected = [[as_nav2(int(p), mode, bool(negate), occupied, free) for p in row] for row in levels[::-1]]
    np.testing.assert_array_equal(read_map(pair(tmp_path, levels, ".pgm", **fields))[1], expected)


def test_a_level_that_is_just_a_threshold_is_free_or_occupied(tmp_path: Path) -> None:
    pixels = np.array([[255, 254, 1, 0]], np.uint8)
    assert read_map(pair(tmp_path, pixels, free_thresh=0, occupied_thresh=1))[1].tolist() == [[F, U, U, X]]


def with_alpha(grey: np.ndarray, opacity: int) -> Iterator[np.ndarray]:
    """The same levels as grey with alpha and as colour with alpha."""
    alpha = np.full_like(grey, opacity)
    yield np.stack([grey, alpha], axis=-1)
    yield np.stack([grey, grey, grey, alpha], axis=-1)


@pytest.mark.parametrize("negate", [0, 1])
@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
def test_an_opaque_alpha_channel_changes_nothing_and_what_is_not_opaque_is_unknown(
    tmp_path: Path, mode: str, negate: int
) -> None:
    grey = np.arange(256, dtype=np.uint8).reshape(16, 16)
    plain = read_map(pair(tmp_path, grey, mode=mode, negate=negate))[1]
    assert {F, X, U} == set(plain.ravel())
    for pixels in with_alpha(grey, 255):
        np.testing.assert_array_equal(read_map(pair(tmp_path, pixels, mode=mode, negate=negate))[1], plain)
    for opacity in (0, 128, 254):
        for pixels in with_alpha(grey, opacity):
            assert not read_map(pair(tmp_path, pixels, mode=mode, negate=negate))[1].any()


def test_a_level_that_a_png_declares_transparent_is_unknown(tmp_path: Path) -> None:
    for name, pixels, clear in (
        ("wide", np.array([[0, 52685, 65535]], np.uint16), 52685),
        ("grey", np.array([[0, 205, 255]], np.uint8), 205),
        ("colour", np.array([[[0, 0, 0], [9, 8, 7], [255, 255, 255]]], np.uint8), (9, 8, 7)),
    ):
        path = pair(tmp_path, np.zeros((1, 1), np.uint8), image=f"{name}.png", free_thresh=0.3)
        Image.fromarray(pixels).save(tmp_path / f"{name}.png", transparency=clear)
        assert read_map(path)[1].tolist() == [[X, U, F]], name


@pytest.mark.parametrize(
    ("colour", "luma"),
    [((255, 0, 0), 76), ((0, 255, 0), 149), ((0, 0, 255), 29), ((255, 255, 0), 225), ((200, 150, 7), 148)],
)
def test_a_colour_counts_as_its_luma(tmp_path: Path, colour: tuple[int, int, int], luma: int) -> None:
    """0.299 R + 0.587 G + 0.114 B, cut to a whole level."""
    assert math.floor(0.299 * colour[0] + 0.587 * colour[1] + 0.114 * colour[2]) == luma
    for level, expected in ((luma, F), (luma + 1, U)):
        free = float(np.float32(1) - np.float32(level) / np.float32(255))
        path = pair(tmp_path, np.array([[colour]], np.uint8), free_thresh=free, occupied_thresh=1)
        assert read_map(path)[1].tolist() == [[expected]]


def test_raw_pixels_are_percent_and_above_100_unknown(tmp_path: Path) -> None:
    pixels = np.array([[0, 19, 20, 64, 65, 100, 101, 255]], np.uint8)
    assert read_map(pair(tmp_path, pixels, mode="raw"))[1].tolist() == [[F, F, U, U, X, X, U, U]]


@pytest.mark.parametrize(
    ("level", "negate", "free", "remedy"),
    [
        (205, 0, 0.25, 0.196),
        (206, 0, 0.196, 0.192),
        (128, 0, 0.6, 0.498),
        (127, 0, 0.6, 0.501),
        (255 - 205, 1, 0.25, 0.196),
    ],
)
def test_grey_that_savers_write_for_unknown_is_told_where_it_is_free(
    tmp_path: Path, level: int, negate: int, free: float, remedy: float
) -> None:
    light = 0 if negate else 254
    pixels = np.array([[level, level, 100], [light, level, 255 - light]], np.uint8)
    fields = {"negate": negate, "free_thresh": free}
    path = pair(tmp_path, pixels, **fields)
    with pytest.warns(InputWarning) as told:
        classes = read_map(path)[1]
    assert (classes == FREE).sum() == 4
    assert [str(line.message) for line in told] == [
        f"{path}: free_thresh {free} makes grey {level} (3 pixels) free, which map savers write for unknown; "
        f"if it is unknown, set free_thresh to {remedy}"
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert (read_map(pair(tmp_path, pixels, **fields | {"free_thresh": remedy}))[1] == FREE).sum() == 1


def test_a_plain_image_with_such_grey_is_told_too(tmp_path: Path) -> None:
    Image.fromarray(np.array([[0, 206, 254], [205, 206, 254]], np.uint8)).save(tmp_path / "m.png")
    told = r"m\.png: .* grey 205 \(1 pixel\) and grey 206 \(2 pixels\) too, .* 'free_thresh: 0\.192'"
    with pytest.warns(InputWarning, match=told):
        assert read_map(tmp_path / "m.png", 0.1)[1].tolist() == [[F, F, F], [X, F, F]]


def test_grey_that_is_all_the_free_there_is_or_a_soft_edge_is_not_worth_a_word(tmp_path: Path) -> None:
    pixels = np.full((50, 50), 254, np.uint8)
    pixels[0, :2] = 205, 128
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_map(pair(tmp_path, np.array([[205, 205, 0]], np.uint8), free_thresh=0.25))
        read_map(pair(tmp_path, pixels, free_thresh=0.6))


def test_sixteen_bit_and_ascii_images_are_read(tmp_path: Path) -> None:
    wide = np.array([[0, 32895, 32896, 65535]], np.uint16)
    Image.fromarray(wide).save(tmp_path / "wide.png")
    (tmp_path / "wide.pgm").write_bytes(b"P5\n4 1\n65535\n" + wide.astype(">u2").tobytes())
    (tmp_path / "ascii.pgm").write_bytes(b"P2\n# comment\n4 1\n15\n0 7 8 15\n")
    for name in ("wide.png", "wide.pgm", "ascii.pgm"):
        assert read_map(tmp_path / name, 0.1)[1].tolist() == [[X, X, F, F]], name


def test_a_plain_image_is_free_from_128_and_unknown_where_transparent(tmp_path: Path) -> None:
    Image.fromarray(np.array([[127, 128, 0, 255]], np.uint8)).save(tmp_path / "grey.png")
    colours = np.array([[[255, 255, 0, 255], [255, 0, 0, 255], [255, 255, 255, 0]]], np.uint8)
    Image.fromarray(colours).save(tmp_path / "colour.png")
    Image.fromarray(np.array([[0, 255]], np.uint8)).convert("1").save(tmp_path / "bits.png")
    Image.fromarray(np.array([[0, 255]], np.uint8)).convert("P").save(tmp_path / "palette.png")
    frame, classes = read_map(tmp_path / "grey.png", 0.1)
    assert frame == GridFrame(0.1, 1, 4)
    assert classes.tolist() == [[X, F, X, F]]
    assert read_map(tmp_path / "colour.png", 0.1)[1].tolist() == [[F, X, U]]
    assert read_map(tmp_path / "bits.png", 0.1)[1].tolist() == [[X, F]]
    assert read_map(tmp_path / "palette.png", 0.1)[1].tolist() == [[X, F]]


def test_the_argument_overrides_the_pairs_resolution_and_exponents_are_numbers(tmp_path: Path) -> None:
    white = np.full((2, 2), 255, np.uint8)
    assert read_map(pair(tmp_path, white), 0.2)[0].resolution == 0.2
    assert read_map(pair(tmp_path, white, resolution="5e-2"))[0] == GridFrame(0.05, 2, 2, -1.0, 2.0)
    assert read_map(pair(tmp_path, white, resolution=None), 0.2)[0].resolution == 0.2


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"resolution": None}, "--resolution"),
        ({"resolution": 0}, "resolution must be 0.005 to 10 m per pixel; got 0"),
        ({"resolution": -0.1}, "got -0.1"),
        ({"resolution": ".nan"}, "got .nan"),
        ({"resolution": 1000}, "got 1000"),
        ({"resolution": "fine"}, "got fine"),
        ({"resolution": "0,05"}, "got 0,05"),
        ({"resolution": "1_0"}, "got 1_0"),
        ({"resolution": "[0.1]"}, "got ['0.1']"),
        ({"resolution": "true"}, "got true"),
        ({"resolution": "1" * 400}, "resolution"),
        ({"origin": "[0]"}, "origin must be [x, y, yaw] [m, m, rad]; got ['0']"),
        ({"origin": "[.inf, 0, 0]"}, "origin must be"),
        ({"origin": "[0, 0, .nan]"}, "origin must be"),
        ({"origin": "[0, 0, [0]]"}, "origin must be"),
        ({"origin": "middle"}, "origin must be"),
        ({"origin": "[0, 3e7, 0]"}, "origin must be within 20000000 m of 0, 0; got 0, 30000000; move it"),
        ({"negate": 2}, "negate must be 0 or 1; got 2"),
        ({"negate": "maybe"}, "negate must be 0 or 1; got maybe"),
        ({"mode": "Trinity"}, "unknown mode 'trinity'; did you mean 'trinary'"),
        ({"mode": "[]"}, "unknown mode"),
        ({"occupied_thresh": 1.2}, "occupied_thresh must be 0 to 1; got 1.2"),
        ({"occupied_thresh": "65%"}, "occupied_thresh must be 0 to 1; got 65%"),
        ({"free_thresh": ".nan"}, "free_thresh must be 0 to 1"),
        ({"free_thresh": 0.7}, "free_thresh must be occupied_thresh at most; got 0.7 and 0.65"),
        ({"image": None}, "no 'image: FILE'"),
        ({"image": "[a, b]"}, "no 'image: FILE'"),
        ({"image": "''"}, "no 'image: FILE'"),
        ({"image": 3}, "/3: No such file"),
        ({"image": "gone.png"}, "gone.png: No such file"),
        ({"image": "."}, "Is a directory"),
        ({"image": '"a\\0b"'}, "image a\\x00b cannot be the name of a file"),
        ({"image": '"a\\nb"'}, "image a\\nb cannot be the name of a file"),
        ({"image": "map.yaml"}, "not a map"),
        (
            {"resolution": "0.05\nresolution: 0.1"},
            "line 3: 'resolution' is given twice, first in line 2; keep one",
        ),
    ],
)
def test_a_bad_pair_is_one_clear_line(tmp_path: Path, fields: dict[str, Any], message: str) -> None:
    path = pair(tmp_path, np.full((2, 2), 255, np.uint8), **fields)
    with pytest.raises(InputError) as caught:
        read_map(path)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("gone.png", None, "No such file"),
        ("gone.yaml", None, "No such file"),
        ("empty.png", b"", "empty"),
        ("empty.yaml", b"", "not a map"),
        ("text.png", b"no image", "not a map"),
        ("noise.yaml", bytes(range(256)), "not a YAML text"),
        ("list.yaml", b"- a\n- b\n", "not a map"),
        ("open.yaml", b"image: [", "line 1: not valid YAML"),
        ("deep.yaml", b"[" * 500, "not a YAML text"),
        ("half.pgm", b"P5\n100 100\n255\nabc", "damaged"),
        ("none.pgm", b"P5\n0 0\n255\n", "map"),
        ("wide.pgm", b"P5\n8001 1\n255\n", "at most 8000 pixels"),
        ("bomb.pgm", b"P5\n99999 99999\n255\n", "at most 8000 pixels"),
    ],
)
def test_what_is_no_map_is_one_clear_line(
    tmp_path: Path, name: str, content: bytes | None, message: str
) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_map(tmp_path / name, 0.1)
    assert message in str(caught.value)
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_png_cut_anywhere_is_one_clear_line_or_still_whole(tmp_path: Path) -> None:
    path = tmp_path / "cut.png"
    pixels = np.arange(256, dtype=np.uint8).reshape(16, 16)
    Image.fromarray(pixels).save(path)
    whole = path.read_bytes()
    expected = np.where(pixels >= 128, F, X)[::-1]
    messages = []
    for length in range(1, len(whole), 3):
        path.write_bytes(whole[:length])
        try:
            np.testing.assert_array_equal(read_map(path, 0.1)[1], expected)
        except InputError as error:
            messages.append(str(error))
    assert len(messages) > len(whole) / 3 / 2
    assert all(str(path) in message for message in messages)


@pytest.mark.parametrize("name", ["map.yaml", "map.pgm"])
def test_what_reading_would_wait_for_is_refused_at_once(tmp_path: Path, name: str) -> None:
    path = pair(tmp_path, np.full((2, 2), 255, np.uint8), ".pgm")
    (tmp_path / name).unlink()
    os.mkfifo(tmp_path / name)
    with pytest.raises(InputError, match=rf"cannot read map .*{name}: it is a pipe; give a file"):
        read_map(path)


def test_a_folder_is_refused_and_a_plain_image_points_to_its_pair(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a folder; give a map's"):
        read_map(tmp_path)
    pair(tmp_path, np.full((2, 2), 255, np.uint8))
    with pytest.raises(InputError, match=rf"is a folder; give {tmp_path}/map\.yaml"):
        read_map(tmp_path)
    with pytest.raises(InputError, match=r"give map\.yaml instead"):
        read_map(tmp_path / "map.png")
    for resolution in (0.0, -1.0, float("nan"), 1e9):
        with pytest.raises(InputError, match="--resolution must be"):
            read_map(tmp_path / "map.png", resolution)


def test_a_map_of_4000_by_4000_is_read_and_written_without_a_warning(tmp_path: Path) -> None:
    classes = np.full((4000, 4000), FREE, np.uint8)
    classes[0] = OCCUPIED
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        write_map(tmp_path / "big", GridFrame(0.05, 4000, 4000), classes)
        read = read_map(tmp_path / "big.yaml")[1]
    np.testing.assert_array_equal(read, classes)


def test_an_unknown_mode_and_an_unwritable_folder_are_bad_input(tmp_path: Path) -> None:
    frame, classes = GridFrame(0.1, 1, 1), np.zeros((1, 1), np.uint8)
    with pytest.raises(InputError, match="did you mean 'trinary'"):
        write_map(tmp_path / "m", frame, classes, "trinery")
    with pytest.raises(InputError, match="cannot write"):
        write_map(tmp_path / "no" / "m", frame, classes)
