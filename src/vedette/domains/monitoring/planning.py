"""The field as plans see it: in larger cells, so that a robot compares its ways in a few milliseconds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import k1

from vedette.domains.monitoring.banded import BandedField, width_of
from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.field import FieldModel
from vedette.domains.monitoring.platform import FieldSensor
from vedette.domains.monitoring.spots import WIDEST, Spots

Floats = NDArray[np.float64]

_OF_LENGTH = 0.5  # of the field's length is the side of a planning cell, at most
_LEAST = 8  # planning cells on the area's shorter side, at least


@dataclass(frozen=True, eq=False)
class Outlook:
    """A field of the same deviation and length on ``factor x factor`` times as large cells; (V128).

    A measurement of a cell is one of the planning cell that holds it, whose noise is larger by what a place
    differs from the middle of its planning cell.
    """

    fine: FieldModel
    spots: Spots

    @cached_property
    def factor(self) -> int:
        """How many cells make the side of a planning cell."""
        cells = self.fine.length / self.fine.frame.resolution
        return max(1, min(int(_OF_LENGTH * cells + 1e-9), min(self.fine.frame.shape) // _LEAST))

    @cached_property
    def model(self) -> FieldModel:
        """The field that plans are about."""
        fine = self.fine
        frame = fine.frame.coarse(self.factor)
        return FieldModel(frame, fine.mean, fine.deviation, fine.length, fine.lasting, fine.drift)

    @cached_property
    def kinds(self) -> tuple[int, ...]:
        """The side in planning cells of each kind of spot, odd."""
        most = min(WIDEST, *(n - 1 + n % 2 for n in self.model.frame.shape))
        return tuple(min(most, 1 + 2 * round((side / self.factor - 1.0) / 2.0)) for side in self.spots.sides)

    @cached_property
    def large(self) -> Spots:
        """The spots in planning cells."""
        return Spots(self.model.frame, tuple(sorted(set(self.kinds))))

    @property
    def apart(self) -> float:
        """``s^2 (1 - rho(0.38 a))``: variance that a place has beside its planning cell of side a [unit^2].

        0.38 a is how far a place lies from the middle in the mean; rho is (V120)'s correlation.
        """
        if self.factor == 1:
            return 0.0
        away = np.sqrt(8.0) / self.fine.length * 0.3826 * self.model.frame.resolution
        return float(self.fine.deviation**2 * (1.0 - away * k1(away)))

    def sensor(self, sensor: FieldSensor) -> FieldSensor:
        """Return a sensor as plans see it."""
        kind = self.kinds[self.spots.sides.index(sensor.side)]
        return replace(sensor, variance=sensor.variance + self.apart, side=kind)

    @cached_property
    def _large_of(self) -> NDArray[np.int64]:
        """(spots,) The spot in planning cells that each spot counts as."""
        row, col = np.divmod(np.arange(self.fine.frame.size), self.fine.frame.cols)
        cells = (row // self.factor) * self.model.frame.cols + col // self.factor
        return np.concatenate([self.large.of(kind, cells) for kind in self.kinds])

    def spots_over(self, cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """(spots,) Which spots in planning cells are about one that holds any of some cells (R, C)."""
        row, col = np.nonzero(cells)
        large = np.zeros(self.model.frame.shape, np.bool_)
        large[row // self.factor, col // self.factor] = True
        return np.tile(large.ravel(), len(self.large.sides))

    def deviations(self, known: FieldBelief) -> Floats:
        """(R, C) Standard deviation of each of the field's cells, worked out on planning cells [unit]."""
        large = BandedField(self.of(known)).posterior(np.zeros(self.large.count)).deviations
        rows, cols = self.fine.frame.shape
        stretched = np.kron(large, np.ones((self.factor, self.factor)))[:rows, :cols]
        return np.asarray(np.sqrt(np.minimum(stretched**2 + self.apart, self.fine.deviation**2)))

    def of(self, known: FieldBelief) -> FieldBelief:
        """Return a belief in planning cells; only what it is sure of counts, the values do not."""
        y = known.information
        seen = y / (1.0 + y * self.apart)
        information = np.bincount(self._large_of, seen, self.large.count).astype(np.float64)
        return FieldBelief(
            self.model, self.large, information, np.zeros(self.large.count), known.dt, known.step
        )


def deviations_of(known: FieldBelief) -> Floats:
    """(R, C) Standard deviation of each cell [unit]; on planning cells, where the field is too large."""
    if known.model.frame.size * width_of(known) ** 2 <= _MOST_WORK:
        return BandedField(known).posterior(np.zeros(known.spots.count)).deviations
    return Outlook(known.model, known.spots).deviations(known)


_MOST_WORK = 2e9  # multiplications to factorise a field in a band as it is
