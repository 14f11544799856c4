"""Time-layered coverage: viewpoints, footprints, sparse impacts and the best reply by tours.

A sparse impact is two parallel arrays: ``keys`` uint32, strictly increasing,
``planning_cell * LAYERS + layer``, and ``misses`` uint8, the log-miss that starts in that layer, in steps of
1/16 nat, saturating at 255, which means a certain sighting.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels
from vedette.kernels._arrays import classes_of
from vedette.kernels.misses import Keys, Misses

LAYERS: int = _kernels.LAYERS

_Singles = NDArray[np.float32]
_Doubles = NDArray[np.float64]
_Beyond = tuple[float, float, float, float]
_CellWeights = tuple[_Singles, tuple[int, int], tuple[int, int], _Beyond]
_Stops = tuple[NDArray[np.int64], tuple[Keys, Keys], Misses, _Singles, _Singles, _Doubles]
_TourProblem = tuple[_CellWeights, _Doubles, tuple[Keys, Misses], _Stops, tuple[float, float]]


@dataclass(frozen=True, eq=False)
class CellWeights:
    """What the planning cells of a grid are worth: those of a window one by one, those beyond it alike."""

    window: NDArray[np.float32]  # (r, c) [nats]
    first: tuple[int, int]  # row and column of the window's first cell
    shape: tuple[int, int]  # of the grid
    beyond: _Beyond  # of a cell beyond the window: inside the grid, in its last column, last row, both [nats]

    @classmethod
    def whole(cls, weights: NDArray[np.float32]) -> CellWeights:
        """Return what is given for each cell of a grid, (N,) [nats]."""
        return cls(weights[None], (0, 0), (1, len(weights)), (0.0, 0.0, 0.0, 0.0))

    @property
    def arrays(self) -> _CellWeights:
        """All of it, as the kernels take it."""
        return self.window, self.first, self.shape, self.beyond

    def of(self, cells: Keys) -> NDArray[np.float32]:
        """Return what some flat cells of the grid are worth [nats]."""
        row, col = np.divmod(cells.astype(np.int64), self.shape[1])
        last = 2 * (row + 1 == self.shape[0]) + (col + 1 == self.shape[1])
        worth: _Singles = np.array(self.beyond, np.float32)[last]
        row, col = row - self.first[0], col - self.first[1]
        inside = (row >= 0) & (row < self.window.shape[0]) & (col >= 0) & (col < self.window.shape[1])
        worth[inside] = self.window[row[inside], col[inside]]
        return worth


@dataclass(frozen=True, eq=False)
class Footprints:
    """What scans from K viewpoints would reveal, as rows of a sparse matrix."""

    starts: NDArray[np.int64]  # (K + 1,) bounds of each viewpoint's entries
    cells: NDArray[np.uint32]  # (M,) planning cells, ascending in each row
    misses: Misses  # (M,) log-miss

    @cached_property
    def numbers(self) -> tuple[Keys, Keys]:
        """The planning cells that any of them reveals, ascending, and where among these each entry's is."""
        return _kernels.number_cells(self.cells)


@dataclass(frozen=True, eq=False)
class Viewpoints:
    """Which of some clusters of cells can be looked at, and from where."""

    clusters: NDArray[np.int64]  # (N,) ascending
    targets: NDArray[np.int64]  # (N,) of the members tried, the one nearest the centroid that can be seen
    views: NDArray[np.int64]  # (N,) the nearest reachable cell that sees it
    horizon: float  # none is missing to which the way is shorter [m]; infinite: none is missing
    cut_short: bool  # the work was done before it was certain that these are the nearest

    def __len__(self) -> int:
        return len(self.clusters)

    def only(self, which: NDArray[np.int64] | NDArray[np.bool_]) -> Viewpoints:
        """Return some of them."""
        some = self.clusters[which], self.targets[which], self.views[which]
        return Viewpoints(*some, self.horizon, self.cut_short)


@dataclass(frozen=True, eq=False)
class TourProblem:
    """One platform's choice of a tour against the others' impact."""

    weights: CellWeights  # of each planning cell
    layer_weights: NDArray[np.float64]  # (LAYERS,) weight of each time layer
    edges: NDArray[np.float64]  # (LAYERS,) upper edge of each layer [s]; an arrival is in the first it fits
    others: tuple[Keys, Misses]  # sparse impact
    footprints: Footprints  # what each stop reveals
    first_leg: NDArray[np.float32]  # (K,) travel time to each stop [s], inf where it cannot be reached
    legs: NDArray[np.float32]  # (K, K) travel time between stops [s]
    end_price: tuple[float, float] = (0.0, 0.0)  # linear and quadratic, of when a tour ends [1/s], [1/s^2]

    @property
    def arrays(self) -> _TourProblem:
        """All of it, as the kernels take it."""
        marks = self.footprints
        stops = marks.starts, marks.numbers, marks.misses, self.first_leg, self.legs, self.edges
        return self.weights.arrays, self.layer_weights, self.others, stops, self.end_price


