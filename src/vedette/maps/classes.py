"""What each pixel of a map stands for: free, occupied or unknown."""

from __future__ import annotations

import math
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputWarning
from vedette.maps.frame import FREE, OCCUPIED, UNKNOWN
from vedette.maps.image import Levels
from vedette.maps.meta import MapMeta
from vedette.number import many

_PLAIN_FREE = 128  # a pixel of an image without a .yaml is free from this level on
_PLAIN_OPAQUE = 128  # and unknown below this alpha
_FOR_UNKNOWN = (205, 206, 128, 127)  # greys of map_saver, Stage, Cartographer, MRPT
_WORTH_A_WORD = 0.001  # share of the pixels: fewer are the soft edges of a drawing


def classes_of_pair(meta: MapMeta, levels: Levels) -> NDArray[np.uint8]:
    """Return the class that map_server gives to each pixel, ``uint8[rows, cols]``, bottom row first.

    The rules are those of Nav2 since its pull request 5071 (2025): of a colour the luma counts, in 8
    bits; occupied from ``occupied_thresh`` up, free from ``free_thresh`` down, in single precision; unknown
    unless opaque. Ours: a graded value (scale, raw) is known only beyond the thresholds, and raw heeds alpha.

    Warns:
        InputWarning: grey that map savers write for unknown is free.
    """
    grey = levels.eight_bits()
    level = np.arange(256, dtype=np.float32)
    if meta.mode == "raw":
        occupied = np.where(level <= 100, level / np.float32(100), np.float32(np.nan))
    else:
        occupied = level / np.float32(255) if meta.negate else 1 - level / np.float32(255)
    table = np.full(256, UNKNOWN, np.uint8)
    table[occupied >= np.float32(meta.occupied_thresh)] = OCCUPIED
    table[occupied <= np.float32(meta.free_thresh)] = FREE
    classes = table[grey]
    if levels.alpha is not None:
        classes[levels.alpha < 255] = UNKNOWN
    if meta.mode != "raw" and (found := _doubtful(255 - grey if meta.negate else grey, classes)):
        _warn(
            f"{meta.path}: free_thresh {meta.free_thresh:g} makes {_told(found, meta.negate)} free, which "
            f"map savers write for unknown; if it is unknown, set free_thresh to {_threshold(found)}"
        )
    return classes


def classes_of_plain(path: Path, levels: Levels) -> NDArray[np.uint8]:
    """Return the class of each pixel without a ``.yaml``: free from 128 on, unknown where transparent.

    Warns:
        InputWarning: grey that map savers write for unknown is free.
    """
    grey = levels.eight_bits()
    classes = np.where(grey >= _PLAIN_FREE, np.uint8(FREE), np.uint8(OCCUPIED))
    if levels.alpha is not None:
        classes[levels.alpha < _PLAIN_OPAQUE] = UNKNOWN
    if found := _doubtful(grey, classes):
        _warn(
            f"{path}: without a .yaml all from grey 128 on is free, {_told(found)} too, which map savers "
            "write for unknown; if it is unknown, paint it black or write a .yaml with "
            f"'free_thresh: {_threshold(found)}'"
        )
    return classes


def _doubtful(light: NDArray[np.uint8], classes: NDArray[np.uint8]) -> dict[int, int]:
    """Return how many pixels are free though of a level that means unknown, if lighter ones are free too."""
    free = classes == FREE
    counts = {level: int(np.count_nonzero(free & (light == level))) for level in _FOR_UNKNOWN}
    found = {level: count for level, count in counts.items() if count > _WORTH_A_WORD * light.size}
    return found if found and light.max(where=free, initial=0) > max(found) else {}


def _told(found: dict[int, int], negate: bool = False) -> str:
    return " and ".join(
        f"grey {255 - level if negate else level} ({many(count, 'pixel')})" for level, count in found.items()
    )


def _threshold(found: dict[int, int]) -> float:
    """Return a ``free_thresh`` that leaves these levels out."""
    return math.floor(1000 * (1 - max(found) / 255)) / 1000


def _warn(line: str) -> None:
    warnings.warn(line, InputWarning, stacklevel=4)  # whoever asked for the map
