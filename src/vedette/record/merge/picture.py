"""The picture of merged maps: walls, and ground in the colour of the map that alone knows it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from vedette.maps import FREE, GridFrame
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save
from vedette.record.explore.raster import fit, known_window, pool
from vedette.record.signs import scale_bar

_PIXELS = 1500, 1500  # of the map at most: rows, columns
_WIDTH, _TITLE, _FOOT = 8.0, 0.35, 0.3  # [inch]
_TINT = 0.35  # of a map's colour on ground that it alone knows


def merge_png(
    frame: GridFrame,
    classes: NDArray[np.uint8],
    whose: NDArray[np.uint8],
    names: Sequence[str],
    path: Path | str,
) -> None:
    """Draw the merged map; ground that several maps know is white.

    Args:
        frame: of the merged map.
        classes: its cells, (R, C).
        whose: the number, from 1 on, of the map that alone knows a cell, (R, C).
        names: of the maps.
        path: of the picture.
    """
    window = known_window(frame, classes)
    part = classes[window.rows, window.cols]
    shape = fit(part.shape, _PIXELS)
    colours = palette.CLASSES[pool(part, *shape)]
    tints = [palette.unit(_tint(number)) for number in range(len(names))]
    for number in range(len(names)):
        alone = (whose[window.rows, window.cols] == number + 1) & (part == FREE)
        colours[(pool(alone.astype(np.uint8), *shape) > 0) & (colours == 255).all(axis=2)] = _tint(number)
    x0, x1, y0, y1 = window.frame.extent
    inches = min(max(_WIDTH * (y1 - y0) / (x1 - x0), 2.0), 12.0)  # of the map's height
    whole = inches + _TITLE + _FOOT
    with picture():
        figure = Figure(figsize=(_WIDTH, whole), dpi=DPI)
        axes = figure.add_axes((0.01, _FOOT / whole, 0.98, inches / whole))
        axes.imshow(colours, origin="lower", extent=(x0, x1, y0, y1), interpolation="antialiased")
        axes.set(xticks=(), yticks=())
        patches = [Patch(fc=t, ec="0.6", label=f"{name} alone") for t, name in zip(tints, names, strict=True)]
        patches.append(Patch(fc="white", ec="0.6", label="several"))
        axes.legend(handles=patches, loc="best", fontsize=8, framealpha=0.9)
        axes.set_title(f"{len(names)} maps merged", loc="left", fontsize=11, fontweight="bold")
        shown = 0.98 * min(_WIDTH, inches * (x1 - x0) / (y1 - y0))
        scale_bar(figure, 0.01 * _WIDTH, _FOOT / 2, x1 - x0, shown)
        save(figure, path)


def _tint(number: int) -> palette.Rgb:
    """Return a map's colour, thinned by white."""
    red, green, blue = (round(255 - _TINT * (255 - part)) for part in palette.robot_colour(number))
    return red, green, blue
