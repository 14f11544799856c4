"""A number known from samples, and between what it lies."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError


@dataclass(frozen=True)
class Between:
    """An estimate, and an interval that holds what is estimated with a stated probability."""

    estimate: float
    low: float
    high: float

    @property
    def width(self) -> float:
        """Length of the interval."""
        return self.high - self.low


def bernstein(samples: NDArray[np.float64], span: float, miss: float) -> Between:
    """``mean +- [sqrt(2 v l / n) + 7 span l / (3 (n - 1))]``, ``l = ln(4 / miss)``: holds but for ``miss``.

    For independent samples of any distribution on an interval of length ``span``, with v their variance.
    Source: Maurer and Pontil (2009), theorem 4, once for each side; docs/theory.md (V102).

    Raises:
        InputError: fewer than two samples, or a probability that is none.
    """
    n = len(samples)
    if n < 2:
        raise InputError(f"an interval needs at least two samples; got {n}")
    if not 0.0 < miss < 1.0:
        raise InputError(f"miss must be a probability between 0 and 1; got {miss}")
    mean, variance, level = float(samples.mean()), float(samples.var(ddof=1)), math.log(4.0 / miss)
    half = math.sqrt(2.0 * variance * level / n) + 7.0 * span * level / (3.0 * (n - 1))
    return Between(mean, mean - half, mean + half)
