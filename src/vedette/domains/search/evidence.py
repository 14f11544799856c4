"""Log-likelihoods of reports as integers: what robots add up to share what they saw."""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LEVELS_PER_NAT = 1024.0
MOST = 64 * 1024  # levels one step's evidence of one robot may have in a cell, either sign


@dataclass(frozen=True, eq=False)
class Evidence:
    """A sparse grid of log-likelihood ratios, rounded once: sums are exact in any order and grouping."""

    cells: NDArray[np.uint32]  # (M,) strictly increasing flat cells
    levels: NDArray[np.int64]  # (M,) [1/1024 nat], not 0

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Evidence)
            and np.array_equal(self.cells, other.cells)
            and np.array_equal(self.levels, other.levels)
        )

    def __hash__(self) -> int:
        return hash((self.cells.tobytes(), self.levels.tobytes()))

    def __add__(self, other: Evidence) -> Evidence:
        return _summed(np.concatenate((self.cells, other.cells)), np.concatenate((self.levels, other.levels)))

    @property
    def log_likelihood(self) -> NDArray[np.float64]:
        """``(M,)`` [nat], for ``TargetPdf.observe(evidence.cells, ...)``."""
        return self.levels / LEVELS_PER_NAT


NO_EVIDENCE = Evidence(np.empty(0, np.uint32), np.empty(0, np.int64))


def evidence(cells: NDArray[np.uint32], log_likelihood: NDArray[np.float64]) -> Evidence:
    """Round log-likelihood ratios [nat] in distinct cells to levels, at most 64 nat either way."""
    levels = np.clip(np.rint(np.asarray(log_likelihood) * LEVELS_PER_NAT), -MOST, MOST)
    return _summed(cells, levels.astype(np.int64))


def _summed(cells: NDArray[np.uint32], levels: NDArray[np.int64]) -> Evidence:
    distinct, where = np.unique(cells, return_inverse=True)
    total = np.zeros(len(distinct), np.int64)
    np.add.at(total, where, levels)
    return Evidence(distinct[total != 0].astype(np.uint32), total[total != 0])


class EvidenceCodec:
    """Evidence as bytes: cells by gaps, levels apart, deflated."""

    def __init__(self, cells: int) -> None:
        """Take the grid's number of cells."""
        self._cells = cells

    def encode(self, evidence: Evidence) -> bytes:
        """Return the evidence as bytes."""
        gaps = np.diff(evidence.cells.astype(np.int64), prepend=0).astype("<u4")
        return zlib.compress(gaps.tobytes() + evidence.levels.astype("<i4").tobytes(), 6, wbits=-15)

    def decode(self, payload: bytes) -> Evidence:
        """Return the evidence.

        Raises:
            ValueError: the payload is not evidence over this many cells.
        """
        try:
            unpacker = zlib.decompressobj(wbits=-15)
            body = unpacker.decompress(payload, 8 * self._cells + 1)
        except zlib.error as error:
            raise ValueError(f"evidence does not inflate: {error}") from None
        if not unpacker.eof or unpacker.unused_data or len(body) % 8:
            raise ValueError("evidence is cut short or too large")
        count = len(body) // 8
        gaps = np.frombuffer(body, "<u4", count).astype(np.int64)
        levels = np.frombuffer(body, "<i4", count, 4 * count).astype(np.int64)
        cells = np.cumsum(gaps)
        if np.any(gaps[1:] == 0) or np.any(levels == 0) or (count and cells[-1] >= self._cells):
            raise ValueError("evidence has a cell twice, an empty entry, or a cell outside the area")
        return Evidence(cells.astype(np.uint32), levels)
