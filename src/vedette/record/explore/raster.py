"""Cell grids as pixels: the part worth showing, fewer pixels without losing walls, colours."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from vedette.maps import UNKNOWN, GridFrame
from vedette.record import palette
from vedette.record.explore.log import ExploreSnapshot

_SHADES = 200  # of the impact: with the classes they fit a byte
_RAMP = np.linspace(0.0, 1.0, _SHADES, dtype=np.float32)


@dataclass(frozen=True)
class Window:
    """A rectangle of a grid's cells."""

    rows: slice
    cols: slice
    frame: GridFrame  # of the rectangle alone


def known_window(frame: GridFrame, classes: NDArray[np.uint8], margin: float = 0.5) -> Window:
    """Return the rectangle around the known cells with ``margin`` [m] to each side; all if none is known."""
    known = classes != UNKNOWN
    if not known.any():
        return Window(slice(0, frame.rows), slice(0, frame.cols), frame)
    pad = round(margin / frame.resolution)
    row, col = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
    rows = slice(max(0, int(row[0]) - pad), min(frame.rows, int(row[-1]) + 1 + pad))
    cols = slice(max(0, int(col[0]) - pad), min(frame.cols, int(col[-1]) + 1 + pad))
    return Window(rows, cols, frame.window(rows, cols))


def pool(classes: NDArray[np.uint8], rows: int, cols: int) -> NDArray[np.uint8]:
    """Return at most ``rows x cols`` pixels, the highest class in each: wall, then free, then unknown."""
    return _top_of_rows(np.ascontiguousarray(_top_of_rows(classes, rows).T), cols).T


def _top_of_rows(classes: NDArray[np.uint8], rows: int) -> NDArray[np.uint8]:
    """Return the maxima of ``rows`` bands, one by one: far faster than ``maximum.reduceat``."""
    if rows >= len(classes):
        return classes
    edges = np.arange(rows + 1) * len(classes) // rows
    return np.stack([classes[first:end].max(axis=0) for first, end in pairwise(edges)])


def fit(shape: tuple[int, ...], limit: tuple[int, int]) -> tuple[int, int]:
    """Return the largest ``(rows, cols)`` of these proportions within ``limit`` and ``shape``."""
    shrink = min(1.0, limit[0] / shape[0], limit[1] / shape[1])
    return max(1, round(shape[0] * shrink)), max(1, round(shape[1] * shrink))


def paint(
    snapshot: ExploreSnapshot,
    planning: GridFrame,
    window: Window,
    limit: tuple[int, int],
    classes: NDArray[np.uint8] = palette.CLASSES,
) -> NDArray[np.uint8]:
    """Return ``(rows, cols, 3)`` colours of a window within ``limit`` rows and columns, row 0 the lowest y.

    Unknown cells take the colour of the team's impact: the probability that its strategies observe them.
    """
    part = snapshot.classes[window.rows, window.cols]
    pixels = pool(part, *fit(part.shape, limit))
    if snapshot.impact is None:
        return classes[pixels]
    shades = np.rint(np.clip(snapshot.impact, 0.0, 1.0) * (_SHADES - 1)).astype(np.uint8)
    x_min, x_max, y_min, y_max = window.frame.extent
    row = _cells_under(len(pixels), y_min, y_max, planning.origin_y, planning.resolution, planning.rows)
    col = _cells_under(pixels.shape[1], x_min, x_max, planning.origin_x, planning.resolution, planning.cols)
    first = len(classes)
    colours = np.concatenate((classes, palette.blend_impact(np.tile(classes[UNKNOWN], (_SHADES, 1)), _RAMP)))
    return colours[np.where(pixels == UNKNOWN, first + shades[row].take(col, axis=1), pixels)]


def _cells_under(
    pixels: int, low: float, high: float, origin: float, resolution: float, cells: int
) -> NDArray[np.intp]:
    """Return the planning cell, along one axis, under the middle of each pixel from ``low`` to ``high``."""
    middle = low + (np.arange(pixels) + 0.5) * (high - low) / pixels
    return ((middle - origin) / resolution).astype(np.intp).clip(0, cells - 1)


def enlarge(colours: NDArray[np.uint8], size: tuple[int, int]) -> Image.Image:
    """Return the pixels resampled to exactly ``(width, height)``: edges sharp, walls equally thick."""
    rows, cols = colours.shape[:2]
    fine = colours.repeat(-(-size[1] // rows), axis=0).repeat(-(-size[0] // cols), axis=1)
    return Image.fromarray(fine).resize(size, Image.Resampling.BOX)
