"""What the tracking kernels compute, said with NumPy's own linear algebra."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.tracking import ChainMotion, Measure, Sparse

_POSITION = np.eye(2, 4)  # H: the position part of x, y, vx, vy


def information(block: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return xx, xy, yy (..., 3) as the matrices ``H' J H`` (..., 4, 4)."""
    xx, xy, yy = np.moveaxis(block, -1, 0)
    matrices = np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2)
    return np.asarray(_POSITION.T @ matrices @ _POSITION)


def predicted(tracks: ChainMotion, target: int, covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """``F P F' + Q``."""
    f = tracks.transitions[target]
    return np.asarray(f @ covariance @ f.T + tracks.noises[target])


def updated(covariance: NDArray[np.float64], info: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(1 + P I)^-1 P``: what is left of a covariance, singular or not."""
    return np.asarray(np.linalg.solve(np.eye(4) + covariance @ info, covariance), np.float64)


def score(tracks: ChainMotion, measure: Measure, target: int, block: NDArray[np.float64]) -> float:
    """Return one target's measure after the information (K, 3): gains are differences of it."""
    covariance, total = tracks.covariances[target], 0.0
    for info in information(block):
        prior = predicted(tracks, target, covariance)
        total += 0.5 * float(np.linalg.slogdet(np.eye(4) + prior @ info)[1])
        covariance = updated(prior, info)
    match measure:
        case "trajectory":
            return total
        case "final-logdet":
            return -0.5 * float(np.linalg.slogdet(covariance)[1])
        case "final-trace":
            return -float(np.trace(covariance[:2, :2]))


def chain_values(
    tracks: ChainMotion, measure: Measure, others: Sparse, starts: NDArray[np.int64], own: Sparse
) -> NDArray[np.float64]:
    """Twin of ``tracking.chain_values``: the sum over all targets, from the beginning for every candidate."""
    shape = (len(tracks.covariances), *others[1].shape[1:])
    team = np.zeros(shape)
    team[others[0]] = others[1]
    open_loop = [score(tracks, measure, t, np.zeros(shape[1:])) for t in range(shape[0])]
    values = []
    for first, last in pairwise(starts):
        both = team.copy()
        both[own[0][first:last]] += own[1][first:last]
        values.append(sum(score(tracks, measure, t, both[t]) - open_loop[t] for t in range(shape[0])))
    return np.array(values, np.float64)


def chain_gradient(tracks: ChainMotion, measure: Measure, team: Sparse) -> NDArray[np.float64]:
    """Twin of ``tracking.chain_gradient``: the derivative of every covariance by every number, forward.

    ``dP_{k|k-1} = F dP F'``, ``d(1/2 ln det(1 + P I)) = 1/2 tr((1 + P I)^-1 (dP I + P dI))`` and
    ``dP_k = (1 + P I)^-1 (dP - P dI P_k - dP I P_k)``.
    """
    targets, blocks = team
    slopes = np.zeros_like(blocks)
    units = information(np.eye(3))
    for row, target in enumerate(targets):
        for at in np.ndindex(blocks.shape[1:]):
            covariance, change = tracks.covariances[target], np.zeros((4, 4))
            for k, info in enumerate(information(blocks[row])):
                prior = predicted(tracks, int(target), covariance)
                f = tracks.transitions[target]
                moved = f @ change @ f.T
                more = units[at[1]] if k == at[0] else np.zeros((4, 4))
                left = np.linalg.inv(np.eye(4) + prior @ info)
                covariance = left @ prior
                if measure == "trajectory":
                    slopes[row][at] += 0.5 * np.trace(left @ (moved @ info + prior @ more))
                change = left @ (moved - (prior @ more + moved @ info) @ covariance)
            if measure == "final-logdet":
                slopes[row][at] = -0.5 * np.trace(np.linalg.solve(covariance, change))
            elif measure == "final-trace":
                slopes[row][at] = -np.trace(change[:2, :2])
    return slopes
