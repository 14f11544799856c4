"""What was counted over many targets, with how far chance may have misled it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.record.log import Floats
from vedette.record.search.summary import Counted

_NORMAL = 1.959963984540054  # 97.5 % quantile


@dataclass(frozen=True, eq=False)
class Trials:
    """When each of many targets was found, or taken for found where it is not."""

    steps: NDArray[np.int64]  # (n,) at whose end; K + 1: never
    of: str  # "looks": at which the vehicles looked as they would; "runs": each looked for in earnest
    wrong: NDArray[np.bool_]  # (n,) what was found then was something else

    def curve(self, steps: int, wrong: bool = False) -> Floats:
        """Return the share found, or declared wrongly, by the end of each step, (steps + 1,)."""
        counts = np.bincount(self.steps[self.wrong == wrong], minlength=steps + 2)[: steps + 1]
        return np.asarray(counts.cumsum() / len(self.steps))

    def figures(self, times: Floats, predicted: Floats) -> Counted:
        """Return what they say of a search whose steps end at ``times`` [s], both (K + 1,)."""
        steps, count = len(times) - 1, len(self.steps)
        ended = self.steps <= steps
        found, mistaken = (int(np.count_nonzero(ended & (self.wrong == wrong))) for wrong in (False, True))
        low, high = wilson(found, count)
        spent = times[np.where(self.wrong, steps, np.minimum(self.steps, steps))]
        mean = float(spent.mean())
        half = _NORMAL * float(spent.std(ddof=1)) / math.sqrt(count) if count > 1 else None
        return Counted(
            trials=count,
            of=self.of,
            found=found / count,
            found_low=low,
            found_high=high,
            mistaken=mistaken,
            missed=count - found - mistaken,
            mean_time_s=mean,
            mean_time_low_s=None if half is None else mean - half,
            mean_time_high_s=None if half is None else mean + half,
            band=dkw(count),
            off=float(np.abs(self.curve(steps) - predicted).max()) if self.of == "looks" else None,
        )


def dkw(trials: int, confidence: float = 0.95) -> float:
    """``sqrt(ln(2 / (1 - c)) / (2 n))``: half width of a band that holds a whole distribution function.

    Dvoretzky, Kiefer, Wolfowitz; Massart's constant.
    """
    return math.sqrt(math.log(2.0 / (1.0 - confidence)) / (2.0 * trials))


def wilson(found: int, trials: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a probability from ``found`` of ``trials``."""
    z, share = _NORMAL, found / trials
    middle = (share + z * z / (2.0 * trials)) / (1.0 + z * z / trials)
    half = z * math.sqrt(share * (1.0 - share) / trials + (z / (2.0 * trials)) ** 2) / (1.0 + z * z / trials)
    return max(0.0, middle - half), min(1.0, middle + half)
