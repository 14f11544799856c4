"""How well a search went: the mean time to detection."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def mean_time_to_detection(detection: ArrayLike, dt: float, tail: float = 0.0) -> float:
    """``sum_{k=0}^{K-1} (1 - C_k) dt + (1 - C_K) tail``, C_0 = 0: mean time, cut at the end [s]; (V50).

    A detection in a step counts at the step's end. ``tail`` [s] is what is added if the target was not found:
    0 gives ``E[min(T, K dt)]``, which is a lower bound of the mean time; say so wherever it is shown.

    Args:
        detection: ``(K,)`` C_1 .. C_K, probability of detection by the end of each step.
        dt: length of a step [s].
        tail: mean time still to go after the search [s].
    """
    detection = np.asarray(detection, np.float64)
    before = np.concatenate(([0.0], detection[:-1]))
    left = 1.0 - (detection[-1] if len(detection) else 0.0)
    return float((1.0 - before)[: len(detection)].sum() * dt + left * tail)
