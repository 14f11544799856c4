"""How fast any team could have explored at best: limits that no planner can pass.

**Model.** n robots move at most at V from their starts through the free cells of the true world, in any way
and with any knowledge, and see what their beams reach within R, all around and without noise. A cell is
seen when a beam touches it. A narrower view, a body, turning, dying and not knowing the map only slow a
team down, so the limits hold for it as well. Let c be the side of a cell and R' = R + sqrt(2) c.

**Reach.** A robot has come V t by time t. A point of a cell that it has seen is at most R from it in a
straight line through free cells, and the cell's centre at most c / sqrt(2) from that point. With d the
length of the shortest way from the nearest start through the closed free squares to the cell's centre,
hence

    d <= V t + R + c / sqrt(2).                                                                          (1)

**Ways on the grid.** d is at least 12/13 of what the distance kernel finds, if its nodes are the corners,
mid-sides and centres of cells, and those that lie on a free cell are traversable. A shortest way bends only
at corners of solid squares, which are nodes. Cut it there, and let one piece go a >= b >= 0 half cells
along the axes. Its digital line, the nodes just below it, takes b diagonal steps and a - b straight ones,
each along a side or a diagonal of a half square that the piece passes through, which lies in a free cell.
So the kernel, for which a diagonal counts 17/12, finds at most a + 5/12 b, and by Cauchy and Schwarz that
is at most sqrt(1 + (5/12)^2) = 13/12 of the piece's own length. A start is at most sqrt(2) c / 4 from a
node of its own cell. With (1)

    12/13 d_grid <= V t + R'.                                                                            (2)

**Sweep.** What a robot has seen lies within R of its way, and the cells that this touches within R'. A way
of length l has an area of at most pi R'^2 + 2 R' l within R' of it, so of the area A that can be seen at
all the team has seen at most

    n (pi R'^2 + 2 R' V t).                                                                              (3)

Together: the share known at t is at most the share of cells that satisfy (2), and at most (3) over A. All
is known, with d_far the largest 12/13 d_grid, not before

    T = max { (d_far - R') / V, (A - n pi R'^2) / (2 R' V n) }.                                          (4)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.distance import distance_field
from vedette.maps.world import World
from vedette.record.explore.score import Reference
from vedette.team import PlatformSpec

_SHORTEST = 12.0 / 13.0  # of a path that the distance kernel finds: no way is shorter


@dataclass(frozen=True, eq=False)
class Limit:
    """The most that any team can know at a time, and the least time in which it can know so much."""

    distances: NDArray[np.float64]  # (N,) of the cells that can be seen from the nearest start, ascending [m]
    area: float  # of a cell [m^2]
    robots: int
    speed: float  # of the fastest [m/s]
    reach: float  # R', of the sensor that reaches farthest [m]

    @property
    def coverable(self) -> float:
        """What can be seen at all, A [m^2]."""
        return len(self.distances) * self.area

    def coverage(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the largest possible share known at times ``t`` [s]; 1 where nothing can be seen."""
        count = len(self.distances)
        if not count:
            return np.ones_like(t)
        near = np.searchsorted(self.distances, self.speed * t + self.reach, side="right") / count
        swept = self.robots * (math.pi * self.reach**2 + 2 * self.reach * self.speed * t)
        return np.asarray(np.minimum(np.minimum(near, swept / self.coverable), 1.0))

    def time(self, share: float = 1.0) -> float:
        """Return the least time [s] in which ``share`` of what can be seen can be known.

        The cells nearest to the starts are the quickest to reach, so that many of them stand for any choice.
        """
        count = len(self.distances)
        wanted = math.ceil(share * count - 1e-9)
        if wanted <= 0:
            return 0.0
        far = (self.distances[wanted - 1] - self.reach) / self.speed
        swept = wanted * self.area - self.robots * math.pi * self.reach**2
        return max(float(far), swept / (2 * self.reach * self.speed * self.robots), 0.0)

    def auc(self) -> float:
        """Return the least area [s] over the coverage curve of a team that goes on until everything is known.

        Coverage is at most a step function that rises by one cell at that cell's least time.
        """
        count = len(self.distances)
        if not count:
            return 0.0
        far = (self.distances - self.reach) / self.speed
        swept = np.arange(1, count + 1) * self.area - self.robots * math.pi * self.reach**2
        least = np.maximum(far, swept / (2 * self.reach * self.speed * self.robots))
        return float(np.maximum(least, 0.0).mean())


def limit(world: World, specs: Sequence[PlatformSpec], starts: NDArray[np.float64]) -> Limit:
    """Return what no team with these bodies, sensors and starts can pass: (1) to (4) above.

    Args:
        world: the truth.
        specs: the team; the fastest and the one that sees farthest stand for all.
        starts: ``(n, 3)`` x, y, heading [m, m, rad], team frame.
    """
    resolution = world.frame.resolution
    coverable = Reference(world, specs, starts).coverable
    distances = _SHORTEST * distances_to_centres(world, starts)[coverable]
    return Limit(
        np.sort(distances),
        resolution**2,
        len(specs),
        max(spec.speed for spec in specs),
        max(spec.range for spec in specs) + math.sqrt(2.0) * resolution,
    )


def distances_to_centres(world: World, starts: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``(rows, cols)`` the kernel's path lengths [m] from the nearest start to the cells' centres.

    Paths of points over the corners, mid-sides and centres of free cells; infinity where there is none.
    """
    rows, cols = world.frame.shape
    nodes = np.zeros((2 * rows + 1, 2 * cols + 1), bool)
    for down in range(3):
        for right in range(3):
            nodes[down : down + 2 * rows : 2, right : right + 2 * cols : 2] |= ~world.solid
    half = world.frame.resolution / 2
    nearest = np.full((rows, cols), np.inf)
    for x, y, _ in starts.tolist():
        row = round((y - world.frame.origin_y) / half)
        col = round((x - world.frame.origin_x) / half)
        field = distance_field(nodes, row * nodes.shape[1] + col, half)
        nearest = np.minimum(nearest, field[1::2, 1::2])
    return nearest
