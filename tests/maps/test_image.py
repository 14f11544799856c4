"""Images of every depth and kind give their grey levels and what is transparent."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest

from vedette.errors import InputError
from vedette.maps.image import read_levels

ADAM7 = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]
GREY, COLOUR, PALETTE, GREY_ALPHA, COLOUR_ALPHA = 0, 2, 3, 4, 6
CHANNELS = {GREY: 1, COLOUR: 3, PALETTE: 1, GREY_ALPHA: 2, COLOUR_ALPHA: 4}


def png(samples: np.ndarray, depth: int, kind: int, interlaced: bool = False, **more: bytes) -> bytes:
    """Return a PNG of ``(rows, cols, channels)`` samples, with other chunks by name; nothing of Pillow's."""
    rows, cols = samples.shape[:2]
    passes = ADAM7 if interlaced else [(0, 0, 1, 1)]
    lines = b"".join(
        b"\0" + packed(line, depth) for x, y, dx, dy in passes for line in samples[y::dy, x::dx] if len(line)
    )
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", cols, rows, depth, kind, 0, 0, interlaced))]
    chunks += [(name.encode(), data) for name, data in more.items()]
    chunks += [(b"IDAT", zlib.compress(lines)), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
        for name, data in chunks
    )


def packed(line: np.ndarray, depth: int) -> bytes:
    if depth == 16:
        return line.astype(">u2").tobytes()
    bits = (line.reshape(-1, 1) >> np.arange(depth - 1, -1, -1)) & 1
    return np.packbits(bits.astype(np.uint8)).tobytes()


def random(shape: tuple[int, ...], depth: int) -> np.ndarray:
    return np.random.default_rng(depth).integers(0, 1 << depth, shape)


def check(folder: Path, data: bytes, grey: np.ndarray, full: int, alpha: np.ndarray | None = None) -> None:
    (folder / "map.png").write_bytes(data)
    levels = read_levels(folder / "map.png")
    assert levels.full == full
    np.testing.assert_array_equal(levels.grey, grey[::-1])
    if alpha is None:
        assert levels.alpha is None
    else:
        np.testing.assert_array_equal(levels.alpha, alpha[::-1])


@pytest.mark.parametrize("interlaced", [False, True])
@pytest.mark.parametrize("depth", [1, 2, 4, 8, 16])
def test_grey_of_any_depth_is_spread_over_all_levels(tmp_path: Path, depth: int, interlaced: bool) -> None:
    samples = random((9, 13, 1), depth)
    full = 65535 if depth == 16 else 255
    grey = samples[..., 0] * full // ((1 << depth) - 1)
    check(tmp_path, png(samples, depth, GREY, interlaced), grey, full)


@pytest.mark.parametrize("depth", [1, 2, 4, 8, 16])
def test_the_level_that_is_declared_transparent_is(tmp_path: Path, depth: int) -> None:
    samples = random((9, 13, 1), depth)
    full = 65535 if depth == 16 else 255
    for clear in {0, int(samples[0, 0, 0]), (1 << depth) - 1}:
        data = png(samples, depth, GREY, tRNS=struct.pack(">H", clear))
        alpha = np.where(samples[..., 0] == clear, 0, 255)
        check(tmp_path, data, samples[..., 0] * full // ((1 << depth) - 1), full, alpha)


@pytest.mark.parametrize("interlaced", [False, True])
@pytest.mark.parametrize("depth", [1, 2, 4, 8])
def test_a_palette_is_looked_up_with_its_alpha(tmp_path: Path, depth: int, interlaced: bool) -> None:
    samples = random((9, 13, 1), depth)
    palette = random((1 << depth, 1), 8).repeat(3, axis=1).astype(np.uint8)
    opacity = random((1 << depth,), 8).astype(np.uint8)
    grey = palette[samples[..., 0], 0]
    check(tmp_path, png(samples, depth, PALETTE, interlaced, PLTE=palette.tobytes()), grey, 255)
    data = png(samples, depth, PALETTE, interlaced, PLTE=palette.tobytes(), tRNS=opacity.tobytes())
    check(tmp_path, data, grey, 255, opacity[samples[..., 0]])


@pytest.mark.parametrize("interlaced", [False, True])
@pytest.mark.parametrize("depth", [8, 16])
@pytest.mark.parametrize("kind", [COLOUR, GREY_ALPHA, COLOUR_ALPHA])
def test_grey_pixels_stay_the_same_in_colours_and_with_alpha(
    tmp_path: Path, kind: int, depth: int, interlaced: bool
) -> None:
    grey, alpha = random((9, 13), 8), random((9, 13), 8)[::-1]
    channels = [grey] * (CHANNELS[kind] - (kind in (GREY_ALPHA, COLOUR_ALPHA)))
    channels += [alpha] if kind in (GREY_ALPHA, COLOUR_ALPHA) else []
    samples = np.stack(channels, axis=-1) * (257 if depth == 16 else 1)
    data = png(samples, depth, kind, interlaced)
    check(tmp_path, data, grey, 255, None if kind == COLOUR else alpha)


@pytest.mark.parametrize(
    "data",
    [
        b"P2\n# drawn\n3 2\n255\n0 205 254\n254 7 0\n",
        b"P2 3 2 255 0 205 254 254 7 0",
        b"P5\n3 2\n255\n\x00\xcd\xfe\xfe\x07\x00",
        b"P5 # drawn\n#\n3 # wide\n2\n255\n\x00\xcd\xfe\xfe\x07\x00",
        b"P6\n3 2\n255\n" + bytes(level for level in (0, 205, 254, 254, 7, 0) for _ in range(3)),
    ],
)
def test_portable_maps_are_read_as_text_and_as_bytes_with_comments(tmp_path: Path, data: bytes) -> None:
    check(tmp_path, data, np.array([[0, 205, 254], [254, 7, 0]]), 255)


def test_portable_maps_of_16_bits_keep_them(tmp_path: Path) -> None:
    wide = np.array([[0, 52685, 65535]])
    check(tmp_path, b"P2\n3 1\n65535\n0 52685 65535\n", wide, 65535)
    check(tmp_path, b"P5\n3 1\n65535\n" + wide.astype(">u2").tobytes(), wide, 65535)


def test_levels_that_are_no_whole_numbers_are_refused(tmp_path: Path) -> None:
    (tmp_path / "map.pgm").write_bytes(b"Pf\n1 1\n-1.0\n\0\0\x80\x3f")
    with pytest.raises(
        InputError, match=r"map\.pgm is not a map: its levels are no whole numbers; save it as"
    ):
        read_levels(tmp_path / "map.pgm")
