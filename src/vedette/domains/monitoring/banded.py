"""A field's information on a grid of some hundred cells, factorised in a band; what ways gain under it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.impact import Impact
from vedette.errors import InputError
from vedette.kernels import field
from vedette.kernels.field import Floats, Indices, Rows
from vedette.kernels.misses import CERTAIN

_ENTRIES = 1 << 24  # of a band, at most


@dataclass(frozen=True, eq=False)
class BandedField:
    """``L`` of a belief, cells numbered along the grid's shorter side first: that makes the narrowest band.

    Raises:
        InputError: so many cells that one needs larger ones to plan on.
    """

    belief: FieldBelief

    def __post_init__(self) -> None:
        frame = self.belief.model.frame
        if frame.size * (self.width + 1) > _ENTRIES:
            raise InputError(
                f"model.length: plans would be about {frame.size} cells, too many for a length of "
                f"{self.belief.model.length:g} m; take larger cells, or a greater length"
            )

    @cached_property
    def order(self) -> Indices:
        """(n,) The number that each flat cell has here."""
        rows, cols = self.belief.model.frame.shape
        row, col = np.divmod(np.arange(rows * cols), cols)
        return np.asarray(col * rows + row if rows <= cols else row * cols + col, np.int64)

    @cached_property
    def width(self) -> int:
        """How far from the diagonal an entry can lie."""
        return width_of(self.belief)

    def rows(self, spots: Indices) -> Rows:
        """Return the footprints of some spots."""
        some = self.belief.spots.weights[spots]
        return Rows(some.indptr.astype(np.int64), self.order[some.indices], some.data)

    @cached_property
    def band(self) -> Floats:
        """(n, b + 1) ``L0``, as the kernels take it."""
        precision = self.belief.model.precision.tocoo()
        i, j = self.order[precision.row], self.order[precision.col]
        band = np.zeros((self.belief.model.frame.size, self.width + 1))
        low = j <= i
        band[i[low], (j - i + self.width)[low]] = precision.data[low]
        return band

    def posterior(self, information: Floats) -> Posterior:
        """Return the field with more information, (spots,), than the belief has."""
        total = self.belief.information + information
        some = np.flatnonzero(total)
        return Posterior(self, *field.factor(self.band, self.rows(some), total[some]))


def width_of(belief: FieldBelief) -> int:
    """Return how far from the diagonal an entry of ``L`` can lie."""
    short, most = min(belief.model.frame.shape), max(belief.spots.sides) - 1
    return min(max(2 * short, most * (short + 1)), belief.model.frame.size - 1)


@dataclass(frozen=True, eq=False)
class Posterior:
    """A field with more information, factorised."""

    of: BandedField
    factor: Floats
    log_det: float

    @property
    def deviations(self) -> Floats:
        """(R, C) Standard deviation of each cell [unit]."""
        frame = self.of.belief.model.frame
        return np.asarray(np.sqrt(field.variances(self.factor)[self.of.order]).reshape(frame.shape))

    def covariance(self, spots: Indices) -> Floats:
        """``H L^-1 H'`` of some spots, (m, m)."""
        return field.covariance(self.factor, self.of.rows(spots))


@dataclass(frozen=True, eq=False)
class LayerLooks:
    """Several impacts by the end of one layer: at which spots, and how many units, impact after impact."""

    spots: Indices  # (m,) of any of them, ascending
    starts: Indices  # (k + 1,) where each impact's begin
    places: Indices  # among the spots
    units: Indices  # 1 to 255

    @classmethod
    def of(cls, impacts: Sequence[Impact], layers: int) -> list[LayerLooks]:
        """Return what impacts come to by the end of each layer."""
        counts = np.array([len(impact.keys) for impact in impacts], np.int64)
        whose = np.repeat(np.arange(len(impacts)), counts)
        keys = np.concatenate([*(impact.keys for impact in impacts), np.empty(0, np.uint32)]).astype(np.int64)
        units = np.concatenate([*(impact.misses for impact in impacts), np.empty(0, np.uint8)]).astype(
            np.int64
        )
        spot, layer = np.divmod(keys, layers)
        return [
            cls._by(spot[layer <= last], whose[layer <= last], units[layer <= last], len(impacts))
            for last in range(layers)
        ]

    @classmethod
    def _by(cls, spot: Indices, whose: Indices, units: Indices, count: int) -> LayerLooks:
        spots, place = np.unique(spot, return_inverse=True)
        pairs, where = np.unique(whose * max(len(spots), 1) + place, return_inverse=True)
        summed = np.minimum(np.bincount(where, units, len(pairs)).astype(np.int64), CERTAIN)
        owner, places = np.divmod(pairs, max(len(spots), 1))
        starts = np.searchsorted(owner, np.arange(count + 1)).astype(np.int64)
        return cls(spots.astype(np.int64), starts, places.astype(np.int64), summed)

    def within(self, some: NDArray[np.bool_]) -> LayerLooks:
        """Return what of the impacts is at some of all spots (spots,)."""
        used, kept = some[self.spots], some[self.spots[self.places]]
        starts = np.concatenate(([0], np.cumsum(kept)))[self.starts].astype(np.int64)
        renumbered = np.cumsum(used) - 1
        places = renumbered[self.places[kept]].astype(np.int64)
        return LayerLooks(self.spots[used], starts, places, self.units[kept])

    def gains(self, posterior: Posterior, before: Indices, unit: float) -> Floats:
        """``1/2 ln det`` that each impact adds to a team that has units ``before`` (spots,)."""
        if not len(self.spots):
            return np.zeros(len(self.starts) - 1)
        had = before[self.spots[self.places]]
        more = np.minimum(had + self.units, CERTAIN) - had
        roots: NDArray[np.float64] = np.sqrt(unit * more)
        return field.gains(posterior.covariance(self.spots), Rows(self.starts, self.places, roots))
