"""What the kernels of alignment compute, angle by angle with NumPy's own transforms."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.align import ALIKE, ELSE, LABELS, QUARTERS, SAME, LaidFaces, Weights

Floats = NDArray[np.float64]

FACING = 0.7  # least cosine between two paired faces' normals
DAMPING = 1e-6  # of a step along which no face tells anything
LEAST = 3  # a pose cannot be told from fewer pairs


def worths(
    a: tuple[NDArray[np.float32], NDArray[np.float32]],
    b: tuple[Floats, Floats],
    angle: float,
    quarters: int,
    weights: Weights,
) -> Floats:
    """Return (V140) for all shifts of B over the torus of A, ``(N, N)``."""
    size = len(a[0])
    walls, free = np.zeros((size, size)), np.zeros((size, size))
    for mask, points in ((free, b[1]), (walls, b[0])):
        rows, cols = _turned(points, angle, quarters)
        mask[rows % size, cols % size] = 1.0
    free[walls > 0.0] = 0.0
    on_walls = weights.walls * walls - weights.clash * free
    on_free = weights.free * free - weights.clash * walls
    pairs = ((a[0], on_walls), (a[1], on_free))
    spectrum = sum(np.fft.fft2(mask) * np.fft.fft2(other).conj() for mask, other in pairs)
    return np.asarray(np.fft.ifft2(spectrum).real)


def align_peaks(
    a: tuple[NDArray[np.float32], NDArray[np.float32]],
    b: tuple[Floats, Floats],
    angles: Floats,
    weights: Weights,
    peaks: int,
    spacing: int,
) -> Floats:
    """Twin of ``align.align_peaks``."""
    found = np.full((len(angles), QUARTERS, peaks, 3), -np.inf)
    for k, quarters in np.ndindex(found.shape[:2]):
        highest = _highest(worths(a, b, float(angles[k]), quarters, weights), peaks, spacing, quarters)
        found[k, quarters, : len(highest)] = highest
    return found


def align_counts(
    labels: NDArray[np.uint8],
    looks: NDArray[np.uint8],
    points: Floats,
    point_looks: NDArray[np.uint8],
    transforms: Floats,
) -> NDArray[np.int64]:
    """Twin of ``align.align_counts``."""
    around, ahead = np.pad(labels & 3, 1), np.pad(looks.astype(int), 1)
    counts = np.zeros((len(transforms), LABELS), np.int64)
    for count, (x, y, angle) in zip(counts, transforms, strict=True):
        c, s = np.cos(angle), np.sin(angle)
        col = np.floor(c * points[:, 0] - s * points[:, 1] + x)
        row = np.floor(s * points[:, 0] + c * points[:, 1] + y)
        at = tuple(
            np.clip(k + 1, 0, n + 1).astype(int) for k, n in zip((row, col), labels.shape, strict=True)
        )
        aside = (ahead[at] - point_looks - np.rint(angle * 128.0 / np.pi).astype(int)) % 256
        found = around[at]
        found[(found == SAME) & (np.minimum(aside, 256 - aside) > ALIKE)] = ELSE
        count[:] = np.bincount(found, minlength=LABELS)
    return counts


def align_fit(
    face_at: NDArray[np.int32],
    cell: float,
    corner: Floats,
    on: tuple[Floats, Floats],
    moving: tuple[Floats, Floats],
    guess: tuple[float, float, float],
    reaches: Floats,
) -> LaidFaces:
    """Twin of ``align.align_fit``."""
    pose, matrix, squares, paired = np.array(guess), np.zeros((3, 3)), 0.0, 0
    for reach in reaches:
        c, s = np.cos(pose[2]), np.sin(pose[2])
        rotation = np.array([[c, -s], [s, c]])
        arms, facing = (each @ rotation.T for each in moving)
        places = arms + pose[:2]
        col, row = np.floor((places - corner) / cell).astype(np.int64).T
        inside = (row >= 0) & (col >= 0) & (row < face_at.shape[0]) & (col < face_at.shape[1])
        which = np.flatnonzero(inside)
        face = face_at[row[which], col[which]]
        near = np.hypot(*(on[0][face] - places[which]).T) <= reach
        kept = near & (np.einsum("ij,ij->i", on[1][face], facing[which]) >= FACING)
        which, face = which[kept], face[kept]
        paired = len(which)
        if paired < LEAST:
            break
        n, arm = on[1][face], arms[which]
        off = np.einsum("ij,ij->i", n, on[0][face] - places[which])
        rows = np.column_stack([n, n[:, 1] * arm[:, 0] - n[:, 0] * arm[:, 1]])
        weight = (1.0 + (off / (reach / 2.0)) ** 2) ** -2.0
        matrix = (rows * weight[:, None]).T @ rows
        damped = matrix + DAMPING * np.trace(matrix) * np.eye(3)
        pose = pose + np.linalg.solve(damped, rows.T @ (weight * off))
        squares = float(weight @ off**2 / weight.sum())
    return LaidFaces(pose, matrix, squares, paired)


def _turned(points: Floats, angle: float, quarters: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return rows and columns of points turned by an angle, and then as cells by quarters."""
    c, s = np.cos(angle), np.sin(angle)
    col = np.floor(c * points[:, 0] - s * points[:, 1] + 0.5).astype(np.int64)
    row = np.floor(s * points[:, 0] + c * points[:, 1] + 0.5).astype(np.int64)
    for _ in range(quarters):
        row, col = col, -row
    return row, col


def _highest(worths: Floats, peaks: int, spacing: int, quarters: int) -> list[tuple[float, int, int]]:
    """Return the highest cells that are apart; the grid is cut into blocks as it lies before the quarters."""
    size = len(worths)
    index = np.arange(size)
    rows, cols = np.meshgrid(index, index, indexing="ij")
    for _ in range(quarters):  # where a cell of the grid before the quarters lies after them
        rows, cols = cols, -rows % size
    before = worths[rows, cols]
    tops = []
    for top in range(0, size, max(spacing, 1)):
        for left in range(0, size, max(spacing, 1)):
            block = before[top : top + max(spacing, 1), left : left + max(spacing, 1)]
            down, right = divmod(int(block.argmax()), block.shape[1])
            tops.append((float(block[down, right]), top + down, left + right))
    kept: list[tuple[float, int, int]] = []
    for worth, row, col in sorted(tops, key=lambda top: (-top[0], top[1], top[2])):
        if len(kept) < peaks and all(
            _apart(row, r, size, spacing) or _apart(col, c, size, spacing) for _, r, c in kept
        ):
            kept.append((worth, row, col))
    return [(worth, int(rows[row, col]), int(cols[row, col])) for worth, row, col in kept]


def _apart(p: int, q: int, size: int, spacing: int) -> bool:
    gap = abs(p - q)
    return min(gap, size - gap) > spacing
