"""What a round of mapping is decided on: a frozen team map, the worth of its unknown cells, its frontiers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.frontier_worth import frontier_areas, leads_on, spread_behind
from vedette.domains.mapping.layers import TimeLayers, rate
from vedette.domains.mapping.outlook import known_share, mean_promise, promises
from vedette.domains.mapping.price import FREE, EndPrice
from vedette.domains.mapping.prior import Foresight, PriorMap, block_sum, foresee
from vedette.domains.mapping.priorities import Priorities, priority_factors, pull
from vedette.domains.mapping.sightings import berths_in
from vedette.domains.mapping.worlds import Worlds, imagine, in_each, to_see, trust_in
from vedette.kernels.coverage import CellWeights
from vedette.kernels.frontier import find_frontiers
from vedette.maps import UNKNOWN, GridFrame
from vedette.maps.bounds import EVERYWHERE, Extent
from vedette.maps.leave import Leave
from vedette.maps.transform import Transform

PLANNING_CELL = 0.2  # [m]; coarser costs quality, finer only bytes (docs/mapping.md, section 3)
SHORTEST = 0.25  # frontier worth a name [m] ...
OF_RADIUS = 1.25  # ... or shorter for a small robot, so many times its radius
LN2 = float(np.log(2.0))  # entropy of a cell with P = 0.5 [nats]


class Drawing(NamedTuple):
    """The map of a belief as it is drawn in another frame, which all who decide have alike."""

    belief: MapBelief
    there: Transform  # where the belief's own frame lies in the drawing's


@dataclass(frozen=True, eq=False)
class MapBelief:
    """The team map in the window that planning needs; equal for all robots with equal evidence."""

    frame: GridFrame  # of the window
    classes: NDArray[np.uint8]  # (R, C) of the window
    berths: NDArray[np.uint8]  # (R, C) of the window
    planning: GridFrame  # of the planning cells, over the whole map
    factor: int  # side of a planning cell [cells]
    first: tuple[int, int]  # planning cell (row, col) at the window's corner
    unknown: NDArray[np.uint16]  # (r, c) unknown cells of each planning cell in the window
    weights: CellWeights  # of each planning cell of the whole map in each world
    frontier_cells: NDArray[np.int64]  # (M,) flat cells of the window, by cluster
    frontier_starts: NDArray[np.int64]  # (K + 1,)
    layers: TimeLayers
    counts: NDArray[np.int64]  # (ROWS, BINS) the team's sightings
    gathering: bool  # so little is left that robots gather up what was left behind, by tours
    worlds: Worlds = (None,)  # what is foreseen in each
    end_price: EndPrice = FREE  # of tours
    valued: Drawing | None = None  # on which what a look shows is valued; None: on this belief itself

    @property
    def foresight(self) -> Foresight | None:
        """Of an old map in the only world there is; None: there are more, or it says nothing here."""
        return self.worlds[0] if len(self.worlds) == 1 else None

    @property
    def trust(self) -> NDArray[np.float32]:
        """Return ``(r, c K)`` with what probability what is foreseen in each world is right."""
        return trust_in(self.worlds, self.unknown.shape)

    @property
    def to_see(self) -> NDArray[np.uint16] | NDArray[np.float32]:
        """Return ``(r, c K)`` how many unknown cells there are to be seen, a K-th of those of each world."""
        return to_see(self.unknown, self.worlds)

    def planning_cells(self, local: NDArray[np.uint32]) -> NDArray[np.uint32]:
        """Map flat planning cells of the window, each in each world, to those of the whole map."""
        count = len(self.worlds)
        row, col = np.divmod(local, self.unknown.shape[1] * count)
        first = (row + self.first[0]) * (self.planning.cols * count) + self.first[1] * count
        return (first + col).astype(np.uint32)


def planning_factor(resolution: float) -> int:
    """Return how many cells a planning cell is wide."""
    return max(1, round(PLANNING_CELL / resolution))


def longest_frontier(reach: float) -> float:
    """Return how long a frontier may be before it is split [m], for sensors that see so far [m]."""
    return max(2.5, 0.35 * reach)


def shortest_frontier(radius: float) -> float:
    """Return how long a frontier is at least [m], for robots of such a radius [m]."""
    return min(SHORTEST, OF_RADIUS * radius)


def frontier_limits(extent: float, resolution: float, shortest: float = SHORTEST) -> tuple[int, int]:
    """Return how many cells a frontier has at least, and how long it may be [cells]; from its length [m]."""
    return max(1, round(shortest / resolution)), max(2, round(extent / resolution))


def freeze(
    classes: NDArray[np.uint8],
    frame: GridFrame,
    *,
    reach: float,
    extent: float,
    shortest: float = SHORTEST,
    hidden: float,
    return_price: float = 0.0,
    turn: float = math.inf,
    end_price: EndPrice = FREE,
    layers: TimeLayers,
    counts: NDArray[np.int64],
    known: Extent = EVERYWHERE,
    leave: Leave | None = None,
    priorities: Priorities = (),
    prior: PriorMap | None = None,
    worlds: int = 1,
) -> MapBelief:
    """Snapshot a team map for a round.

    A planning cell is worth ln 2 for each unknown cell in it (paper, section 4.1, P = 0.5), and the unknown
    cells that touch a frontier carry the area that the frontier stands for.  docs/mapping.md (V24)

    Args:
        classes: (R, C) the part of the team map within ``known``; copied.
        frame: where the whole map lies.
        reach: how far beyond what is known the sensors may see [m].
        extent: longest frontier before it is split [m].
        shortest: length from which a frontier counts [m].
        hidden: area expected behind a frontier [m^2].
        return_price: more for a frontier that is far from others [m^2 a metre].
        turn: gather up what was left behind, at these prices, once frontiers promise less than this [m^2].
        end_price: of tours [m^2/s], [m^2/s^2], once what was left behind is gathered up; to the share of the
            work left that is known.  docs/theory.md (V230)
        layers: the time layers of the objective.
        counts: (ROWS, BINS) the team's sightings.
        known: rows and columns outside of which nothing is known.
        leave: where there is nothing to see and no way for want of it; None: everywhere is the team's.
        priorities: areas in which all is worth so many times as much.
        prior: an old map of the building; None: there is none.
        worlds: what is unknown is taken as it may be, in so many ways.
    """
    factor = planning_factor(frame.resolution)
    planning = frame.coarse(factor)
    corner = known[0].start or 0, known[1].start or 0
    rows, cols = _window(classes, corner, frame, factor, int(np.ceil(reach / frame.resolution)))
    crop = np.zeros((rows.stop - rows.start, cols.stop - cols.start), np.uint8)
    _paste(classes, crop, (corner[0] - rows.start, corner[1] - cols.start))
    window = frame.window(rows, cols)
    berths = berths_in(crop, frame.resolution)
    if leave is not None:
        crop = leave.close(crop, window)
    cells, starts = find_frontiers(crop, *frontier_limits(extent, frame.resolution, shortest))
    unknown = block_sum(crop == UNKNOWN, factor)
    frontiers = cells, starts
    first = (rows.start // factor, cols.start // factor)
    if worlds == 1:
        each: Worlds = (None if prior is None else foresee(crop, window, factor, prior),)
    else:
        each = imagine(crop, window, factor, first, frontiers, prior, worlds)
    local = to_see(unknown, each).astype(np.float32) * LN2
    gathering, priced = turn == math.inf, end_price != FREE
    if priced or 0.0 < turn < math.inf:
        promised = promises(crop, berths, frame.resolution, frontiers, counts, unknown, factor)
        gathering |= mean_promise(promised, starts) < turn
        if priced:
            end_price = end_price.times(LN2 / frame.resolution**2 * known_share(window, frontiers, promised))
    areas = frontier_areas(window, cells, starts, hidden, return_price)
    if areas.any():
        areas *= leads_on(crop, berths, frontiers, counts, frame.resolution)
    areas += pull(window, crop, (cells, starts), priorities, factor)
    if gathering and areas.any():
        behind = LN2 / frame.resolution**2 * spread_behind(crop, cells, starts, areas, factor)
        local += in_each(behind, worlds)
    if priorities:
        local *= np.repeat(priority_factors(window.coarse(factor), priorities), worlds, axis=1)
    shape = planning.rows, planning.cols * worlds
    weights = CellWeights(local, (first[0], first[1] * worlds), shape, _all_unknown(frame, factor, worlds))
    return MapBelief(
        window,
        crop,
        berths,
        planning,
        factor,
        first,
        unknown,
        weights,
        cells,
        starts,
        layers if gathering else rate(),
        counts,
        gathering,
        each,
        end_price if gathering else FREE,
    )


def _window(
    classes: NDArray[np.uint8], corner: tuple[int, int], frame: GridFrame, factor: int, reach: int
) -> Extent:
    """The known part, grown by the reach, aligned to planning cells; one of them if nothing is known."""

    def span(known: NDArray[np.uint8], size: int, offset: int) -> slice:
        where = np.flatnonzero(known) + offset
        if not len(where):
            return slice(0, min(size, factor))
        start = max(0, int(where[0]) - reach) // factor * factor
        return slice(start, min(size, -(-(int(where[-1]) + 1 + reach) // factor) * factor))

    return (
        span(classes.max(axis=1, initial=0), frame.rows, corner[0]),
        span(classes.max(axis=0, initial=0), frame.cols, corner[1]),
    )


def _paste(part: NDArray[np.uint8], onto: NDArray[np.uint8], corner: tuple[int, int]) -> None:
    """Write a part whose first cell lies at ``corner`` of a grid; what lies outside the grid is left out."""
    low = np.maximum(corner, 0)
    high = np.minimum(np.add(corner, part.shape), onto.shape)
    if (low < high).all():
        inside = part[low[0] - corner[0] : high[0] - corner[0], low[1] - corner[1] : high[1] - corner[1]]
        onto[low[0] : high[0], low[1] : high[1]] = inside


def _all_unknown(frame: GridFrame, factor: int, worlds: int) -> tuple[float, float, float, float]:
    """Worth of a planning cell where nothing is known: inside the map, in its last column, last row, both."""
    rows, cols = (np.float32(min(factor, size - (size - 1) // factor * factor)) for size in frame.shape)
    side, worth = np.float32(factor), np.float32(LN2 / worlds)
    return (
        float(side * side * worth),
        float(side * cols * worth),
        float(rows * side * worth),
        float(rows * cols * worth),
    )
