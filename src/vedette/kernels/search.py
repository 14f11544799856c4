"""Search on a grid: how a target's density moves, what looks detect, and what paths add to a team's search.

A sparse impact is two parallel arrays: ``keys`` uint32, strictly increasing, ``cell * layers + layer``, and
``misses`` uint8, the log-miss of that layer in steps of 1/16 nat, saturating at 255, ``exp(-255/16)``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels
from vedette.kernels._arrays import floats
from vedette.kernels.misses import Keys, Misses


@dataclass(frozen=True, eq=False)
class Stencil:
    """One step of a target: from a cell to ``first + t`` rows up with ``row_taps[t]``, columns likewise.

    Rows and columns are independent. Moves beyond the grid are reflected at its border, so that mass is kept,
    or the mass is gone.
    """

    first: tuple[int, int]  # smallest move in rows and in columns [cells]
    row_taps: NDArray[np.float64]  # (T,) sum 1
    col_taps: NDArray[np.float64]  # (U,) sum 1
    leaves: bool = False  # whether what moves beyond the grid is gone

    @property
    def reach(self) -> int:
        """How far a target moves in a step at most [cells]."""
        ends = ((start, start + len(taps) - 1) for start, taps in zip(self.first, self.taps, strict=True))
        return max(abs(end) for pair in ends for end in pair)

    @property
    def taps(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Those of the rows and those of the columns."""
        return self.row_taps, self.col_taps

    @property
    def parts(self) -> tuple[tuple[int, int], NDArray[np.float64], NDArray[np.float64], bool]:
        """All of it, as the kernels take it."""
        return self.first, *self.taps, self.leaves


@dataclass(frozen=True, eq=False)
class Paths:
    """N looks that paths share: look n happens one layer after its parent, and is listed after it."""

    parents: NDArray[np.int64]  # (N,) -1 in layer 0
    starts: NDArray[np.int64]  # (N + 1,) bounds of each look's entries
    cells: NDArray[np.uint32]  # (M,) distinct in each look
    misses: Misses  # (M,) log-miss


def propagate(mass: NDArray[np.float64], stencil: Stencil) -> NDArray[np.float64]:
    """``T p``: the density ``(R, C)`` one step later."""
    return _kernels.propagate(floats(mass), *stencil.parts)


def look_footprints(
    shape: tuple[int, int],
    resolution: float,
    poses: NDArray[np.float64],
    table: NDArray[np.float64],
    range: float,
    view: float,
    samples: int,
) -> tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float64]]:
    """``1 - E prod_l (1 - P(|x - y_l|))`` for a target x anywhere in a cell, where that is more than 0.

    Args:
        shape: rows and columns of the grid.
        resolution: cell side [m].
        poses: ``(N, L, 3)`` x, y, heading [m, m, rad] of L looks each, relative to the lower-left corner.
        table: probability of detection in equal steps of the squared distance up to ``range`` [m].
        view: field of view, centred on the heading [rad]; all round from 2 pi on.
        samples: the mean is over ``samples**2`` points of a cell.

    Returns:
        starts ``(N + 1,)``, cells ``(M,)``, ascending for each of N, and probabilities ``(M,)``.
    """
    return _kernels.look_footprints(shape, resolution, floats(poses), floats(table), range, view, samples)


def detected_mass(
    mass: NDArray[np.float64], stencil: Stencil, steps: int, layers: int, keys: Keys, misses: Misses
) -> NDArray[np.float64]:
    """``d_k = sum_x q_k (1 - m_k)`` with ``q_0 = T p``, ``q_{k+1} = T (q_k m_k)``: first detected in layer k.

    Args:
        mass: ``(R, C)`` density before the first step.
        stencil: the target's step.
        steps: the target moves before the first so many layers; later ones are at the same time.
        layers: how many.
        keys, misses: the team's sparse impact.

    Returns:
        ``(layers,)``.
    """
    return _kernels.detected_mass(floats(mass), *stencil.parts, steps, layers, keys, misses)


def path_gains(
    mass: NDArray[np.float64],
    stencil: Stencil,
    steps: int,
    weights: NDArray[np.float64],
    others: tuple[Keys, Misses],
    paths: Paths,
) -> NDArray[np.float64]:
    """``psi(others * path) - psi(others)`` for the path that ends at each look, ``psi = sum_k w_k d_k``.

    Args:
        mass, stencil, steps: as for ``detected_mass``.
        weights: ``(layers,)``; paths are no longer than that.
        others: the rest of the team's sparse impact.
        paths: of one platform.

    Returns:
        ``(N,)``.
    """
    return _kernels.path_gains(
        floats(mass),
        *stencil.parts,
        steps,
        floats(weights),
        *others,
        paths.parents,
        paths.starts,
        paths.cells,
        paths.misses,
    )
