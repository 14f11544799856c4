"""Lay B's walls on A's by least squares, from a first guess."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.align.charted import Charted
from vedette.align.pose import FramePose
from vedette.kernels.align import align_fit

Floats = NDArray[np.float64]

REACHES = np.array([0.8] * 3 + [0.5] * 2 + [0.3] * 3 + [0.2] * 2)  # walls are paired within, by step [m]
INDEPENDENT = 0.5  # walls as far apart tell each for itself [m]
FLOOR = 0.02  # of a wall's deviation from where it is mapped [m]
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
    moving = b.walls[::step], b.normals[::step]
    laid = align_fit(
        a.face_at, a.cell, a.corner, (a.walls, a.normals), moving, (guess.x, guess.y, guess.angle), REACHES
    )
    spread = (FLOOR**2 + laid.squares) * max(1.0, INDEPENDENT / (b.cell * step))
    covariance = np.asarray(np.linalg.inv(laid.matrix + _SINGULAR * np.eye(3)) * spread, np.float64)
    return Fit(FramePose.of(*laid.pose.tolist()), covariance, laid.paired * step)
