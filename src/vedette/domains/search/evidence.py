"""Log-likelihoods of reports as integers: what robots add up to share what they saw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.detectors import LEAST_MISS, Detector, Report
from vedette.maps import GridFrame

LEVELS_PER_NAT = 1024.0
MOST = 64 * 1024  # levels one step's evidence of one robot may have in a cell, either sign


@dataclass(frozen=True, eq=False)
class LookEvidence:
    """A sparse grid of log-likelihood ratios, rounded once: sums are exact in any order and grouping."""

    cells: NDArray[np.uint32]  # (M,) strictly increasing flat cells
    levels: NDArray[np.int64]  # (M,) [1/1024 nat], not 0

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, LookEvidence)
            and np.array_equal(self.cells, other.cells)
            and np.array_equal(self.levels, other.levels)
        )

    def __hash__(self) -> int:
        return hash((self.cells.tobytes(), self.levels.tobytes()))

    def __add__(self, other: LookEvidence) -> LookEvidence:
        return _summed(np.concatenate((self.cells, other.cells)), np.concatenate((self.levels, other.levels)))

    @property
    def log_likelihood(self) -> NDArray[np.float64]:
        """``(M,)`` [nat], for ``TargetPdf.observe(evidence.cells, ...)``."""
        return self.levels / LEVELS_PER_NAT


NO_EVIDENCE = LookEvidence(np.empty(0, np.uint32), np.empty(0, np.int64))


def evidence(cells: NDArray[np.uint32], log_likelihood: NDArray[np.float64]) -> LookEvidence:
    """Round log-likelihood ratios [nat] in distinct cells to levels, at most 64 nat either way."""
    levels = np.clip(np.rint(np.asarray(log_likelihood) * LEVELS_PER_NAT), -MOST, MOST)
    return _summed(cells, levels.astype(np.int64))


def _summed(cells: NDArray[np.uint32], levels: NDArray[np.int64]) -> LookEvidence:
    distinct, where = np.unique(cells, return_inverse=True)
    total = np.zeros(len(distinct), np.int64)
    np.add.at(total, where, levels)
    return LookEvidence(distinct[total != 0].astype(np.uint32), total[total != 0])


def evidence_of_looks(
    detector: Detector, frame: GridFrame, poses: NDArray[np.float64], reports: Sequence[Report]
) -> LookEvidence:
    """Evidence of the looks of one step, from poses ``(L, 3)``: those without a report together.

    ``ln (1 - P)`` with P the probability that at least one of them detects, as plans take it; a report by
    ``Detector.log_likelihood``.
    """
    silent = np.array([report is None for report in reports], bool)
    total = NO_EVIDENCE
    if silent.any():
        _, cells, detection = detector.footprints(frame, poses[silent][None])
        total += evidence(cells, np.log(np.maximum(1.0 - detection, LEAST_MISS)))
    for pose, report in zip(poses, reports, strict=True):
        if report is not None:
            total += evidence(*detector.log_likelihood(frame, pose, report))
    return total