def viewpoints(
    field: NDArray[np.float32],
    source: int,
    resolution: float,
    classes: NDArray[np.uint8],
    cells: NDArray[np.int64],
    starts: NDArray[np.int64],
    reach: int,
    most: int,
    work: int,
) -> Viewpoints:
    """Find from where clusters of cells can be looked at: the ``most`` to whose views the way is shortest.

    The nearest are worked out first, until nobody farther can matter or the work is done.

    Args:
        field: (R, C) path length from the platform [m], inf where it cannot stand.
        source: flat cell of the platform.
        resolution: cell side [m].
        classes: (R, C) cell classes.
        cells, starts: clusters as ``find_frontiers`` returns them.
        reach: how far from a cluster's member to look for a view [cells].
        most: clusters to return.
        work: how much to do before giving up on what is left [pieces of lines looked at].
    """
    return Viewpoints(
        *_kernels.viewpoints(field, source, resolution, classes, cells, starts, reach, most, work)
    )


def berths(classes: NDArray[np.uint8], step: int, most: int) -> NDArray[np.uint8]:
    """Chebyshev distance of each cell from the nearest occupied one, in steps, from 0 for those beside it.

    Args:
        classes: (R, C) cell classes.
        step: so many cells are a step.
        most: what holds from so many steps on.

    Returns:
        (R, C); 0 for occupied cells too.
    """
    return _kernels.berths(classes_of(classes), step, most)


def footprints(
    classes: NDArray[np.uint8],
    berths: NDArray[np.uint8],
    views: NDArray[np.int64],
    facing: NDArray[np.float64],
    range_cells: float,
    view: float,
    table: NDArray[np.float32],
    by_distance: bool,
    rays: int,
    factor: int,
    floor: float,
) -> tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float32]]:
    """Expected share of each planning cell's unknown cells that a scan from each viewpoint reveals.

    A ray's berth is the least of the cells by which it came from the known into the unknown so far.

    Args:
        classes: (R, C) cell classes; rays stop at occupied cells.
        berths: (R, C) of the cells.
        views: (K,) flat cells of the viewpoints.
        facing: (K,) headings [rad]; ``view`` is the field of view about them [rad].
        range_cells: sensor range [cells].
        table: (W, T) probability of seeing an unknown cell by the ray's berth and at each depth [cells]; the
            last of a row or column holds beyond.
        by_distance: depth is the distance from the sensor; otherwise the unknown length crossed before.
        rays: how many to cast in a full turn.
        factor: side of a planning cell [cells].
        floor: a ray ends where a cell is seen less likely than that, and lower shares are left out.

    Returns:
        starts (K + 1,), planning cells (M,) and shares (M,).
    """
    return _kernels.footprints(
        classes, berths, views, facing, range_cells, view, table, by_distance, rays, factor, floor
    )


def combine(
    keys_a: Keys, misses_a: Misses, keys_b: Keys, misses_b: Misses, layers: int = LAYERS
) -> tuple[Keys, Misses]:
    """``a * b``: log-misses add, saturating; exactly associative and commutative.  docs/mapping.md (V20)

    Within a cell of so many layers nothing is left after certainty, as in ``a`` and ``b`` already; 1: each
    entry is by itself.
    """
    return _kernels.combine(keys_a, misses_a, keys_b, misses_b, layers)


def marginals(
    weights: CellWeights,
    layer_weights: NDArray[np.float64],
    others: tuple[Keys, Misses],
    starts: NDArray[np.int64],
    keys: Keys,
    misses: Misses,
) -> NDArray[np.float64]:
    """``value(others * own_k) - value(others)`` for K sparse impacts given as rows.

    Args:
        weights: of each planning cell.
        layer_weights: (LAYERS,) weight of each time layer.
        others: the rest of the team's sparse impact.
        starts, keys, misses: (K + 1,), (M,), (M,) the candidates.
    """
    return _kernels.marginals(weights.arrays, layer_weights, *others, starts, keys, misses)


def best_tour(
    problem: TourProblem,
    current: NDArray[np.int64],
    max_stops: int,
    stickiness: float = 0.0,
    margin: float = 0.0,
) -> tuple[NDArray[np.int64], float, float]:
    """The best tour found against the rest of the team, by greedy insertion and 2-opt.

    Args:
        problem: what to choose from.
        current: stops of the present tour, in order.
        max_stops: longest tour.
        stickiness: a tour with another first stop than the present one's must gain more by this share of what
            that shows, and by
        margin: so much [nats].

    Returns:
        the tour, its marginal value less its price, and that of the present tour. To stay costs what the
        farthest single stop does.  docs/theory.md (V194)
    """
    return _kernels.best_tour(problem.arrays, current, max_stops, (stickiness, margin))


def most_any_tour_adds(problem: TourProblem, max_stops: int) -> float:
    """An upper bound on what any tour adds to the team's impact.  docs/mapping.md (V26)"""
    return _kernels.most_any_tour_adds(problem.arrays, max_stops)
