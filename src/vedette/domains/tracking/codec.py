"""Impacts as bytes: the targets that somebody sees, and all their blocks in full precision."""

from __future__ import annotations

import numpy as np

from vedette.domains.tracking.impact import Impact

MOST = 1e14  # of any entry of a block [1/m^2]; sums of so many stay finite
_RANK_ONE = 1e-9  # a matrix that rounding made indefinite by this share still counts as semi-definite


class TrackImpactCodec:
    """A row for each target that somebody sees: its number in four bytes, then K blocks of three float64."""

    def __init__(self, targets: int, horizon: int) -> None:
        self._targets = targets
        self._row = np.dtype([("target", "<u4"), ("block", "<f8", (horizon, 3))])

    def encode(self, impact: Impact) -> bytes:
        """Return the impact as bytes."""
        rows = np.empty(len(impact.targets), self._row)
        rows["target"], rows["block"] = impact.targets, impact.blocks
        return rows.tobytes()

    def decode(self, payload: bytes) -> Impact:
        """Return the impact.

        Raises:
            ValueError: the payload is not an impact on so many targets and steps.
        """
        if len(payload) % self._row.itemsize or len(payload) > self.bound:
            raise ValueError("impact is cut short or too large")
        rows = np.frombuffer(payload, self._row)
        targets, blocks = rows["target"].astype(np.int64), rows["block"].astype(np.float64)
        if np.any(np.diff(targets) <= 0) or np.any(targets >= self._targets):
            raise ValueError("impact has a target twice, out of order or unknown")
        if not np.all(np.abs(blocks) <= MOST):  # nor NaN
            raise ValueError("impact has a number that is not finite or too large")
        if not blocks.any(axis=(1, 2)).all():
            raise ValueError("impact has an empty entry")
        xx, xy, yy = np.moveaxis(blocks, -1, 0)
        if np.any(xx < 0.0) or np.any(yy < 0.0) or np.any(xy * xy > xx * yy * (1.0 + _RANK_ONE)):
            raise ValueError("impact has information that is not positive semi-definite")
        return Impact(targets, blocks)

    @property
    def bound(self) -> int:
        """Largest encoding of any impact [bytes]; no team size in it."""
        return self._targets * self._row.itemsize
