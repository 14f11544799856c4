"""What position information about Gaussian tracks is worth over a horizon, and its gradient.

Information is sparse: ``targets`` (M,) int64, each once, and ``blocks`` (M, K, 3), for each step of the
horizon the symmetric 2x2 matrix ``H' R^-1 H`` of the target's position as xx, xy, yy [1/m^2]. Else zero.
"""

from __future__ import annotations

from typing import Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels

Measure: TypeAlias = Literal["trajectory", "final-logdet", "final-trace"]
Sparse: TypeAlias = tuple[NDArray[np.int64], NDArray[np.float64]]  # targets, blocks


class ChainMotion(NamedTuple):
    """The tracks before the first step and how they move: ``P' = F P F' + Q``; state x, y, vx, vy."""

    covariances: NDArray[np.float64]  # (T, 4, 4) [m, m, m/s, m/s]^2
    transitions: NDArray[np.float64]  # (T, 4, 4)
    noises: NDArray[np.float64]  # (T, 4, 4) as covariances; may be singular


def chain_values(
    tracks: ChainMotion, measure: Measure, others: Sparse, starts: NDArray[np.int64], own: Sparse
) -> NDArray[np.float64]:
    """``value(others * own_c)`` for every candidate c, summed over the targets, 0 where nobody observes.

    With ``P_k = (P_{k|k-1}^-1 + I_k)^-1`` and ``P_{k|k-1} = F P_{k-1} F' + Q`` a target's value is
    ``sum_k 1/2 ln det(1 + P_{k|k-1} I_k)`` for ``trajectory``; for ``final-logdet`` and ``final-trace`` it is
    what is taken off ``1/2 ln det P_K`` and off the position's part of ``tr P_K``.
    docs/tracking.md (V36), (V37)

    Args:
        tracks: T targets; any positive semi-definite covariance for ``trajectory`` and ``final-trace``.
        measure: whose value.
        others: the rest of the team.
        starts: (C + 1,) bounds of each candidate's rows in ``own``.
        own: the candidates' information, one after another.

    Returns:
        (C,) values [nat], or [m^2] for ``final-trace``.
    """
    return _kernels.track_values(tracks, measure, others, starts, own)


def chain_gradient(tracks: ChainMotion, measure: Measure, team: Sparse) -> NDArray[np.float64]:
    """Derivative of the value in ``chain_values`` by each number in the team's blocks, (M, K, 3); (V38)."""
    return _kernels.track_gradient(tracks, measure, team)
