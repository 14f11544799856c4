"""Read a raster of numbers: a grey image, a TIFF of any numbers with its place if it has one, or an array."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, TiffImagePlugin, UnidentifiedImageError

from vedette.errors import InputError
from vedette.input_file import open_input
from vedette.maps.geotiff import no_data, placed
from vedette.maps.image import MAX_SIDE

Extent = tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y [m]

_FORMATS = ("PPM", "PNG", "BMP", "JPEG", "TIFF")
_ALIKE = 8  # levels of 255 that colour channels of grey may differ by, as lossy compression makes them
for _order, _numbers in (
    (b"II", "F;64F"),
    (b"MM", "F;64BF"),
):  # Pillow unpacks 64 bits but opens no such TIFF
    TiffImagePlugin.OPEN_INFO.setdefault((_order, 1, (3,), 1, (64,), ()), ("F", _numbers))


@dataclass(frozen=True, eq=False)
class Raster:
    """Numbers on a grid, bottom row first."""

    values: NDArray[np.float64]  # (rows, cols)
    extent: Extent | None  # where it lies, as the file says; None: it does not


def read_numbers(path: Path, what: str) -> Raster:
    """Read a PGM, PNG, BMP or JPEG in grey, a TIFF or GeoTIFF, or a ``.npy``; ``what`` is for messages.

    NaN where the file has no data. Alpha thins what it covers. Rows of an image go down; those of an array
    go up, as all grids here do.

    Raises:
        InputError: missing, unreadable, too large, in colours, or a GeoTIFF whose place is not in metres
            along the axes; the line says what to do.
    """
    return Raster(*(_array(path, what) if path.suffix.lower() == ".npy" else _image(path, what)))


def read_raster(path: Path, what: str) -> Raster:
    """Read a raster of weights as `read_numbers` does: finite and >= 0, 0 where the file has no data.

    Raises:
        InputError: as `read_numbers`, or a number is negative or infinite.
    """
    raster = read_numbers(path, what)
    values, extent = np.where(np.isnan(raster.values), 0.0, raster.values), raster.extent
    if not np.isfinite(values).all() or (values < 0.0).any():
        wrong = values[~(np.isfinite(values) & (values >= 0.0))][0]
        raise InputError(
            f"{what} {path} must be finite and >= 0 everywhere; got {wrong:g}; if that stands for no data, "
            "say so (GDAL_NODATA in a TIFF, nan in an array)"
        )
    return Raster(values, extent)


def _array(path: Path, what: str) -> tuple[NDArray[np.float64], None]:
    with open_input(path, what) as file:
        try:
            loaded: Any = np.lib.format.open_memmap(path, mode="r") if file.read(6) == b"\x93NUMPY" else None
        except (ValueError, OSError, EOFError, SyntaxError) as error:
            raise InputError(f"cannot read {what} {path}: {' '.join(str(error).split())}") from error
    if loaded is None:
        raise InputError(f"{path} is not a {what}: no array of NumPy; save one with numpy.save")
    if loaded.ndim != 2 or loaded.dtype.kind not in "buif" or loaded.size == 0:
        raise InputError(f"{what} {path} must be numbers (rows, cols); it is {loaded.dtype} {loaded.shape}")
    _check_size(path, what, *loaded.shape)
    return np.asarray(loaded, np.float64), None


def _image(path: Path, what: str) -> tuple[NDArray[np.float64], Extent | None]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of sizes, which are checked below, and of odd metadata
            with open_input(path, what) as file, Image.open(file, formats=_FORMATS) as image:
                _check_size(path, what, image.height, image.width)
                tags = dict(getattr(image, "tag_v2", {}))
                values = _values(path, what, image)
    except Image.DecompressionBombError as error:
        raise InputError(f"{what} {path} is too large: at most {MAX_SIDE} pixels a side") from error
    except UnidentifiedImageError as error:
        raise InputError(
            f"{path} is not a {what}: no PGM, PNG, BMP, JPEG or .npy, nor a TIFF of a number a pixel, of 8, "
            "16 or 32 bits, or a float of 32 or 64"
        ) from error
    except InputError:
        raise
    except (OSError, ValueError, SyntaxError, EOFError) as error:  # Pillow's ways to say: damaged
        reason = getattr(error, "strerror", None) or "the file is damaged"
        raise InputError(f"cannot read {what} {path}: {reason}") from error
    missing = no_data(tags)
    if missing is not None:
        values[np.isclose(values, missing, rtol=1e-6, atol=0.0)] = np.nan
    return values[::-1], placed(path, what, tags, values.shape)


def _check_size(path: Path, what: str, rows: int, cols: int) -> None:
    if rows == 0 or cols == 0:
        raise InputError(f"{path} is not a {what}: it is empty")
    if max(rows, cols) > MAX_SIDE:
        raise InputError(f"{what} {path} is too large: {cols}x{rows}; at most {MAX_SIDE} a side")


def _values(path: Path, what: str, image: Image.Image) -> NDArray[np.float64]:
    """Return the numbers of a grey image, top row first."""
    if image.mode == "L" and "transparency" not in image.info:
        return np.array(image, np.float64)
    if image.mode == "F" or image.mode.startswith("I"):
        values = np.array(image, np.float64)
        clear = image.info.get("transparency")  # a PNG's level that stands for no pixel
        return np.where(values == clear, 0.0, values) if isinstance(clear, int) else values
    pixels = np.asarray(image.convert("RGBA"), np.int16)
    opaque = pixels[..., 3] > 0
    apart = (pixels[..., :3].max(axis=2) - pixels[..., :3].min(axis=2))[opaque]
    if apart.size and apart.max() > _ALIKE:
        raise InputError(
            f"{what} {path} has colours, and how bright a colour is says nothing of the number it stands "
            "for; save it in grey, or its numbers as a float TIFF or .npy"
        )
    return np.asarray(pixels[..., 0] * (pixels[..., 3] / 255.0))
