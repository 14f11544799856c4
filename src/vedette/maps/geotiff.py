"""Where a GeoTIFF lies, and which number stands for no data, by its tags (OGC 19-008, GDAL)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from vedette.errors import InputError

_SCALE, _TIE, _TRANSFORM, _KEYS, _NO_DATA = 33550, 33922, 34264, 34735, 42113  # tags
_MODEL, _RASTER, _UNIT = 1024, 1025, 3076  # keys
_GEOGRAPHIC, _POINT, _METRE, _UNSET = 2, 2, 9001, (0, 32767)


def no_data(tags: Mapping[int, Any]) -> float | None:
    """Return the number that stands for no data, if the tags have one."""
    try:
        return float(str(tags[_NO_DATA]).strip("\0 ")) if _NO_DATA in tags else None
    except ValueError:
        return None


def placed(
    path: Path, what: str, tags: Mapping[int, Any], shape: tuple[int, ...]
) -> tuple[float, float, float, float] | None:
    """Return lowest x, lowest y, highest x, highest y [m] of an image ``(rows, cols)``; None: no place.

    Raises:
        InputError: in degrees, in another unit than metres, or turned.
    """
    if _TRANSFORM in tags and len(tags[_TRANSFORM]) >= 16:
        a, b, _, x, d, e, _, y = map(float, tags[_TRANSFORM][:8])
        column, row = 0.0, 0.0
    elif _SCALE in tags and _TIE in tags and len(tags[_SCALE]) >= 2 and len(tags[_TIE]) >= 6:
        column, row, _, x, y = map(float, tags[_TIE][:5])
        a, b, d, e = float(tags[_SCALE][0]), 0.0, 0.0, -float(tags[_SCALE][1])
    else:
        return None
    keys = _keys(tags)
    if keys.get(_MODEL) == _GEOGRAPHIC:
        raise InputError(
            f"{what} {path} lies in degrees; bring it into the scenario's metres, with gdalwarp say"
        )
    if keys.get(_UNIT, _METRE) not in (_METRE, *_UNSET):
        raise InputError(
            f"{what} {path} does not lie in metres but in unit {keys[_UNIT]} of EPSG; bring it there"
        )
    if b != 0.0 or d != 0.0 or not (a > 0.0 and e < 0.0):
        raise InputError(f"{what} {path} is turned or mirrored; bring it north up, with gdalwarp say")
    half = 0.5 if keys.get(_RASTER) == _POINT else 0.0  # the tie is a pixel's middle, not its corner
    left, top = x - (column + half) * a, y - (row + half) * e
    return left, top + shape[0] * e, left + shape[1] * a, top


def _keys(tags: Mapping[int, Any]) -> dict[int, int]:
    """Return the keys that are numbers: quadruples of key, place, count and value after the first."""
    words = [int(word) for word in tags.get(_KEYS, ())]
    quadruples = zip(words[4::4], words[5::4], words[7::4], strict=False)
    return {key: value for key, place, value in quadruples if place == 0}
