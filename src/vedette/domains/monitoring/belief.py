"""What is known of the field at a time: the model, and evidence that grows old, in information form."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import log, pi

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from vedette.domains.monitoring.factor import Factor
from vedette.domains.monitoring.field import FieldModel, shifted
from vedette.domains.monitoring.spots import Spots
from vedette.errors import InputError

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FieldBelief:
    """``x ~ N(mean + L^-1 W' v, L^-1)`` with ``L = L0 + W' diag(y) W``, W the footprints of all spots.

    Evidence is a number y >= 0 and a number v for each spot, sums over measurements z of variance R:
    ``y = sum 1 / R``, ``v = sum (z - mean) / R``. docs/monitoring.md (V122)

    Raises:
        InputError: another grid, a wrong shape, information that is negative or not finite.
    """

    model: FieldModel
    spots: Spots
    information: Floats  # y, (spots,) [1 / unit^2]
    vector: Floats  # v, (spots,) [1 / unit]
    dt: float = 1.0  # length of a step [s]
    step: int = 0

    def __post_init__(self) -> None:
        if self.spots.frame != self.model.frame:
            raise InputError("field belief: the spots are of another grid than the model")
        if not (np.isfinite(self.dt) and self.dt > 0.0):
            raise InputError(f"field belief: dt must be > 0 s; got {self.dt}")
        for name, numbers in (("information", self.information), ("vector", self.vector)):
            if numbers.shape != (self.spots.count,):
                spots = self.spots.count
                raise InputError(f"field belief: {name} has shape {numbers.shape}, not ({spots},)")
            if not np.isfinite(numbers).all():
                raise InputError(
                    f"field belief: {name} of spot {_first(~np.isfinite(numbers))} is not finite"
                )
        if (self.information < 0.0).any():
            at = _first(self.information < 0.0)
            raise InputError(f"field belief: information of spot {at} is {self.information[at]:g}, below 0")

    @classmethod
    def prior(cls, model: FieldModel, spots: Spots, dt: float = 1.0) -> FieldBelief:
        """Return what is known ahead of all evidence."""
        nothing = np.zeros(spots.count)
        return cls(model, spots, nothing, nothing, dt)

    def observe(self, spots: NDArray[np.int64], values: Floats, variances: Floats) -> FieldBelief:
        """Take in measurements, (m,) each.

        Raises:
            InputError: a variance that is not > 0, a value that is not finite.
        """
        for name, numbers, sound in (("variance", variances, variances > 0.0), ("value", values, True)):
            wrong = ~(np.isfinite(numbers) & sound)
            if wrong.any():
                raise InputError(f"measurement {_first(wrong)}: {name} is {numbers[_first(wrong)]:g}")
        y = np.bincount(spots, 1.0 / variances, self.spots.count).astype(np.float64)
        v = np.bincount(spots, (values - self.model.mean) / variances, self.spots.count).astype(np.float64)
        return self.add(y, v)

    def add(self, information: Floats, vector: Floats) -> FieldBelief:
        """Take in evidence of this step, (spots,) each: it adds up, whoever it comes from."""
        return replace(self, information=self.information + information, vector=self.vector + vector)

    def predict(self, steps: int = 1) -> FieldBelief:
        """Go on by so many steps: the field drifts and changes, and what was seen grows old."""
        belief = self
        for _ in range(steps):
            belief = belief._drifted()._aged()
        return belief

    def _drifted(self) -> FieldBelief:
        """Move the evidence with the field; a block that a border cuts, before or after, is left out."""
        by = self.model.shift(self.step * self.dt, (self.step + 1) * self.dt)
        later = replace(self, step=self.step + 1)
        if by == (0, 0):
            return later
        whole = self.spots.whole
        y, v = (
            np.where(whole, np.stack([shifted(plane, *by)[0] for plane in planes]).ravel(), 0.0)
            for planes in map(self.spots.planes, (whole * self.information, whole * self.vector))
        )
        return replace(later, information=y, vector=v)

    def _aged(self) -> FieldBelief:
        """``1/y' = (1/y + d) / a^2``, ``v' = a v / (1 + y d)``: no surer than the exact filter; (V123)."""
        keep = self.model.kept(self.dt)
        if keep == 1.0:
            return self
        y, weights = self.information, self.spots.weights
        g = y / (1.0 + y * self.model.deviation**2)  # any positive numbers would do
        spread = (1.0 - keep**2) * (weights @ self.model.smoothed(weights.T @ g))
        thinned = 1.0 + np.divide(y * spread, g, out=np.zeros_like(y), where=g > 0.0)
        return replace(self, information=keep**2 * y / thinned, vector=keep * self.vector / thinned)

    @cached_property
    def precision(self) -> sp.csc_matrix:
        """``L``, sparse (n, n)."""
        return with_information(self, self.information)

    @cached_property
    def factor(self) -> Factor:
        """``L`` factorised."""
        return Factor(self.precision)

    @cached_property
    def mean(self) -> Floats:
        """(R, C) What the field is expected to be [unit]."""
        deviation = self.factor.solve(self.spots.weights.T @ self.vector)
        return np.asarray(self.model.mean + deviation.reshape(self.model.frame.shape))

    @property
    def entropy(self) -> float:
        """Of the field, ``1/2 ln((2 pi e)^n / det L)`` [nat]."""
        n = self.model.frame.size
        return 0.5 * (n * log(2.0 * pi) + n - self.factor.log_det)

    @property
    def gained(self) -> float:
        """What the evidence has taken off the field's entropy, ``1/2 ln det L - 1/2 ln det L0`` [nat]."""
        return 0.5 * (self.factor.log_det - self.model.log_det)

    def deviations(self, cells: NDArray[np.integer]) -> Floats:
        """Standard deviation of each of some flat cells [unit]."""
        rows = sp.csr_matrix(sp.eye(self.model.frame.size, format="csr")[np.asarray(cells)])
        parts = [
            np.einsum("ij,ij->j", part.T.toarray(), self.factor.solve(part.T.toarray()))
            for part in (rows[start : start + 512] for start in range(0, rows.shape[0], 512))
        ]
        return np.asarray(np.sqrt(np.concatenate([*parts, np.empty(0)])))


def with_information(belief: FieldBelief, information: Floats) -> sp.csc_matrix:
    """``L0 + W' diag(y) W`` of some information y of all spots."""
    some = np.flatnonzero(information)
    rows = belief.spots.weights[some]
    return sp.csc_matrix(belief.model.precision + rows.T @ sp.diags(information[some]) @ rows)


def _first(wrong: NDArray[np.bool_]) -> int:
    return int(np.flatnonzero(wrong)[0])
