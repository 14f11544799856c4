"""What the ``.yaml`` of a map_server pair says."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from reprlib import repr as repr_short
from typing import Any

from vedette.errors import InputError, nearest_name
from vedette.yaml_file import read_yaml

RESOLUTIONS = (0.005, 10.0)  # accepted [m]
MAX_ORIGIN = 1e6  # accepted [m]: farther out, metres lose the millimetres
_MODES = ("trinary", "scale", "raw")


@dataclass(frozen=True)
class MapMeta:
    """What the ``.yaml`` of a map_server pair says."""

    path: Path  # of the .yaml itself
    image: Path
    resolution: float | None  # [m]; None: the file gives none
    origin: tuple[float, float]  # of the lower-left pixel's corner [m], team frame
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str


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
        resolution = checked_resolution(resolution, f"{path}: resolution")
    mode = content.get("mode", "trinary")
    if mode not in _MODES:
        raise InputError(f"{path}: unknown mode {repr_short(mode)}; {nearest_name(repr_short(mode), _MODES)}")
    negate = content.get("negate", 0)
    if negate not in (0, 1):
        raise InputError(f"{path}: negate must be 0 or 1; got {repr_short(negate)}")
    free, occupied = _thresholds(path, content)
    return MapMeta(
        path=path,
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


def checked_resolution(value: Any, what: str) -> float:
    """Return a resolution [m]; an `InputError` begins with ``what``."""
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
