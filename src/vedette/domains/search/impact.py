"""The impact of a search strategy: quantised log-misses per cell and layer, sparse."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.misses import CERTAIN, STEPS_PER_NAT, Misses, MissesCodec, SparseMisses
from vedette.maps import GridFrame
from vedette.maps.swept import most_cells_swept
from vedette.number import many
from vedette.problem import Reach
from vedette.team import Most

Impact: TypeAlias = SparseMisses  # docs/search.md (V44)
NOTHING = Impact(np.empty(0, np.uint32), np.empty(0, np.uint8))


def quantise(probability: NDArray[np.float64]) -> Misses:
    """``-16 ln(1 - p)``, rounded once; a detection probability below 3 % rounds to nothing (0)."""
    with np.errstate(divide="ignore"):
        levels = -STEPS_PER_NAT * np.log(1.0 - np.asarray(probability, np.float64))
    return np.minimum(levels + 0.5, CERTAIN).astype(np.uint8)


def clip(impact: Impact, frame: GridFrame, layers: int, reach: Reach) -> Impact:
    """Keep what lies in cells that any of the boxes touches.

    If they hold those of ``SearchPlatform.reach`` for every receiver, no receiver's gains change.

    Args:
        impact: what to send.
        frame: the belief's grid.
        layers: the belief's.
        reach: boxes lowest x, lowest y, highest x, highest y [m], team frame.
    """
    boxes = [(frame.cell(x0, y0), frame.cell(x1, y1)) for x0, y0, x1, y1 in reach]
    return impact.within(layers, frame.cols, boxes)


def check_claim(
    impact: Impact, robots: int, most: Most, side: float, layers: int, horizon: int, dt: float
) -> None:
    """Raise ``ValueError`` for what so many vehicles cannot look at, wherever they are.

    In a step each looks at what comes within its range on a way of ``speed dt``; after the horizon each
    promises one block, of at most the area ``2 range speed horizon dt`` that it sweeps meanwhile.

    Args:
        impact: of so many vehicles, combined.
        robots: how many.
        most: the team's limits.
        side: of a cell [m].
        layers, horizon, dt: the belief's; the first ``horizon`` layers are steps, the others promises.
    """
    looked = np.bincount(impact.keys % np.uint32(layers), minlength=layers)
    step = float(most_cells_swept(most.range, most.speed * dt, side))
    block = (math.sqrt(2.0 * most.range * most.speed * horizon * dt) / side + 1.0) ** 2
    if looked[:horizon].max() > robots * step:
        raise ValueError(
            f"impact claims {looked[:horizon].max()} cells in a step, too many for {many(robots, 'vehicle')}"
        )
    if looked[horizon:].sum() > robots * block:
        raise ValueError(
            f"impact promises {looked[horizon:].sum()} cells, too many for {many(robots, 'vehicle')}"
        )


class SearchImpactCodec(MissesCodec):
    """Impacts over so many cells and layers as bytes."""
