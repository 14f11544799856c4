"""Measurements as integers: what robots add up, step by step, to share what they measured."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.field import FieldModel
from vedette.domains.monitoring.spots import Spots
from vedette.errors import InputError

Floats = NDArray[np.float64]

MOST_DEVIATIONS = 1000.0  # that a measurement may lie from the mean
MOST_LOOKS = 1024  # that one robot's evidence of a step may hold at a spot


@dataclass(frozen=True)
class FieldPacking:
    """Evidence of one step as a vector of integers: the information of every spot, then the vector of each.

    Rounded once, to 2^-40 of the most precise measurement: from then on sums are exact, whatever their order.
    """

    model: FieldModel
    spots: Spots
    least_variance: float  # of any sensor of the team [unit^2]

    @property
    def size(self) -> int:
        """Numbers in all."""
        return 2 * self.spots.count

    @cached_property
    def _units(self) -> tuple[float, float]:
        """What 1 stands for: of information, of the vector."""
        unit = 2.0**-40 / self.least_variance
        return unit, unit * self.model.deviation

    def pack(
        self, spots: NDArray[np.int64], values: Floats, variances: Floats
    ) -> tuple[NDArray[np.int64], ...]:
        """Return the places and the numbers, not 0, of a step's measurements (m,).

        Raises:
            InputError: what cannot be a measurement, or lies too far from the mean or is too precise.
        """
        one = FieldBelief.prior(self.model, self.spots).observe(spots, values, variances)
        most = MOST_LOOKS / self.least_variance
        _check(
            one.information.max(initial=0.0) <= most * 1.000001, "is more precise than the team's best sensor"
        )
        far = MOST_DEVIATIONS * self.model.deviation
        _check(bool((np.abs(values - self.model.mean) <= far).all()), f"lies more than {far:g} from the mean")
        whole = np.concatenate(
            [np.rint(of / unit) for of, unit in zip((one.information, one.vector), self._units, strict=True)]
        ).astype(np.int64)
        places = np.flatnonzero(whole)
        return places, whole[places]

    def add(self, belief: FieldBelief, places: NDArray[np.int64], numbers: NDArray[np.int64]) -> FieldBelief:
        """Take a step's evidence, a sum over robots, into a belief of that step."""
        whole = np.zeros(self.size)
        whole[places] = numbers
        y, v = whole.reshape(2, -1) * np.array(self._units)[:, None]
        return belief.add(np.maximum(y, 0.0), v)


def _check(holds: bool, what: str) -> None:
    if not holds:
        raise InputError(f"a measurement {what}")
