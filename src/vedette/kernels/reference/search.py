"""What the search kernels compute, said densely, cell by cell and path by path."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.misses import STEPS_PER_NAT, Keys, Misses
from vedette.kernels.search import Paths, Stencil


def propagate(mass: NDArray[np.float64], stencil: Stencil) -> NDArray[np.float64]:
    """Twin of ``search.propagate``: one matrix for the rows and one for the columns."""
    rows, cols = mass.shape
    down = _moves(rows, stencil.first[0], stencil.row_taps, stencil.leaves)
    across = _moves(cols, stencil.first[1], stencil.col_taps, stencil.leaves)
    return np.asarray(down @ mass @ across.T)


def _moves(n: int, first: int, taps: NDArray[np.float64], leaves: bool) -> NDArray[np.float64]:
    """Return the (n, n) probabilities of going from a column's index to a row's, by mirrors or open ends."""
    matrix = np.zeros((n, n))
    for start in range(n):
        for t, tap in enumerate(taps):
            end = (start + first + t) % (2 * n)
            if not leaves or start + first + t == end < n:
                matrix[end if end < n else 2 * n - 1 - end, start] += tap
    return matrix


def look_footprints(
    shape: tuple[int, int],
    resolution: float,
    poses: NDArray[np.float64],
    table: NDArray[np.float64],
    range: float,
    view: float,
    samples: int,
) -> tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float64]]:
    """Twin of ``search.look_footprints``: every look at every point of the grid."""
    rows, cols = shape
    fine = (np.arange(cols * samples) + 0.5) * resolution / samples
    x, y = np.meshgrid(fine, (np.arange(rows * samples) + 0.5) * resolution / samples)
    starts, cells, shares = [0], [], []
    for looks in poses:
        missed = np.ones_like(x)
        for look in looks:
            dx, dy = x - look[0], y - look[1]
            square = dx**2 + dy**2
            entry = np.minimum(square / range**2 * len(table), len(table) - 1).astype(int)
            off = np.abs((np.arctan2(dy, dx) - look[2] + np.pi) % (2 * np.pi) - np.pi)
            seen = (square <= range**2) & ((off <= view / 2) | (square == 0) | (view >= 2 * np.pi))
            missed *= 1 - np.where(seen, table[entry], 0.0)
        share = 1 - missed.reshape(rows, samples, cols, samples).mean(axis=(1, 3)).ravel()
        found = np.flatnonzero(share > 0)
        cells.append(found)
        shares.append(share[found])
        starts.append(starts[-1] + len(found))
    return np.array(starts), np.concatenate(cells).astype(np.uint32), np.concatenate(shares)


def detected_mass(
    mass: NDArray[np.float64], stencil: Stencil, steps: int, layers: int, keys: Keys, misses: Misses
) -> NDArray[np.float64]:
    """Twin of ``search.detected_mass``: the forward filter on dense miss probabilities."""
    miss = np.ones((mass.size, layers))
    miss.ravel()[keys] = np.exp(misses / -STEPS_PER_NAT)
    detected = np.zeros(layers)
    for layer in range(layers):
        mass = propagate(mass, stencil) if layer < steps else mass
        left = mass * miss[:, layer].reshape(mass.shape)
        detected[layer] = mass.sum() - left.sum()
        mass = left
    return detected


def path_gains(
    mass: NDArray[np.float64],
    stencil: Stencil,
    steps: int,
    weights: NDArray[np.float64],
    others: tuple[Keys, Misses],
    paths: Paths,
) -> NDArray[np.float64]:
    """Twin of ``search.path_gains``: the whole team's filter with each path less that without."""
    layers = len(weights)
    alone = float(weights @ detected_mass(mass, stencil, steps, layers, *others))
    gains = np.zeros(len(paths.parents))
    for last in range(len(gains)):
        looks = [last]
        while paths.parents[looks[0]] >= 0:
            looks.insert(0, int(paths.parents[looks[0]]))
        total = np.zeros(mass.size * layers)
        total[others[0]] = others[1]
        for layer, look in enumerate(looks):
            row = slice(paths.starts[look], paths.starts[look + 1])
            total[paths.cells[row].astype(np.int64) * layers + layer] += paths.misses[row]
        team = np.flatnonzero(total).astype(np.uint32)
        levels = np.minimum(total[team], 255).astype(np.uint8)
        gains[last] = weights @ detected_mass(mass, stencil, steps, layers, team, levels) - alone
    return gains
