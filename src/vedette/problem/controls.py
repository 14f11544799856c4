"""A platform whose strategies are not listed: its control is any point of a box."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError, brief
from vedette.number import is_number
from vedette.problem.arrays import misfit
from vedette.problem.objective import ImpactT

Float = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Controls(Generic[ImpactT]):
    """``u in [low, high]``, and the impact ``Y(u)`` of each (paper, eq. (13)); in the place of candidates.

    Source: paper, Table 1; docs/theory.md (V103).

    Raises:
        InputError: ends that are no vectors of finite numbers, in order; a start outside; no threshold.
    """

    impact: Callable[[Float], ImpactT]  # of a control (d,)
    low: Float  # (d,)
    high: Float  # (d,)
    start: Float  # (d,) the first control
    threshold: float = 1e-6  # a change of every number by no more is none (paper, Table 1, step 6)

    def __post_init__(self) -> None:
        if not callable(self.impact):
            raise InputError(f"controls: impact is {brief(self.impact)}; give a function of the control")
        shape = (np.size(self.low),)
        for name in ("low", "high", "start"):
            if (wrong := misfit(getattr(self, name), name, shape, dtype=np.float64)) is not None:
                raise InputError(f"controls: {wrong}")
        if shape == (0,) or not (self.low < self.high).all():
            raise InputError(f"controls: low must be below high; got {self.low} and {self.high}")
        if not ((self.low <= self.start) & (self.start <= self.high)).all():
            raise InputError(f"controls: start must be from low to high; got {self.start}")
        if not is_number(self.threshold) or self.threshold <= 0.0:
            raise InputError(f"controls: threshold must be a number > 0; got {brief(self.threshold)}")

    @property
    def examples(self) -> list[ImpactT]:
        """Impacts at the start and at both ends, to try out an objective on."""
        return [self.impact(u.copy()) for u in (self.start, self.low, self.high)]
