"""Rasters of numbers: whatever grey image, TIFF or array, its numbers and its place; errors of their own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image, TiffImagePlugin

from vedette.errors import InputError
from vedette.maps.raster import read_raster

GREY = np.random.default_rng(0).integers(0, 250, (12, 17)).astype(np.uint8)
NUMBERS = np.random.default_rng(1).random((12, 17)).astype(np.float32) * 7.0
Tags = dict[int, tuple[int, Any]]  # type and value, by tag
SCALE: tuple[int, Any] = (12, (10.0, 20.0, 0.0))
TIE: tuple[int, Any] = (12, (0.0, 0.0, 0.0, 500_000.0, 5_000_000.0, 0.0))
PLACE: Tags = {33550: SCALE, 33922: TIE}


def keys(**values: int) -> Tags:
    """Return the tag that says a model, a kind of raster and a unit."""
    numbers = {"model": 1024, "raster": 1025, "unit": 3076}
    words = [1, 1, 0, len(values)]
    for name, value in values.items():
        words += [numbers[name], 0, 1, value]
    return {34735: (3, tuple(words))}


def tiff(path: Path, values: NDArray[Any], tags: Tags | None = None, **how: Any) -> Path:
    """Write a TIFF with tags."""
    info = TiffImagePlugin.ImageFileDirectory_v2()
    for tag, (kind, value) in (tags or {}).items():
        info.tagtype[tag] = kind
        info[tag] = value
    Image.fromarray(values).save(path, tiffinfo=info, **how)
    return path


def raw_float64(path: Path, values: NDArray[np.float64]) -> Path:
    """Write a TIFF of 64-bit floats by hand: Pillow cannot."""
    rows, cols = values.shape
    entries = [
        (256, 3, 1, cols), (257, 3, 1, rows), (258, 3, 1, 64), (259, 3, 1, 1), (262, 3, 1, 1),
        (273, 4, 1, 8 + 2 + 10 * 12 + 4), (277, 3, 1, 1), (278, 3, 1, rows),
        (279, 4, 1, 8 * values.size), (339, 3, 1, 3),
    ]  # fmt: skip
    head = b"II*\0" + (8).to_bytes(4, "little") + len(entries).to_bytes(2, "little")
    for tag, kind, count, value in entries:
        head += tag.to_bytes(2, "little") + kind.to_bytes(2, "little") + count.to_bytes(4, "little")
        head += value.to_bytes(4, "little")
    path.write_bytes(head + bytes(4) + values.astype("<f8").tobytes())
    return path


@pytest.mark.parametrize("name", ["grey.png", "grey.pgm", "grey.bmp", "grey.tif"])
def test_grey_is_read_bottom_row_first(tmp_path: Path, name: str) -> None:
    Image.fromarray(GREY).save(tmp_path / name)
    raster = read_raster(tmp_path / name, "heat map")
    np.testing.assert_array_equal(raster.values, GREY[::-1])
    assert raster.extent is None


@pytest.mark.parametrize("how", [{}, {"compression": "tiff_lzw"}, {"compression": "tiff_adobe_deflate"}])
@pytest.mark.parametrize("kind", [np.float32, np.uint16, np.int32, np.uint8])
def test_a_tiff_of_any_numbers_keeps_them(tmp_path: Path, kind: type, how: dict[str, Any]) -> None:
    values = (NUMBERS if kind is np.float32 else NUMBERS * 30.0).astype(kind)
    raster = read_raster(tiff(tmp_path / "a.tif", values, **how), "heat map")
    np.testing.assert_array_equal(raster.values, values[::-1])


def test_a_tiff_of_64_bit_floats_and_an_array_keep_them(tmp_path: Path) -> None:
    values = NUMBERS.astype(np.float64)
    stored = read_raster(raw_float64(tmp_path / "a.tif", values), "heat map").values
    np.testing.assert_allclose(stored, values[::-1], rtol=1e-7)
    np.save(tmp_path / "a.npy", values)
    np.testing.assert_array_equal(read_raster(tmp_path / "a.npy", "heat map").values, values)  # rows go up


def test_channels_alike_are_grey_and_alpha_thins_it(tmp_path: Path) -> None:
    alpha = np.full_like(GREY, 255)
    alpha[:6] = 51
    Image.fromarray(np.dstack([GREY, GREY, GREY, alpha])).save(tmp_path / "a.png")
    expected = GREY * np.where(np.arange(12) < 6, 0.2, 1.0)[:, None]
    np.testing.assert_allclose(read_raster(tmp_path / "a.png", "heat map").values, expected[::-1])
    Image.fromarray(np.dstack([GREY] * 3)).save(tmp_path / "a.jpg", quality=60)
    assert np.abs(read_raster(tmp_path / "a.jpg", "heat map").values - GREY[::-1]).mean() < 40.0


def test_what_has_no_data_counts_as_nothing(tmp_path: Path) -> None:
    values = NUMBERS.copy()
    values[2, 3], values[4, 5] = -9999.0, np.nan
    expected = np.where(values > 0.0, values, 0.0)
    path = tiff(tmp_path / "a.tif", values, {42113: (2, "-9999")})
    np.testing.assert_array_equal(read_raster(path, "heat map").values, expected[::-1])


@pytest.mark.parametrize(
    ("tags", "extent"),
    [
        (PLACE, (500_000.0, 4_999_760.0, 500_170.0, 5_000_000.0)),
        (PLACE | keys(model=1, raster=1, unit=9001), (500_000.0, 4_999_760.0, 500_170.0, 5_000_000.0)),
        (PLACE | keys(model=1, raster=2), (499_995.0, 4_999_770.0, 500_165.0, 5_000_010.0)),
        ({33550: SCALE, 33922: (12, (2.0, 3.0, 0.0, 0.0, 0.0, 0.0))}, (-20.0, -180.0, 150.0, 60.0)),
        (
            {34264: (12, (5.0, 0.0, 0.0, 100.0, 0.0, -5.0, 0.0, 200.0, *(0.0,) * 7, 1.0))},
            (100.0, 140.0, 185.0, 200.0),
        ),
    ],
)
def test_a_geotiff_lies_where_its_tags_say(tmp_path: Path, tags: Tags, extent: tuple[float, ...]) -> None:
    assert read_raster(tiff(tmp_path / "a.tif", NUMBERS, tags), "heat map").extent == extent


def colours(path: Path) -> None:
    Image.fromarray(np.dstack([GREY, GREY[::-1], GREY])).save(path)


def palette(path: Path) -> None:
    image = Image.fromarray(GREY).convert("P")
    image.putpalette([value for level in range(256) for value in (level, 255 - level, 9)])
    image.save(path)


TURNED: Tags = {34264: (12, (5.0, 1.0, 0.0, 0.0, 1.0, -5.0, 0.0, 0.0, *(0.0,) * 7, 1.0))}


@pytest.mark.parametrize(
    ("name", "write", "words"),
    [
        ("a.png", colours, "has colours"),
        ("a.tif", colours, "has colours"),
        ("a.png", palette, "has colours"),
        ("a.tif", lambda path: tiff(path, -NUMBERS), ">= 0 everywhere; got -"),
        ("a.tif", lambda path: tiff(path, NUMBERS * np.float32(np.inf)), "finite"),
        ("a.tif", lambda path: tiff(path, NUMBERS, PLACE | keys(model=2)), "in degrees"),
        ("a.tif", lambda path: tiff(path, NUMBERS, PLACE | keys(model=1, unit=9003)), "unit 9003"),
        ("a.tif", lambda path: tiff(path, NUMBERS, TURNED), "turned or mirrored"),
        ("a.tif", lambda path: path.write_bytes(tiff(path, NUMBERS).read_bytes()[:300]), "damaged|no PGM"),
        ("a.tif", lambda path: path.write_bytes(b"nothing"), "is not a heat map: no PGM"),
        ("a.png", lambda path: None, "cannot read heat map"),
        ("a.npy", lambda path: None, "cannot read heat map"),
        ("a.npy", lambda path: path.write_bytes(b"nothing"), "no array of NumPy"),
        ("a.npy", lambda path: np.save(path, NUMBERS[0]), r"must be numbers \(rows, cols\)"),
        ("a.npy", lambda path: np.save(path, NUMBERS + 1j), "must be numbers"),
        ("a.npy", lambda path: np.save(path, np.array([["a"]])), "must be numbers"),
        ("a.npy", lambda path: np.save(path, np.array([[{}]]), allow_pickle=True), "cannot read heat map"),
        ("a.npy", lambda path: np.save(path, np.zeros((0, 4))), "must be numbers|empty"),
        ("a.npy", lambda path: np.save(path, np.zeros((1, 9000))), "9000x1; at most 8000"),
        ("a.npy", lambda path: np.save(path, -NUMBERS), ">= 0 everywhere"),
    ],
)
def test_what_is_no_raster_is_refused_in_words_of_its_own(
    tmp_path: Path, name: str, write: Callable[[Path], object], words: str
) -> None:
    write(tmp_path / name)
    with pytest.raises(InputError, match=words) as told:
        read_raster(tmp_path / name, "heat map")
    assert "heat map" in str(told.value)
