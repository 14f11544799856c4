"""The impact of a course: the information about each target's position that it would bring, step by step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.tracking import Sparse
from vedette.number import many
from vedette.problem import Reach

_ROUNDING = 1e-9  # of a sum, as a share of it


@dataclass(frozen=True, eq=False)
class Impact:
    """``H' R^-1 H`` of the position of some targets at each step; nothing about all others.

    Source: paper, eq. (25), for each step of the horizon; docs/tracking.md (V35).
    """

    targets: NDArray[np.int64]  # (M,) ascending
    blocks: NDArray[np.float64]  # (M, K, 3) symmetric 2x2 as xx, xy, yy [1/m^2], none all zero

    @property
    def sparse(self) -> Sparse:
        """The two arrays, as the kernels take them."""
        return self.targets, self.blocks


def nothing(horizon: int) -> Impact:
    """The impact of a platform that observes nothing: the identity."""
    return Impact(np.empty(0, np.int64), np.empty((0, horizon, 3)))


def impact_of(blocks: NDArray[np.float64], targets: NDArray[np.int64] | None = None) -> Impact:
    """Return blocks (M, K, 3) of these targets, of all if none are named, as an impact."""
    seen = blocks.any(axis=(1, 2))
    targets = np.arange(len(blocks)) if targets is None else targets
    return Impact(targets[seen].astype(np.int64), np.ascontiguousarray(blocks[seen], np.float64))


def combine(a: Impact, b: Impact) -> Impact:
    """``a * b``: information of independent measurements adds (paper, eq. (27))."""
    if len(a.targets) == 0 or len(b.targets) == 0:
        return b if len(a.targets) == 0 else a
    if np.array_equal(a.targets, b.targets):
        return Impact(a.targets, a.blocks + b.blocks)
    targets = np.union1d(a.targets, b.targets)
    blocks = np.zeros((len(targets), *a.blocks.shape[1:]))
    blocks[np.searchsorted(targets, a.targets)] = a.blocks
    blocks[np.searchsorted(targets, b.targets)] += b.blocks
    return Impact(targets, blocks)


def remove(total: Impact, own: Impact) -> Impact:
    """``total * own^-1`` where own is part of total (paper, eq. (31) and its footnote 2)."""
    blocks = total.blocks.copy()
    blocks[np.searchsorted(total.targets, own.targets)] -= own.blocks
    return impact_of(blocks, total.targets)


def of_targets(impact: Impact, some: NDArray[np.bool_]) -> Impact:
    """Return what of an impact is about some of all targets (T,)."""
    kept = some[impact.targets]
    return Impact(impact.targets[kept], impact.blocks[kept])


def clip(impact: Impact, predicted_means: NDArray[np.float64], reach: Reach) -> Impact:
    """Keep the targets whose common track enters a box: for who sees only into the boxes nothing changes.

    Values are lower by a constant, for whoever adds to none of the targets left out.  docs/theory.md (V14)

    Args:
        impact: of any number of platforms.
        predicted_means: (K, T, 4) of the belief.
        reach: boxes lowest x, lowest y, highest x, highest y [m].
    """
    x, y = predicted_means[:, impact.targets, 0, None], predicted_means[:, impact.targets, 1, None]
    x0, y0, x1, y1 = np.array(reach, np.float64).reshape(-1, 4).T
    inside = ((x0 <= x) & (x <= x1) & (y0 <= y) & (y <= y1)).any(axis=(0, 2))
    return impact if inside.all() else Impact(impact.targets[inside], impact.blocks[inside])


def check_claim(impact: Impact, robots: int, most: float) -> None:
    """Raise ``ValueError`` for more information than so many sensors have of a target in a step.

    No direction of one look's ``I`` holds more than ``most`` [1/m^2], so no entry of the sum's diagonal holds
    more than so many times as much.
    """
    largest = float(impact.blocks[..., ::2].max(initial=0.0))
    if largest > robots * most * (1.0 + _ROUNDING):
        raise ValueError(
            f"impact claims {largest:g} / m^2 in a step; {many(robots, 'sensor')} with {most:g} each"
        )


@dataclass(frozen=True, eq=False)
class Impacts(Sequence[Impact]):
    """Impacts of all candidates of a platform, one after another in the same arrays."""

    starts: NDArray[np.int64]  # (C + 1,) bounds of each candidate's rows
    targets: NDArray[np.int64]  # (N,) ascending within a candidate
    blocks: NDArray[np.float64]  # (N, K, 3)

    def __len__(self) -> int:
        return len(self.starts) - 1

    @overload
    def __getitem__(self, index: int) -> Impact: ...
    @overload
    def __getitem__(self, index: slice) -> list[Impact]: ...
    def __getitem__(self, index: int | slice) -> Impact | list[Impact]:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        k = range(len(self))[index]  # IndexError beyond the end
        rows = slice(self.starts[k], self.starts[k + 1])
        return Impact(self.targets[rows], self.blocks[rows])


def stack(own: Sequence[Impact], horizon: int) -> Impacts:
    """Return the impacts as one; free if they are already."""
    if isinstance(own, Impacts):
        return own
    empty = nothing(horizon)
    starts = np.cumsum([0, *(len(impact.targets) for impact in own)], dtype=np.int64)
    targets = np.concatenate([empty.targets, *(impact.targets for impact in own)])
    return Impacts(starts, targets, np.concatenate([empty.blocks, *(impact.blocks for impact in own)]))


def stack_dense(blocks: NDArray[np.float64], targets: NDArray[np.int64]) -> Impacts:
    """Return candidates' blocks (C, M, K, 3) of the same targets (M,) without those that see nothing."""
    seen = blocks.any(axis=(2, 3))
    starts = np.concatenate(([0], np.cumsum(seen.sum(axis=1)))).astype(np.int64)
    return Impacts(starts, np.broadcast_to(targets, seen.shape)[seen], blocks[seen])
