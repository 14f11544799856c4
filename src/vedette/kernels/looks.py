"""What a look at a target tells of its position, known as a Gaussian: for plans and filters alike."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels

Floats = NDArray[np.float64]


class Sight(NamedTuple):
    """What a sensor measures, with which standard deviations, 0 if not at all: a range, a bearing or both."""

    range_noise: float  # [m]
    bearing_noise: float  # [rad]
    place_noise: float  # of each coordinate [m]; alone
    min_range: float  # nearer than this a bearing says no more across than from here [m]
    stride: float  # how far the sensor moves between looks [m]


class Lines(NamedTuple):
    """N measurements as lines ``s = H x + noise`` in the position, whose noise has the covariance R.

    The statistics s are, relative to the line of sight from the sensor to the mean: the place x, y for a
    range with a bearing, both debiased, and then the range; cosine and sine of a bearing, debiased; a range;
    a place. What a kind does not have is 0.
    """

    information: Floats  # (N, 3) H' R^-1 H as xx, xy, yy [1/m^2], team frame
    gain: Floats  # (N, 2, 3) H' R^-1
    expected: Floats  # (N, 3) of the statistics


def lines(sight: Sight, offsets: Floats, covariances: Floats) -> Lines:
    """The lines that fit a look best, over the Gaussians of the targets' positions.

    ``H = Cov(s, x) P^-1`` and ``R = E Cov(s | x) + a (Cov(E(s | x)) - H P H')``: with a = 1 the best linear
    estimate from the statistics. What the line leaves comes back in every look from about the same place, so
    it counts ``a = 4 |x| / stride`` times, from 4 to 300.  docs/tracking.md (V34)

    Args:
        sight: the sensor.
        offsets: (N, 2) from the sensor to the targets' means [m].
        covariances: (N, 3) of the positions as xx, xy, yy [m^2].
    """
    return Lines(*_kernels.track_lines(sight, *map(np.ascontiguousarray, (offsets, covariances))))


def foreseen(
    sight: Sight, view: tuple[float, float], poses: Floats, points: Floats, covariances: Floats
) -> Floats:
    """``information`` of `lines` for what is in view, times the share of the Gaussian that is.

    Args:
        sight: the sensor.
        view: its range [m] and half of its angle [rad].
        poses: (C, K, 3) of the sensor along C courses [m, m, rad].
        points: (M, K, 2) the targets' means [m].
        covariances: (M, K, 3) of their positions as xx, xy, yy [m^2].

    Returns:
        (C, M, K, 3), 0 where the mean is out of view.
    """
    arrays = map(np.ascontiguousarray, (poses, points, covariances))
    return _kernels.track_foreseen(sight, view, *arrays)
