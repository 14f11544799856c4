"""The field as it is known beforehand: how much it varies, over what distance, how long, and its drift."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.fft import dctn, idctn

from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.number import is_number

Floats = NDArray[np.float64]

LEAST_LENGTH = 1.0  # of correlation [cells]: a grid holds nothing finer
MOST_LENGTH = 1000.0  # [cells]: deviations are right to five digits; beyond, rounding eats the precision
MOST_CELLS = 1 << 20


@dataclass(frozen=True)
class FieldModel:
    """A stationary Gaussian Markov random field on a grid: ``x ~ N(mean, L0^-1)`` at every time.

    ``L0 = S (k^2 + G)^2 S`` with G the grid's Laplacian, 13 entries a row: a Matern field of smoothness 1,
    whose correlation is 0.14 at ``length``. S makes the deviation the same in every cell, at the border too.
    In time it is autoregressive, and drifts by whole cells; docs/monitoring.md (V120), (V121).

    Raises:
        InputError: a number out of its range.
    """

    frame: GridFrame
    mean: float = 0.0  # [the field's unit]
    deviation: float = 1.0  # standard, of each cell [the field's unit]
    length: float = 10.0  # distance at which cells have little in common [m]
    lasting: float = math.inf  # after so long a cell has 1 / e in common with itself [s]
    drift: tuple[float, float] = (0.0, 0.0)  # of the whole field [m/s]

    def __post_init__(self) -> None:
        if not 4 <= self.frame.size <= MOST_CELLS:
            raise InputError(f"field has {self.frame.size} cells; take 4 to {MOST_CELLS}")
        numbers = {"mean": self.mean, "drift x": self.drift[0], "drift y": self.drift[1]}
        for name, value in numbers.items():
            if not is_number(value):
                raise InputError(f"field: {name} must be a number; got {value}")
        for name, value in (("deviation", self.deviation), ("length", self.length)):
            if not (is_number(value) and value > 0.0):
                raise InputError(f"field: {name} must be a number > 0; got {value}")
        if self.length < LEAST_LENGTH * self.frame.resolution:
            least = LEAST_LENGTH * self.frame.resolution
            raise InputError(f"field: length {self.length:g} m is less than a cell; take {least:g} m or more")
        if self.length > (most := MOST_LENGTH * self.frame.resolution) * (1.0 + 1e-9):
            raise InputError(
                f"field: length {self.length:g} m is more than {MOST_LENGTH:g} cells; take {most:g} m or less"
            )
        if not self.lasting > 0.0:
            raise InputError(f"field: lasting must be > 0 s; got {self.lasting}")

    def kept(self, seconds: float) -> float:
        """``a = exp(-t / lasting)``: what a cell keeps of its deviation from the mean."""
        return math.exp(-seconds / self.lasting)

    def shift(self, start: float, end: float) -> tuple[int, int]:
        """Return by how many rows and columns the field drifts between two times [s]: whole cells in all."""
        x, y = (
            round(speed * end / self.frame.resolution) - round(speed * start / self.frame.resolution)
            for speed in self.drift
        )
        return y, x

    @property
    def _square(self) -> float:
        """``k^2 = 8 / length^2`` [1 / cell^2]."""
        return 8.0 * (self.frame.resolution / self.length) ** 2

    @cached_property
    def _modes(self) -> Floats:
        """(R, C) Eigenvalues of ``k^2 + G``: cosines are its eigenvectors."""
        rows, cols = (2.0 - 2.0 * np.cos(np.pi * np.arange(n) / n) for n in self.frame.shape)
        return np.asarray(self._square + rows[:, None] + cols)

    @cached_property
    def _scale(self) -> Floats:
        """(R, C) The diagonal of ``S^-1``: deviation over that of ``(k^2 + G)^-1 white``, cell by cell."""
        rows, cols = (dctn(np.eye(n), axes=0, norm="ortho") ** 2 for n in self.frame.shape)
        return np.asarray(self.deviation / np.sqrt(rows.T @ self._modes**-2.0 @ cols))

    @cached_property
    def precision(self) -> sp.csc_matrix:
        """``L0``, sparse (n, n) [1 / unit^2]."""
        rows, cols = (_laplacian(n) for n in self.frame.shape)
        root = sp.kron(rows, sp.eye(self.frame.cols)) + sp.kron(sp.eye(self.frame.rows), cols)
        root = root + self._square * sp.eye(self.frame.size)
        scale = sp.diags(1.0 / self._scale.ravel())
        return sp.csc_matrix(scale @ root @ root @ scale)

    @cached_property
    def log_det(self) -> float:
        """``ln det L0``, in closed form."""
        return float(2.0 * (np.log(self._modes) - np.log(self._scale)).sum())

    def smoothed(self, vector: Floats) -> Floats:
        """``L0^-1 v``, by cosine transforms; v (n,)."""
        inner = self._scale * vector.reshape(self.frame.shape)
        modes = dctn(inner, norm="ortho") / self._modes**2
        return np.asarray((self._scale * idctn(modes, norm="ortho")).ravel())

    def sample(self, rng: np.random.Generator) -> Floats:
        """Draw a field, (R, C)."""
        modes = rng.normal(size=self.frame.shape) / self._modes
        return np.asarray(self.mean + self._scale * idctn(modes, norm="ortho"))

    def later(self, field: Floats, start: float, end: float, rng: np.random.Generator) -> Floats:
        """Draw what becomes of a field (R, C) between two times [s]: it drifts, and is partly drawn anew.

        What drifts in over the border is drawn from the model.
        """
        keep = self.kept(end - start)
        fresh = self.sample(rng) - self.mean
        moved, inside = shifted(field - self.mean, *self.shift(start, end))
        moved[~inside] = fresh[~inside]
        return np.asarray(
            self.mean + keep * moved + math.sqrt(1.0 - keep**2) * (self.sample(rng) - self.mean)
        )


def shifted(plane: Floats, rows: int, cols: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Return a plane (R, C) moved by whole cells, 0 where nothing comes from, and where something does."""
    out, inside = np.zeros_like(plane), np.zeros(plane.shape, np.bool_)
    to = tuple(
        slice(max(n, 0), max(size + min(n, 0), 0)) for n, size in zip((rows, cols), plane.shape, strict=True)
    )
    of = tuple(
        slice(max(-n, 0), max(size - max(n, 0), 0)) for n, size in zip((rows, cols), plane.shape, strict=True)
    )
    out[to], inside[to] = plane[of], True
    return out, inside


def _laplacian(n: int) -> sp.spmatrix:
    """Return the Laplacian of a row of n cells; nothing flows over its ends."""
    diagonal = np.full(n, 2.0)
    diagonal[0] -= 1.0
    diagonal[-1] -= 1.0
    return sp.diags([diagonal, -np.ones(n - 1), -np.ones(n - 1)], [0, 1, -1])
