"""Confidence intervals by resampling: what other draws of the same kind would have given."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

LEVEL = 0.95
RESAMPLES = 1999
_SEED = 0  # of the resampling: the same figures give the same intervals


@dataclass(frozen=True)
class Interval:
    """An estimate with its confidence interval, not a number where there are fewer than two draws."""

    value: float
    low: float = math.nan
    high: float = math.nan


def mean_interval(samples: NDArray[np.float64]) -> Interval:
    """Return the mean of ``(n,)`` independent draws, with its BCa interval at 95 %."""
    return _interval(_mean, tuple(samples.tolist()))


def ratio_interval(above: NDArray[np.float64], below: NDArray[np.float64]) -> Interval:
    """Return ``mean(above) / mean(below)`` of ``(n,)`` paired draws, resampled in pairs.

    Not a number where a draw below the line is not above zero.
    """
    if (below <= 0.0).any():
        return Interval(math.nan)
    return _interval(_ratio, tuple(above.tolist()), tuple(below.tolist()))


def mean_band(curves: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the 95 % percentile interval of the mean of ``(n, T)`` curves at each of T points."""
    if len(curves) < 2:
        return curves.mean(axis=0), curves.mean(axis=0)
    rng = np.random.default_rng(_SEED)
    weights = rng.multinomial(len(curves), np.full(len(curves), 1.0 / len(curves)), RESAMPLES) / len(curves)
    tail = 50.0 * (1.0 - LEVEL)
    low, high = np.percentile(weights @ curves, (tail, 100.0 - tail), axis=0)
    return low, high


@lru_cache(maxsize=1 << 16)  # tables, pictures and report ask for the same intervals
def _interval(statistic: Any, *figures: tuple[float, ...]) -> Interval:
    samples = [np.array(each) for each in figures]
    value = float(statistic(*samples, axis=0))
    count = len(samples[0])
    if count < 2:
        return Interval(value)
    without_one = [statistic(*(np.delete(each, i) for each in samples), axis=0) for i in range(count)]
    if np.ptp(without_one) <= 1e-12 * abs(value):  # no draw matters, and BCa would divide 0 by 0
        return Interval(value, value, value)
    result = stats.bootstrap(
        samples,
        statistic,
        paired=len(samples) > 1,
        vectorized=True,
        confidence_level=LEVEL,
        n_resamples=RESAMPLES,
        method="BCa",
        rng=np.random.default_rng(_SEED),
    )
    low, high = result.confidence_interval
    return Interval(value, float(low), float(high))


def _mean(samples: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    return np.asarray(samples.mean(axis=axis))


def _ratio(above: NDArray[np.float64], below: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    return np.asarray(above.mean(axis=axis) / below.mean(axis=axis))
