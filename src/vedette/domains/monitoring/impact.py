"""The impact of a way: how much information about the field it would bring, by spot and time layer."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.kernels.misses import CERTAIN, Misses, MissesCodec, SparseMisses
from vedette.maps import GridFrame
from vedette.number import many
from vedette.problem import Reach

Impact: TypeAlias = SparseMisses  # keys spot * layers + layer, numbers in units of information; (V124)
NOTHING = Impact(np.empty(0, np.uint32), np.empty(0, np.uint8))


def units_of(variance: float, unit: float) -> int:
    """Return one measurement's information in units, rounded to the nearest; at most 255.

    Raises:
        InputError: a variance that is not > 0, or one that leaves less than half a unit.
    """
    if not (np.isfinite(variance) and variance > 0.0):
        raise InputError(f"sensor: variance must be > 0; got {variance}")
    units = round(1.0 / (variance * unit))
    if units < 1:
        raise InputError(
            f"sensor: a measurement of variance {variance:g} says less than half a unit of {unit:g}"
        )
    return min(units, CERTAIN)


def impact_of(spots: NDArray[np.int64], layers: NDArray[np.int64], each: int, of: int) -> Impact:
    """Return the impact of measurements of so many units each, at spots in layers, ``of`` layers in all."""
    keys, counts = np.unique(spots * of + layers, return_counts=True)
    levels: Misses = np.minimum(counts * each, CERTAIN).astype(np.uint8)
    return Impact(keys.astype(np.uint32), levels)


def clip(impact: Impact, frame: GridFrame, layers: int, reach: Reach) -> Impact:
    """Keep what is measured in cells that any of the boxes touches; spots of all kinds.

    Args:
        impact: what to send.
        frame: the belief's grid.
        layers: the belief's.
        reach: boxes lowest x, lowest y, highest x, highest y [m], team frame.
    """
    row, col = np.divmod(impact.keys // np.uint32(layers) % np.uint32(frame.size), np.uint32(frame.cols))
    inside = np.zeros(len(row), np.bool_)
    for x0, y0, x1, y1 in reach:
        (row0, col0), (row1, col1) = frame.cell(x0, y0), frame.cell(x1, y1)
        inside |= (row0 <= row) & (row <= row1) & (col0 <= col) & (col <= col1)
    return impact if inside.all() else Impact(impact.keys[inside], impact.misses[inside])


def check_claim(impact: Impact, most: int, robots: int) -> None:
    """Raise ``ValueError`` for more units than so many of the team's best sensors measure, ``most``."""
    claimed = int(impact.misses.astype(np.int64).sum())
    if claimed > most:
        raise ValueError(
            f"impact claims {claimed} units of information, too many for {many(robots, 'vehicle')}"
        )


class FieldImpactCodec(MissesCodec):
    """Impacts over so many spots and layers as bytes."""
