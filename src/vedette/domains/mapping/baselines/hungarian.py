"""The assignment of robots to frontiers with the least total path length."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from vedette.domains.mapping.baselines.team import TeamPlatform
from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.tour import STAY, Tour


@dataclass(eq=False)
class HungarianPlatform(TeamPlatform):
    """Takes its part of the least-cost assignment (Kuhn 1955; for exploration Wurm et al., IROS 2008)."""

    def reply(self, belief: MapBelief, others: Impact, current: Tour) -> Tour:
        """Return the stop that the assignment gives this robot."""
        stop = int(assign(self.sticky(current))[self.row])
        return self.tour(np.array([stop])) if stop >= 0 else STAY


def assign(lengths: NDArray[np.float64]) -> NDArray[np.int64]:
    """``min sum_i d(i, stop_i)`` over assignments that leave no stop out before another is taken twice.

    Every stop is offered once a robot; each further time costs more than all paths together, and to go
    nowhere costs more than that.  docs/theory.md (V60)

    Args:
        lengths: (n, K) path lengths [m], infinite where a robot cannot go; a bonus may make them negative.

    Returns:
        (n,) index of each robot's stop, -1 for robots that can go nowhere.
    """
    robots = len(lengths)
    stops = np.flatnonzero(np.isfinite(lengths).any(axis=0))
    if not len(stops):
        return np.full(robots, -1)
    able = np.isfinite(lengths[:, stops])
    times = robots
    more = 1.0 + 2.0 * robots * float(np.abs(lengths[:, stops][able]).max())
    nowhere = more * robots * times
    offers = [np.where(able, lengths[:, stops] + time * more, nowhere) for time in range(times)]
    rows, columns = scipy.optimize.linear_sum_assignment(np.hstack(offers))
    chosen = np.full(robots, -1)
    chosen[rows] = np.where(able[rows, columns % len(stops)], stops[columns % len(stops)], -1)
    return chosen
