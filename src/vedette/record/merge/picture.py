"""The picture of merged maps: walls, and ground in the colour of the map that alone knows it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.patches import Patch
from numpy.typing import NDArray

from vedette.maps import FREE, GridFrame
from vedette.record import palette
from vedette.record.canvas import picture, save
from vedette.record.explore.raster import fit, known_window, pool
from vedette.record.sheet import Sheet

_PIXELS = 1500, 1500  # of the map at most: rows, columns
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
    patches = [Patch(fc=tint, ec="0.6") for tint in (*tints, "white")]
    labels = [*(f"{name} alone" for name in names), "several"]
    with picture():
        sheet = Sheet.make(colours, window.frame.extent, f"{len(names)} maps merged", labels)
        sheet.explain(patches)
        save(sheet.figure, path)


def _tint(number: int) -> palette.Rgb:
    """Return a map's colour, thinned by white."""
    red, green, blue = (round(255 - _TINT * (255 - part)) for part in palette.robot_colour(number))
    return red, green, blue
