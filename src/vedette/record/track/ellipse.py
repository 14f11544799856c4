"""The ellipse within which a target is to 95 %, as far as is known."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

SIGMA = math.sqrt(-2.0 * math.log(0.05))  # a Gaussian in the plane lies within 2.45 sigma to 95 %


def ellipse_axes(covariance: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return width and height [m] of a position's 95 % ellipse, and the angle of its width [deg]."""
    variances, axes = np.linalg.eigh(covariance[:2, :2])
    height, width = (2.0 * SIGMA * np.sqrt(np.maximum(variances, 0.0))).tolist()
    return width, height, math.degrees(math.atan2(axes[1, 1], axes[0, 1]))
