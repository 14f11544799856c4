"""Walls that lie askew in the cells, drawn from several robots' maps: beside them is no ground to see."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.framed import Maker
from vedette.fusion.tiles import CLASSES
from vedette.kernels.tiles import Tiling
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame

_BESIDE = np.array([(row, col) for row in (-1, 0, 1) for col in (-1, 0, 1)])


def closed(classes: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return ``(R, C)`` classes in which unknown cells beside an occupied one, or at its corner, are too."""
    walls = np.pad(classes == OCCUPIED, 1)
    across = walls[:, :-2] | walls[:, 1:-1] | walls[:, 2:]
    beside = across[:-2] | across[1:-1] | across[2:]
    return np.where((classes == UNKNOWN) & beside, np.uint8(OCCUPIED), classes)


def sealed(
    classes: NDArray[np.uint8], window: GridFrame, frame: GridFrame, makers: Iterable[Maker]
) -> NDArray[np.uint8]:
    """Return ``(R, C)`` classes without the gaps that walls get by being drawn in another frame.

    Where free ground meets what nobody knows, that is wall if it is beside one in the map of anybody who
    has made this one, as that robot has it.

    Args:
        classes: in ``window``.
        window: where these cells lie.
        frame: of everybody's cells, each about the origin of its own frame.
        makers: of the map.
    """
    free = np.pad(classes == FREE, 1)
    beside = free[:-2, 1:-1] | free[2:, 1:-1] | free[1:-1, :-2] | free[1:-1, 2:]
    cells = np.flatnonzero((classes == UNKNOWN) & beside)
    wall, middles = np.zeros(len(cells), np.bool_), window.centres(cells)
    for maker in makers:
        wall |= _beside_walls(maker, frame, middles)
    closed_too = classes.copy()
    closed_too.ravel()[cells[wall]] = OCCUPIED
    return closed_too


def _beside_walls(maker: Maker, frame: GridFrame, places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which places are in a cell of its maker's beside an occupied one, or at its corner."""
    own = maker.there.inverse().places(places)
    at = np.floor((own[:, ::-1] - (frame.origin_y, frame.origin_x)) / frame.resolution).astype(np.int64)
    near = at[:, None] + _BESIDE
    inside = ((near >= 0) & (near < frame.shape)).all(axis=2)
    tiles, cells = Tiling(*frame.shape).split(near[inside] @ (frame.cols, 1))
    held, of = np.unique(tiles, return_inverse=True)
    walls = np.zeros(inside.shape, np.bool_)
    walls[inside] = CLASSES[maker.codes.read(held)[of, cells]] == OCCUPIED
    return np.asarray(walls.any(axis=1))
