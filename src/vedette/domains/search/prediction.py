"""What looks have detected and what they have left, on cells that are fine enough for the sensors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.detectors import COARSEST, Detector
from vedette.domains.search.motion import WIDEST
from vedette.kernels.search import propagate

Looks: TypeAlias = Sequence[Mapping[int, NDArray[np.float64]]]
"""By vehicle: the poses (L, 3) that it looked from, by the step at whose end they count."""

FINE = 8.0  # parts along the least half width of a sensor, where that takes few cells
FEW, MOST = 1_000_000, 8_000_000  # cells


def parts_of(pdf: TargetPdf, detectors: Sequence[Detector]) -> int:
    """In how many parts a prediction cuts a cell's side, for cells that are fine for every sensor.

    Nothing finer is wanted than half of what the target diffuses in a step: it does not last until the next
    look. Otherwise a half width has 8 cells if the grid is then small, and 2 as long as it is not vast.
    """
    side, size = pdf.frame.resolution, pdf.frame.size
    spread, moved = _spread(pdf), max(map(abs, pdf.motion.drift)) * pdf.dt / side
    lasting = max(1, math.ceil(2.0 * side / spread)) if spread > 0.0 else math.inf
    fine, coarse = (
        max((detector.parts(side, each) for detector in detectors), default=1) for each in (FINE, COARSEST)
    )
    wanted = max(min(fine, math.isqrt(FEW // size)), min(coarse, math.isqrt(MOST // size)))
    return int(max(1, min(wanted, lasting, WIDEST // moved if moved > 0.0 else math.inf)))


def too_coarse(pdf: TargetPdf, detectors: Sequence[Detector]) -> int | None:
    """Return the detector that even a prediction's cells are too large for, if there is one."""
    side = pdf.frame.resolution / parts_of(pdf, detectors)
    widths = [detector.half_width for detector in detectors]
    least = min(range(len(widths)), key=widths.__getitem__)
    return least if side > max(widths[least], _spread(pdf)) else None


def _spread(pdf: TargetPdf) -> float:
    """Standard deviation of what the target diffuses in a step, along each axis [m]."""
    return math.sqrt(2.0 * pdf.motion.diffusion * pdf.dt)


class Undetected:
    """``q_k = (T q_{k-1}) m_k``, ``q_0 = P``: the mass that no look has taken away; docs/search.md (V43).

    A fine cell stands for a target in its middle: a mean over it would let many looks at one part of it
    add up to all of it.
    """

    def __init__(self, pdf: TargetPdf, detectors: Sequence[Detector]) -> None:
        """Begin at step 0 with all of the pdf's mass."""
        self._pdf = pdf.finer(parts_of(pdf, detectors))
        self._stencil, self._detectors = self._pdf.stencil, detectors
        self._left = self._pdf.mass
        self._step = 0
        self.outside = pdf.outside  # probability that the target has left undetected

    @property
    def detected(self) -> float:
        """``C_k``: the probability that the looks so far have detected the target."""
        return 1.0 - self.outside - float(self._left.sum())

    def look(self, looks: Looks) -> None:
        """Go on by a step: the target moves, and everybody looks."""
        self._step += 1
        moved = propagate(self._left, self._stencil)
        if self._stencil.leaves:
            self.outside += max(0.0, float(self._left.sum()) - float(moved.sum()))
        self._left = moved
        for detector, made in zip(self._detectors, looks, strict=True):
            if self._step in made:
                _, cells, detection = detector.footprints(self._pdf.frame, made[self._step][None], least=1)
                self._left.ravel()[cells] *= 1.0 - detection


@dataclass(frozen=True, eq=False)
class Prediction:
    """What becomes of the target by the end of each step, whatever anybody knows of it; (K + 1,) each."""

    detection: NDArray[np.float64]  # C_k: looks by then have detected it; docs/search.md (V43)
    outside: NDArray[np.float64]  # it has left undetected


def predicted(pdf: TargetPdf, detectors: Sequence[Detector], looks: Looks, steps: int) -> Prediction:
    """Return what so many steps of looks come to."""
    undetected, curve = Undetected(pdf, detectors), [(0.0, pdf.outside)]
    for _ in range(steps):
        undetected.look(looks)
        curve.append((undetected.detected, undetected.outside))
    return Prediction(*np.array(curve).T)
