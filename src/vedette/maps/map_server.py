"""Read and write maps as ROS map_server does: a ``.yaml`` beside an image, or an image alone."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from reprlib import repr as repr_short
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from vedette.errors import InputError, nearest_name
from vedette.maps.atomic import atomic_path
from vedette.maps.frame import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.image import read_levels
from vedette.yaml_file import read_yaml

RESOLUTIONS = (0.005, 10.0)  # accepted [m]
MAX_ORIGIN = 1e6  # accepted [m]: farther out, metres lose the millimetres
_MODES = ("trinary", "scale", "raw")
_PIXELS = {  # grey level of UNKNOWN, FREE and OCCUPIED, as map_saver writes them
    "trinary": np.array([205, 254, 0], np.uint8),
    "raw": np.array([255, 0, 100], np.uint8),
}


@dataclass(frozen=True)
class MapMeta:
    """What the ``.yaml`` of a map_server pair says."""

    image: Path
    resolution: float | None  # [m]; None: the file gives none
    origin: tuple[float, float]  # of the lower-left pixel's corner [m], team frame
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str


def read_map(path: Path | str, resolution: float | None = None) -> tuple[GridFrame, NDArray[np.uint8]]:
    """Read a map_server pair (give its ``.yaml``) or a plain image, whose pixels >= 128 are free.

    Args:
        path: ``.yaml``, or an image (PGM, PNG, BMP, JPEG). Transparent pixels of a plain image are unknown.
        resolution: side of a pixel [m]; needed for a plain image, overrides that of a pair.

    Returns:
        The frame and the cell classes ``uint8[rows, cols]``, row 0 the lowest y (the image's last row).

    Raises:
        InputError: the path is missing, a folder, unreadable or not a map, or a value in it is out of range.
    """
    path = Path(path)
    if resolution is not None:
        resolution = _checked_resolution(resolution, "--resolution")
    if path.is_dir():
        raise InputError(f"{path} is a folder; give a map's .yaml or an image")
    if path.suffix.lower() not in (".yaml", ".yml"):
        return _read_plain(path, resolution)
    meta = read_meta(path)
    resolution = resolution if resolution is not None else meta.resolution
    if resolution is None:
        raise InputError(f"{path}: no resolution; add 'resolution: 0.05' [m per pixel] or give --resolution")
    classes = _classify(meta)
    rows, cols = classes.shape
    return GridFrame(resolution, rows, cols, *meta.origin), classes


def write_map(stem: Path | str, frame: GridFrame, classes: NDArray[np.uint8], mode: str = "trinary") -> None:
    """Write ``stem.pgm`` and ``stem.yaml``, which map_server and :func:`read_map` load to the same classes.

    Args:
        stem: path without suffix.
        frame: of the classes.
        classes: ``uint8[rows, cols]``.
        mode: ``trinary`` (free 254, unknown 205, occupied 0) or ``raw`` (0, 255, 100).

    Raises:
        InputError: unknown mode, or the folder cannot be written to.
    """
    if mode not in _PIXELS:
        raise InputError(f"cannot write a map in mode {mode!r}; {nearest_name(mode, _PIXELS)}")
    if classes.shape != frame.shape:
        raise ValueError(f"classes are {classes.shape}, the frame is {frame.shape}")
    image = Path(f"{stem}.pgm")
    pixels = _PIXELS[mode][classes[::-1]]
    with atomic_path(image) as temporary:
        temporary.write_bytes(b"P5\n%d %d\n255\n" % (frame.cols, frame.rows) + pixels.tobytes())
    with atomic_path(f"{stem}.yaml") as temporary:  # last: a .yaml never stands without its image
        temporary.write_text(
            f"image: {_quoted(image.name)}\n"
            f"mode: {mode}\n"
            f"resolution: {frame.resolution!r}\n"
            f"origin: [{frame.origin_x!r}, {frame.origin_y!r}, 0.0]\n"
            "negate: 0\n"
            "occupied_thresh: 0.65\n"
            "free_thresh: 0.196\n",  # grey 205 is 0.19608 occupied: just not free
            encoding="utf-8",
        )


def read_meta(path: Path) -> MapMeta:
    """Read and check the ``.yaml`` of a map_server pair.

    Raises:
        InputError: as :func:`read_map`.
    """
    content = _load_yaml(path)
    image = content.get("image")
    if not isinstance(image, str) or not image:
        raise InputError(f"{path} is not a map: it has no 'image: FILE' line")
    resolution = content.get("resolution")
    if resolution is not None:
        resolution = _checked_resolution(resolution, f"{path}: resolution")
    mode = content.get("mode", "trinary")
    if mode not in _MODES:
        raise InputError(f"{path}: unknown mode {repr_short(mode)}; {nearest_name(repr_short(mode), _MODES)}")
    negate = content.get("negate", 0)
    if negate not in (0, 1):
        raise InputError(f"{path}: negate must be 0 or 1; got {repr_short(negate)}")
    free, occupied = _thresholds(path, content)
    return MapMeta(
        image=path.parent / image,
        resolution=resolution,
        origin=_origin(path, content.get("origin", [0.0, 0.0, 0.0])),
        negate=bool(negate),
        occupied_thresh=occupied,
        free_thresh=free,
        mode=mode,
    )


def _load_yaml(path: Path) -> dict[str, Any]:
    content = read_yaml(path, "map", "it is not a map without an 'image: FILE' line")
    if not isinstance(content, dict):
        raise InputError(f"{path} is not a map: it has no 'image: FILE' line")
    return content


def _checked_resolution(value: Any, what: str) -> float:
    low, high = RESOLUTIONS
    number = _number(value)
    if not low <= number <= high:
        raise InputError(f"{what} must be {low} to {high:g} m per pixel; got {repr_short(value)}")
    return number


def _thresholds(path: Path, content: dict[str, Any]) -> tuple[float, float]:
    thresholds = []
    for name, default in (("free_thresh", 0.196), ("occupied_thresh", 0.65)):
        value = content.get(name, default)
        thresholds.append(_number(value))
        if not 0.0 <= thresholds[-1] <= 1.0:
            raise InputError(f"{path}: {name} must be 0 to 1; got {repr_short(value)}")
    free, occupied = thresholds
    if free >= occupied:
        raise InputError(f"{path}: free_thresh must be below occupied_thresh; got {free:g} and {occupied:g}")
    return free, occupied


def _origin(path: Path, value: Any) -> tuple[float, float]:
    numbers = [_number(part) for part in value] if isinstance(value, list) else []
    if len(numbers) not in (2, 3) or not all(abs(number) <= MAX_ORIGIN for number in numbers):
        raise InputError(f"{path}: origin must be [x, y, yaw] [m, m, rad]; got {repr_short(value)}")
    if len(numbers) == 3 and numbers[2] != 0.0:
        raise InputError(f"{path}: yaw {numbers[2]:g} is not supported; turn the image and set the yaw to 0")
    return numbers[0], numbers[1]


def _number(value: Any) -> float:
    """Return the value as a float; NaN, which no range holds, where it is none."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return math.nan
    try:
        return float(value)
    except OverflowError:  # a whole number of hundreds of digits
        return math.nan


def _read_plain(path: Path, resolution: float | None) -> tuple[GridFrame, NDArray[np.uint8]]:
    levels = read_levels(path)
    if resolution is None:
        pair = path.with_suffix(".yaml")
        remedy = f"give {pair.name} instead, or " if pair.is_file() else ""
        raise InputError(f"{path}: an image alone has no resolution; {remedy}add --resolution [m per pixel]")
    shade = np.arange(levels.full + 1) / levels.full
    classes = np.where(shade >= 128 / 255, FREE, OCCUPIED).astype(np.uint8)[levels.colour]
    if levels.alpha is not None:
        classes[levels.alpha < 128] = UNKNOWN
    rows, cols = classes.shape
    return GridFrame(resolution, rows, cols), classes


def _classify(meta: MapMeta) -> NDArray[np.uint8]:
    """Return the classes that map_server gives to each pixel, bottom row first.

    Trinary averages alpha in with the colours, scale takes any transparency as unknown, as map_server does. A
    graded value (scale, raw) is known only beyond the thresholds.
    """
    levels = read_levels(meta.image)
    level, full = levels.colour, levels.full
    if meta.mode == "trinary" and levels.alpha is not None:
        level, full = level + levels.alpha, full + 255
    shade = np.arange(full + 1) / full
    if meta.mode == "raw":
        percent = np.round(shade * 255)
        occupied = np.where(percent <= 100, percent / 100, np.nan)
    else:
        occupied = shade if meta.negate else 1.0 - shade
    table = np.full(full + 1, UNKNOWN, np.uint8)
    table[occupied > meta.occupied_thresh] = OCCUPIED
    table[occupied < meta.free_thresh] = FREE
    classes = table[level]
    if meta.mode == "scale" and levels.alpha is not None:
        classes[levels.alpha < 255] = UNKNOWN
    return classes


def _quoted(name: str) -> str:
    text: str = yaml.safe_dump(name, default_style='"', allow_unicode=True, width=10**6)
    return text.strip()
