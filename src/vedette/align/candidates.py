"""Where one map may lie on another, best first, with what speaks for and against each place."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.align.agreement import agreement, own_frames
from vedette.align.charted import Charted
from vedette.align.fitted import Fit, fitted
from vedette.align.pose import FramePose
from vedette.align.shifts import likely

Floats = NDArray[np.float64]

LIKELY = 24  # places from the large cells that are looked at closely
ROUGHLY, FINELY = 800, 8000  # walls used to fit a candidate, and the best of them
DISTINCT = 0.75, math.radians(6.0)  # closer candidates are one [m, rad]
OUT = 0.03, 2.0  # by so much more than the best contradicted, in so much wall, a place is no rival [1, m]
CLASH = 5.0  # metres of wall that one metre of wall on clear ground costs


@dataclass(frozen=True, eq=False)
class PossibleJoin:
    """One place of B on A."""

    pose: FramePose  # T_a_b between the maps' own frames
    score: float  # walls that both have less those that the other contradicts [m]
    same: float  # walls of each that lie on the other's, in the mean [m]
    against: float  # walls of each on the other's clear ground, in the mean [m]
    contradicted: float  # of the walls that the other could see, their share, 0..1
    common: float  # ground that both know [m^2]
    overlap: float  # its share of what the map that knows less knows, 0..1
    covariance: Floats  # (3, 3) of the pose [m, m, rad]^2, as B's middle moves

    @property
    def deviation(self) -> float:
        """Standard deviation in the direction in which B's middle is least certain [m]."""
        return math.sqrt(max(0.0, float(np.linalg.eigvalsh(self.covariance[:2, :2])[-1])))

    def out(self, best: PossibleJoin) -> bool:
        """Whether so many more walls speak against this place than against the best that it is no rival."""
        return self.contradicted > best.contradicted + OUT[0] and self.against > best.against + OUT[1]


@dataclass(frozen=True, eq=False)
class Alignment:
    """All that speaks for and against laying B onto A."""

    candidates: tuple[PossibleJoin, ...]  # by score, best first; none if no wall met another

    @property
    def possible(self) -> list[PossibleJoin]:
        """The best candidate and its rivals, by score: all but those that walls speak against."""
        return [candidate for candidate in self.candidates if not candidate.out(self.candidates[0])]

    @property
    def rivalry(self) -> float:
        """Score of the best rival over that of the best, (V143), 0..1; 1 where nothing has a score."""
        first, second = self._scores
        return min(1.0, second / first) if first > 0.0 else 1.0

    @property
    def lead(self) -> float:
        """Score of the best less that of its best rival [m of wall]."""
        first, second = self._scores
        return first - second

    @property
    def _scores(self) -> tuple[float, float]:
        first, second, *_ = [max(0.0, candidate.score) for candidate in self.possible] + [0.0, 0.0]
        return first, second


def align(a: Charted, b: Charted) -> Alignment:
    """Return where B may lie on A: likely places from a correlation, each fitted and weighed."""
    return compared(a, b, likely(a, b, LIKELY))


def compared(a: Charted, b: Charted, guesses: Sequence[FramePose]) -> Alignment:
    """Return what some places of B on A, between their middles, come to."""
    rough = [fitted(a, b, guess, ROUGHLY) for guess in guesses]
    found = _distinct([(weighed(a, b, fit), fit) for fit in rough], b.middle)
    if not found:
        return Alignment(())
    fine = weighed(a, b, fitted(a, b, found[0][1].pose, FINELY))
    return Alignment((fine, *(candidate for candidate, _ in found[1:])))


def _distinct(found: Sequence[tuple[PossibleJoin, Fit]], at: Floats) -> list[tuple[PossibleJoin, Fit]]:
    """Return the candidates by score, of those that came to the same place the best."""
    kept: list[tuple[PossibleJoin, Fit]] = []
    for candidate, fit in sorted(found, key=lambda each: -each[0].score):
        gaps = [candidate.pose.apart(other.pose, at) for other, _ in kept]
        if all(shift > DISTINCT[0] or turn > DISTINCT[1] for shift, turn in gaps):
            kept.append((candidate, fit))
    return kept


def weighed(a: Charted, b: Charted, fit: Fit) -> PossibleJoin:
    """Return a fit with what speaks for and against it."""
    agrees = agreement(a, b, fit.pose)
    least = min(len(a.free) * a.cell**2, len(b.free) * b.cell**2)
    return PossibleJoin(
        pose=own_frames(a, b, fit.pose),
        score=agrees.same - CLASH * agrees.against,
        same=agrees.same,
        against=agrees.against,
        contradicted=agrees.contradicted,
        common=agrees.common,
        overlap=min(1.0, agrees.common / least),
        covariance=fit.covariance,
    )
