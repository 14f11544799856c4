"""Where a grid of walls and free ground may lie on another, and how well it lies there.

Points are x, y in cells; angles are radians, counter-clockwise. Arrays that do not fit raise ``ValueError``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels
from vedette.kernels._arrays import floats

QUARTERS = 4
NOWHERE, SAME, CLEAR, ELSE = range(4)  # labels: unknown, near a wall, clear of walls, other known ground
LABELS = 4
ALIKE = 43  # so far two faces that look alike may differ [1/256 of a turn]


class Weights(NamedTuple):
    """What the common cells count: *a*, *b*, *c* of ``a WW - b (WF + FW) + c FF``."""

    walls: float  # a wall on a wall
    clash: float  # a wall on free ground
    free: float  # free ground on free ground


class LaidFaces(NamedTuple):
    """Where faces of one map came to lie on those of another, and what that rests on."""

    pose: NDArray[np.float64]  # (3,) x, y [m] and angle [rad] that the moved faces were turned and moved by
    matrix: NDArray[np.float64]  # (3, 3) of the last step's normal equations, in x, y, angle
    squares: float  # mean of the squared distances along the normals, by weight [m^2]
    paired: int  # faces that had one of the other map


def align_peaks(
    a: tuple[NDArray[np.float32], NDArray[np.float32]],
    b: tuple[NDArray[np.float64], NDArray[np.float64]],
    angles: NDArray[np.float64],
    weights: Weights,
    peaks: int,
    spacing: int,
) -> NDArray[np.float64]:
    """Return where B laid onto A counts most by (V140), over all shifts, for each angle and quarter turns.

    A lies on a torus, whose sides have to be longer than A's and B's together. B is turned about its own
    origin; each of its points marks the cell that holds it, walls before free ground.

    Args:
        a: ``(N, N)`` walls and free ground, each 0 to 1.
        b: ``(n, 2)`` points of walls and ``(m, 2)`` of free ground [cells], from B's origin.
        angles: ``(K,)`` [rad], within a quarter turn.
        weights: of the common cells.
        peaks: how many of each angle, at least ``spacing`` cells apart.
        spacing: [cells]

    Returns:
        ``(K, 4, peaks, 3)``: worth, and row and column of A where B's origin lies, highest first, by angle
        and quarters added to it; ``-inf`` where there are no more.
    """
    masks = tuple(np.ascontiguousarray(mask, dtype=np.float32) for mask in a)
    points = tuple(floats(each).reshape(-1, 2) for each in b)
    found = _kernels.align_peaks(masks, points, floats(angles), tuple(weights), (peaks, spacing))
    return found.reshape(-1, QUARTERS, peaks, 3)


def align_counts(
    labels: NDArray[np.uint8],
    looks: NDArray[np.uint8],
    points: NDArray[np.float64],
    point_looks: NDArray[np.uint8],
    transforms: NDArray[np.float64],
) -> NDArray[np.int64]:
    """Return how many faces of walls fall on cells of each label, under each transform; outside is label 0.

    Args:
        labels: ``(R, C)``, 0 to 3. `SAME` counts for faces that look as the cell's does, within `ALIKE`; for
            others it is `ELSE`.
        looks: ``(R, C)`` which way the face nearest to each cell looks, in 1/256 of a turn.
        points: ``(n, 2)`` of the faces [cells].
        point_looks: ``(n,)`` which way they look.
        transforms: ``(T, 3)`` x, y [cells] and angle [rad]: a face is turned about the origin, then moved.

    Returns:
        ``(T, 4)``.
    """
    grid = tuple(np.ascontiguousarray(each, dtype=np.uint8) for each in (labels, looks))
    faces = floats(points).reshape(-1, 2), np.ascontiguousarray(point_looks, dtype=np.uint8)
    return _kernels.align_counts((grid[0], grid[1]), faces, floats(transforms).reshape(-1, 3))


def align_fit(
    face_at: NDArray[np.int32],
    cell: float,
    corner: NDArray[np.float64],
    on: tuple[NDArray[np.float64], NDArray[np.float64]],
    moving: tuple[NDArray[np.float64], NDArray[np.float64]],
    guess: tuple[float, float, float],
    reaches: NDArray[np.float64],
) -> LaidFaces:
    """Return the pose of least squares over the distances along the normals of the map that stays, (V142).

    Args:
        face_at: ``(R, C)`` which face of the map that stays is nearest to each cell.
        cell: side of those cells [m].
        corner: ``(2,)`` of the first of them [m].
        on: ``(n, 2)`` faces of the map that stays [m], and their normals, unit vectors.
        moving: ``(m, 2)`` faces of the other map [m], and their normals.
        guess: x, y [m] and angle [rad]: the other map is turned about the origin, then moved.
        reaches: within which faces are paired, one step of Gauss and Newton each [m].
    """
    grid = np.ascontiguousarray(face_at, dtype=np.int32), cell, tuple(corner)
    pairs = [tuple(floats(each).reshape(-1, 2) for each in pair) for pair in (on, moving)]
    told = _kernels.align_fit(grid, pairs[0], pairs[1], guess, floats(reaches))
    matrix = np.zeros((3, 3))
    matrix[np.triu_indices(3)] = told[3:9]
    matrix.T[np.triu_indices(3)] = told[3:9]
    return LaidFaces(told[:3], matrix, float(told[9]), int(told[10]))
