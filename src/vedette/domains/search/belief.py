"""Where the target may be: a probability on a grid, and its snapshot that a round is decided on."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.motion import STILL, TargetMotion
from vedette.domains.search.worth import Worth
from vedette.errors import InputError
from vedette.kernels import search
from vedette.kernels.search import Stencil
from vedette.maps import GridFrame


@dataclass(frozen=True, eq=False)
class TargetPdf:
    """Probability that the target is in each cell, and that it has left the area, at a step boundary.

    Raises:
        InputError: a wrong shape, a negative or not finite probability, no mass, a step that is not positive.
    """

    frame: GridFrame
    mass: NDArray[np.float64]  # (R, C), sum 1 (made so) with what is outside
    motion: TargetMotion = STILL
    dt: float = 1.0  # length of a step [s]
    step: int = 0  # number of steps since the mission began
    outside: float = 0.0  # probability that it has left, for good

    def __post_init__(self) -> None:
        if not (math.isfinite(self.dt) and self.dt > 0.0):
            raise InputError(f"step length must be a number > 0 s; got {self.dt}")
        mass = normalised(self.frame, self.mass, "pdf", self.outside)
        object.__setattr__(self, "mass", mass)
        if self.outside > 0.0:
            object.__setattr__(self, "outside", max(0.0, 1.0 - float(mass.sum())))

    @property
    def stencil(self) -> Stencil:
        """One step of the target."""
        return self.motion.stencil(self.frame.resolution, self.dt)

    def predict(self, steps: int = 1) -> TargetPdf:
        """``P(x_{k+n}) = T^n P(x_k)``: the mass moves, none is lost unseen (paper, eq. (2)); (V41)."""
        mass, stencil = self.mass, self.stencil
        for _ in range(steps):
            mass = search.propagate(mass, stencil)
        outside = max(0.0, 1.0 - float(mass.sum())) if self.motion.leaves else 0.0
        return replace(self, mass=mass, step=self.step + steps, outside=outside)

    def finer(self, parts: int) -> TargetPdf:
        """Return the same density on cells of which ``parts x parts`` make up one of these."""
        if parts == 1:
            return self
        shares = np.repeat(np.repeat(self.mass, parts, axis=0), parts, axis=1) / parts**2
        return replace(self, frame=self.frame.finer(parts), mass=shares)

    def observe(self, cells: NDArray[np.integer], log_likelihood: NDArray[np.float64]) -> TargetPdf:
        """``P(x | z) ~ P(x) p(z | x)``: Bayes' rule (paper, eq. (3)); docs/search.md (V42).

        Args:
            cells: ``(M,)`` distinct flat cells.
            log_likelihood: ``(M,)`` of the reports there [nat], relative to that in all other cells and
                outside (0).
        """
        log_mass = np.log(self.mass, where=self.mass > 0.0, out=np.full(self.frame.shape, -np.inf))
        log_mass.ravel()[cells] += log_likelihood
        log_outside = math.log(self.outside) if self.outside > 0.0 else -math.inf
        most = max(float(log_mass.max()), log_outside)
        return replace(self, mass=np.exp(log_mass - most), outside=math.exp(log_outside - most))

    @property
    def entropy(self) -> float:
        """``-sum P ln P`` [nat], what is outside as one more cell."""
        all_mass = np.append(self.mass, self.outside)
        positive = all_mass[all_mass > 0.0]
        return max(0.0, float(-(positive * np.log(positive)).sum()))

    @property
    def best_cell(self) -> tuple[int, int]:
        """Row and column of the most probable cell, the first among equals."""
        row, col = divmod(int(np.argmax(self.mass)), self.frame.cols)
        return row, col

    def probability_in(self, region: NDArray[np.bool_]) -> float:
        """Probability that the target is in a region, a mask ``(R, C)``."""
        return float(self.mass[region].sum())

    def probability_near(self, x: float, y: float, radius: float) -> float:
        """Probability that the target is in a cell whose centre is within ``radius`` [m] of a place."""
        frame = self.frame
        rows = frame.origin_y + (np.arange(frame.rows) + 0.5) * frame.resolution - y
        cols = frame.origin_x + (np.arange(frame.cols) + 0.5) * frame.resolution - x
        return self.probability_in(rows[:, None] ** 2 + cols**2 <= radius**2)


@dataclass(frozen=True, eq=False)
class SearchBelief:
    """What a round of searching is decided on: the target's density and what detecting it is worth when.

    Layers k = 0 .. ``horizon`` - 1 are the looks at the end of step ``step`` + k + 1. Any more are what
    platforms promise to search afterwards, of a target that stays where it is at the end of the horizon.
    """

    frame: GridFrame
    mass: NDArray[np.float64]  # (R, C) at step `step`, sum 1 less what has left
    stencil: Stencil  # of a step
    dt: float  # [s]
    step: int
    worth: Worth
    committed: int = 0  # first steps of the horizon in which everybody flies on as planned before

    @property
    def horizon(self) -> int:
        """Number of steps that are planned."""
        return self.worth.horizon

    @property
    def layers(self) -> int:
        """Number of layers in an impact, the promises' included."""
        return len(self.worth.weights)

    @cached_property
    def afterwards(self) -> NDArray[np.float64]:
        """The density at the end of the horizon if nobody looks, ``(R, C)``."""
        mass = self.mass
        for _ in range(self.horizon):
            mass = search.propagate(mass, self.stencil)
        return mass

    @property
    def duration(self) -> float:
        """Length of the horizon [s]."""
        return self.horizon * self.dt


def freeze(pdf: TargetPdf, worth: Worth, committed: int = 0) -> SearchBelief:
    """Snapshot a pdf for a round whose plans take over ``committed`` steps later.

    Until then everybody's present flight goes on; what it detects is part of every impact, so that the
    team does not plan to search what it is about to have searched.

    Raises:
        InputError: more cells and layers than an impact can number, or no step of the horizon left to plan.
    """
    if not 0 <= committed < worth.horizon:
        raise InputError(
            f"a horizon of {worth.horizon} steps must be longer than the {committed} already taken"
        )
    if pdf.frame.size * len(worth.weights) >= 2**32 - 1:
        raise InputError(
            f"{pdf.frame.size} cells and {len(worth.weights)} layers are too many; take larger cells"
        )
    return SearchBelief(pdf.frame, pdf.mass, pdf.stencil, pdf.dt, pdf.step, worth, committed)


def normalised(
    frame: GridFrame, mass: NDArray[np.float64], field: str, outside: float = 0.0
) -> NDArray[np.float64]:
    """Return a mass on a grid, and outside, as probabilities of sum 1; ``InputError`` names the field."""
    mass = np.asarray(mass, np.float64)
    if mass.shape != frame.shape:
        raise InputError(f"{field} has shape {mass.shape}; the grid has {frame.shape}")
    if not np.isfinite(mass).all() or (mass < 0.0).any():
        wrong = mass[~(np.isfinite(mass) & (mass >= 0.0))][0]
        raise InputError(f"{field} must be finite and >= 0 in every cell; got {wrong}")
    total = float(mass.sum()) + outside
    if not (math.isfinite(total) and total > 0.0):
        raise InputError(
            f"{field} has no mass in the area (sum {total:g}); some cell must be likelier than 0"
        )
    return mass / total
