"""What the ``.yaml`` of a map_server pair says."""

from __future__ import annotations

import math
import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from reprlib import repr as repr_short
from typing import Any

from vedette.errors import InputError, InputWarning, nearest_name
from vedette.yaml_file import read_yaml_texts

RESOLUTIONS = (0.005, 10.0)  # accepted [m]
MAX_ORIGIN = 2e7  # accepted [m]: a beacon's centimetres have 32 bits
_MODES = ("trinary", "scale", "raw")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_TURN = 6.2832  # [rad] a whole turn as people write it
_YES, _NO = ("true", "yes", "on", "y"), ("false", "no", "off", "n")


@dataclass(frozen=True)
class MapMeta:
    """What the ``.yaml`` of a map_server pair says."""

    path: Path  # of the .yaml itself
    image: Path
    resolution: float | None  # [m]; None: the file gives none
    origin: tuple[float, float, float]  # of the lower-left pixel's corner: x, y, yaw [m, m, rad], team frame
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str


def read_meta(path: Path) -> MapMeta:
    """Read and check the ``.yaml`` of a map_server pair, its scalars as texts, which is how yaml-cpp reads.

    Raises:
        InputError: as :func:`read_map`.
    """
    content = read_yaml_texts(path, "map", "a map's .yaml is 'key: value' lines, one 'image: FILE'")
    image = content.get("image") if isinstance(content, dict) else None
    if not isinstance(image, str) or not image:
        raise InputError(f"{path} is not a map: it has no 'image: FILE' line")
    if not image.isprintable():
        raise InputError(f"{path}: image {_said(image)} cannot be the name of a file; write it anew")
    resolution = content.get("resolution")
    if resolution is not None:
        resolution = checked_resolution(resolution, f"{path}: resolution")
    mode = _said(content.get("mode", "trinary")).lower()
    if mode not in _MODES:
        raise InputError(f"{path}: unknown mode {mode!r}; {nearest_name(mode, _MODES)}")
    free, occupied = _thresholds(path, content)
    return MapMeta(
        path=path,
        image=path.parent / image,
        resolution=resolution,
        origin=_origin(path, content.get("origin", ["0", "0", "0"])),
        negate=_negate(path, content.get("negate", "0")),
        occupied_thresh=occupied,
        free_thresh=free,
        mode=mode,
    )


def checked_resolution(value: Any, what: str) -> float:
    """Return a resolution [m]; an `InputError` begins with ``what``."""
    low, high = RESOLUTIONS
    number = _number(value)
    if not low <= number <= high:
        raise InputError(f"{what} must be {low} to {high:g} m per pixel; got {_said(value)}")
    return number


def _negate(path: Path, value: Any) -> bool:
    word = _said(value).lower()
    if _number(value) in (0, 1):
        return bool(_number(value))
    if word not in _YES + _NO:
        raise InputError(f"{path}: negate must be 0 or 1; got {_said(value)}")
    return word in _YES


def _thresholds(path: Path, content: dict[str, Any]) -> tuple[float, float]:
    thresholds = []
    for name, default in (("free_thresh", "0.196"), ("occupied_thresh", "0.65")):
        value = content.get(name, default)
        thresholds.append(_number(value))
        if not 0.0 <= thresholds[-1] <= 1.0:
            raise InputError(f"{path}: {name} must be 0 to 1; got {_said(value)}")
    free, occupied = thresholds
    if free > occupied:
        raise InputError(
            f"{path}: free_thresh must be occupied_thresh at most; got {free:g} and {occupied:g}"
        )
    return free, occupied


def _origin(path: Path, value: Any) -> tuple[float, float, float]:
    parts = [_number(part) for part in value] if isinstance(value, list) else []
    if len(parts) not in (2, 3) or not all(map(math.isfinite, parts)):
        raise InputError(f"{path}: origin must be [x, y, yaw] [m, m, rad]; got {_said(value)}")
    x, y, yaw = (*parts, 0.0)[:3]
    if abs(yaw) > _TURN:
        line = (
            f"{path}: yaw {yaw:g} [rad] is beyond a whole turn; for {yaw:g} deg write {math.radians(yaw):.4f}"
        )
        warnings.warn(line, InputWarning, stacklevel=5)  # whoever asked for the map
    if max(abs(x), abs(y)) > MAX_ORIGIN:
        raise InputError(
            f"{path}: origin must be within {MAX_ORIGIN:.0f} m of 0, 0; got {x:.0f}, {y:.0f}; move it"
        )
    return x, y, math.remainder(yaw, math.tau)


def _number(value: Any) -> float:
    """Return the value of a number or of its text; NaN, which no range holds, where it is none."""
    if isinstance(value, str) and not _NUMBER.fullmatch(value.strip()):
        return math.nan
    return float(value) if isinstance(value, str | int | float) else math.nan


def _said(value: Any) -> str:
    """Return a value in short, a text as it stands in the file."""
    return repr_short(value).strip("'\"") if isinstance(value, str) else repr_short(value)
