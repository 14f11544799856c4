"""The curves of a search: the probability that the target has been found, against time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CountedCurve:
    """The share of trials that had found their target, and the half width of a band around it."""

    detection: Floats  # (K + 1,)
    band: float  # 95 % for the whole curve at once
    trials: int
    of: str  # "looks" or "runs"


@dataclass(frozen=True, eq=False)
class Curves:
    """By the end of each step; (K + 1,) each."""

    times: Floats  # [s]
    bound: Floats  # nobody can do better
    koopman: Floats  # the swept area allocated at best, looks falling at random
    detection: Mapping[str, Floats] = field(default_factory=dict)  # predicted, by coordination
    counted: CountedCurve | None = None
