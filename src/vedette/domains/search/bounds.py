"""How much a search can find at best: the ideal searchers to compare with.

For targets that stay, and for all whose moves do not depend on where they are, as long as they stay off the
area's border (docs/search.md (V52)). What is counted as effort decides for which sensors they are bounds:

- ``search_effort`` is the log-miss that one look spreads over the area, ``int -ln(1 - P) dA`` [m^2]. It adds
  up whatever the looks' pattern, so ``allocation`` of all looks' effort bounds *every* detector with P < 1.
- ``covered_area`` is all that can have been in range, so ``top_mass`` of it bounds every detector that
  detects nothing beyond its range, those with P = 1 too. The lesser of the two holds where both do.
- With the swept area ``n W V t`` for the effort, W the sweep width, ``random_search`` and ``gaussian`` are
  Koopman's ideal of a sensor whose looks fall at random (V51); a definite-range sensor on parallel tracks
  beats them, up to ``parallel_sweep``.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from vedette.domains.search.detectors import Detector
from vedette.domains.search.motion import TargetMotion


@lru_cache(maxsize=64)
def sweep_width(detector: Detector, speed: float, interval: float) -> float:
    """``W = int (1 - prod_l (1 - P(r_l(y)))) dy`` [m], y the lateral distance of a target flown past.

    Looks every ``interval`` [s] at ``speed`` [m/s], averaged over where they fall; all-round view.
    """
    side = np.linspace(-detector.range, detector.range, 401)
    step = speed * interval
    if step == 0.0:
        return float(scipy.integrate.trapezoid(detector.probability(np.abs(side)), side))
    looks = np.arange(-math.ceil(detector.range / step) - 1, math.ceil(detector.range / step) + 2)
    found = np.zeros_like(side)
    for shift in (np.arange(8) + 0.5) / 8:
        distance = np.hypot(side[:, None], (looks + shift) * step)
        found += (1.0 - np.prod(1.0 - detector.probability(distance), axis=1)) / 8
    return float(scipy.integrate.trapezoid(found, side))


def search_effort(detector: Detector) -> float:
    """``E = (view / 2 pi) int -ln(1 - P(r)) 2 pi r dr`` [m^2] of one look; infinite if it can be certain."""
    square = (np.arange(20000) + 0.5) / 20000
    miss = 1.0 - detector.probability(detector.range * np.sqrt(square))
    if (miss <= 0.0).any():
        return math.inf
    return float(-np.log(miss).mean() * math.pi * detector.range**2 * detector.view / 360.0)


def covered_area(detector: Detector, speed: float, time: ArrayLike, platforms: int) -> NDArray[np.float64]:
    """``n (pi R^2 + 2 R V t)`` [m^2]: the most that n platforms can have had in range by time t [s]."""
    disc = math.pi * detector.range**2
    return np.asarray(platforms * (disc + 2.0 * detector.range * speed * np.asarray(time, np.float64)))


def wander(motion: TargetMotion, dt: float) -> float:
    """``sqrt(|v|^2 + 4 D / dt)`` [m/s]: at least the mean speed of a target, in steps of ``dt`` [s].

    ``covered_area`` at a speed greater by so much holds for a target that moves; docs/search.md (V52).
    """
    return math.sqrt(motion.drift[0] ** 2 + motion.drift[1] ** 2 + 4.0 * motion.diffusion / dt)


def parallel_sweep(swept: ArrayLike, area: float) -> NDArray[np.float64]:
    """``min(1, n W V t / A)``: uniform prior, no place searched twice; definite range.  Koopman"""
    return np.minimum(1.0, np.asarray(swept, np.float64) / area)


def random_search(swept: ArrayLike, area: float) -> NDArray[np.float64]:
    """``1 - exp(-n W V t / A)``: uniform prior, effort spread evenly, exponential law.  Koopman"""
    return -np.expm1(-np.asarray(swept, np.float64) / area)


def gaussian(swept: ArrayLike, sigma: float) -> NDArray[np.float64]:
    """``1 - (1 + a) exp(-a)``, ``a = sqrt(n W V t / (pi sigma^2))``: circular normal prior, exponential law.

    The best density of effort is ``(R^2 - r^2) / (2 sigma^2)`` inside ``R = sigma sqrt(2 a)``.  Koopman
    """
    a = np.sqrt(np.asarray(swept, np.float64) / (math.pi * sigma**2))
    return np.asarray(1.0 - (1.0 + a) * np.exp(-a))


def allocation(mass: NDArray[np.float64], cell_area: float, effort: ArrayLike) -> NDArray[np.float64]:
    """``max_z sum_x P(x) (1 - exp(-z(x)))``, ``sum_x z(x) A = effort``, z >= 0: de Guenin's best allocation.

    ``z = max(0, ln(P / lambda))``: effort goes where the posterior is highest, until it is level; (V51).

    Args:
        mass: probability of each cell, any shape.
        cell_area: A [m^2].
        effort: total of the team so far, any shape [m^2].

    Returns:
        probability of detection, in the shape of ``effort``.
    """
    ranked = np.sort(mass[mass > 0.0])[::-1]
    count = np.arange(1, len(ranked) + 1)
    logs = np.cumsum(np.log(ranked))
    needed = (logs - count * np.log(ranked)) * cell_area  # to level the first j cells down to the j-th
    efforts = np.asarray(effort, np.float64)
    j = np.searchsorted(needed, efforts, side="right")
    level = np.exp((logs[j - 1] - efforts / cell_area) / j)
    return np.asarray(np.cumsum(ranked)[j - 1] - j * level + 0.0)


def top_mass(mass: NDArray[np.float64], cell_area: float, area: ArrayLike) -> NDArray[np.float64]:
    """Probability of the most probable cells that make up an area [m^2], the last in part."""
    gathered = np.concatenate(([0.0], np.cumsum(np.sort(mass.ravel())[::-1])))
    cells = np.asarray(area, np.float64) / cell_area
    return np.interp(cells, np.arange(len(gathered)), gathered)
