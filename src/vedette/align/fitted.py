"""Lay B's walls on A's by least squares, from a first guess."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.align.charted import Charted
from vedette.align.pose import FramePose

Floats = NDArray[np.float64]

REACHES = (
    0.8,
    0.8,
    0.8,
    0.5,
    0.5,
    0.3,
    0.3,
    0.3,
    0.2,
    0.2,
)  # within which walls are paired, step by step [m]
FACING = 0.7  # least cosine between two paired walls' normals
INDEPENDENT = 0.5  # walls as far apart tell each for itself [m]
FLOOR = 0.02  # of a wall's deviation from where it is mapped [m]
_DAMPING = 1e-6  # of a step along which no wall tells anything
_SINGULAR = 1e-6  # walls' worth of information that every direction is taken to have


@dataclass(frozen=True, eq=False)
class Fit:
    """Where B lies on A by the walls that both have."""

    pose: FramePose  # T_a_b between the middles
    covariance: Floats  # (3, 3) of x, y, angle [m, m, rad]^2
    paired: int  # walls of B that had one of A


def fitted(a: Charted, b: Charted, guess: FramePose, walls: int) -> Fit:
    """Return the pose of least squares over the distances along A's normals, (V142), with its covariance.

    Args:
        a: whose walls stay.
        b: whose walls move.
        guess: T_a_b between the middles.
        walls: how many of B's are used at most, evenly drawn.
    """
    step = max(1, len(b.walls) // walls)
    points, normals = b.walls[::step], b.normals[::step]
    pose, paired = guess, 0
    matrix, squares = np.zeros((3, 3)), 0.0
    for reach in REACHES:
        moved, facing = pose.places(points), normals @ pose.rotation.T
        which, face = _paired(a, moved, facing, reach)
        paired = len(which)
        if paired < 3:
            break
        n = a.normals[face]
        off = np.einsum("ij,ij->i", n, a.walls[face] - moved[which])
        arm = moved[which] - (pose.x, pose.y)
        rows = np.column_stack([n, n[:, 1] * arm[:, 0] - n[:, 0] * arm[:, 1]])
        weight = 1.0 / (1.0 + (off / (reach / 2.0)) ** 2) ** 2
        matrix = (rows * weight[:, None]).T @ rows
        x, y, turn = np.linalg.solve(
            matrix + _DAMPING * np.trace(matrix) * np.eye(3), rows.T @ (weight * off)
        )
        pose = FramePose.of(pose.x + float(x), pose.y + float(y), pose.angle + float(turn))
        squares = float(weight @ off**2 / weight.sum())
    spread = (FLOOR**2 + squares) * max(1.0, INDEPENDENT / (b.cell * step))
    covariance = np.asarray(np.linalg.inv(matrix + _SINGULAR * np.eye(3)) * spread, np.float64)
    return Fit(pose, covariance, paired * step)


def _paired(
    a: Charted, moved: Floats, facing: Floats, reach: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return which points have a wall of A within reach that faces as theirs does, and which wall."""
    col, row = np.floor((moved - a.corner) / a.cell).astype(np.int64).T
    inside = (row >= 0) & (col >= 0) & (row < a.frame.rows) & (col < a.frame.cols)
    which = np.flatnonzero(inside)
    face = a.face_at[row[which], col[which]].astype(np.int64)
    near = np.hypot(*(a.walls[face] - moved[which]).T) <= reach
    alike = np.einsum("ij,ij->i", a.normals[face], facing[which]) >= FACING
    return which[near & alike], face[near & alike]
