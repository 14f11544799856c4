"""What the coverage kernels compute: dense arrays for impacts, all orders of all stops for tours."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.coverage import LAYERS, CellWeights, TourProblem
from vedette.kernels.misses import CERTAIN, STEPS_PER_NAT, Keys, Misses
from vedette.kernels.reference.lidar import crossings

FREE, OCCUPIED = 1, 2
Sparse = tuple[Keys, Misses]
Floats = NDArray[np.float64]


# -- viewpoints and footprints ------------------------------------------------------------------------

TRIES = 4  # members of a cluster that are tried for a viewpoint


def segment(start: tuple[int, int], end: tuple[int, int]) -> Iterator[tuple[int, int]]:
    """Yield the cells from one centre to another, without the first; through a corner rows come first."""
    (row, col), rows, cols = start, end[0] - start[0], end[1] - start[1]
    row_times = [(Fraction(2 * i + 1, 2 * abs(rows)), 0) for i in range(abs(rows))]
    col_times = [(Fraction(2 * i + 1, 2 * abs(cols)), 1) for i in range(abs(cols))]
    for _, axis in sorted(row_times + col_times):
        row += int(np.sign(rows)) * (axis == 0)
        col += int(np.sign(cols)) * (axis == 1)
        yield row, col


def viewpoints(
    field: NDArray[np.float32],
    classes: NDArray[np.uint8],
    cells: NDArray[np.int64],
    starts: NDArray[np.int64],
    reach: int,
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Twin of ``coverage.viewpoints``: try every reachable cell, nearest first."""
    middles, views = [], []
    for first, last in itertools.pairwise(starts):
        members = np.column_stack(np.divmod(cells[first:last], classes.shape[1])).tolist()
        row, col = (Fraction(sum(axis), len(members)) for axis in zip(*members, strict=True))
        tried = [min(((r - row) ** 2 + (c - col) ** 2, (r, c)) for r, c in members)[1]]
        while len(tried) < min(TRIES, len(members)):
            gaps = [min((r - a) ** 2 + (c - b) ** 2 for a, b in tried) for r, c in members]
            tried.append(min((-gap, (r, c)) for gap, (r, c) in zip(gaps, members, strict=True))[1])
        found = [(cell, _nearest_view(field, classes, cell, reach)) for cell in tried]
        middle, view = next(((cell, view) for cell, view in found if view >= 0), (tried[0], -1))
        middles.append(middle[0] * classes.shape[1] + middle[1])
        views.append(view)
    return np.array(middles, np.int64), np.array(views, np.int64)


def _nearest_view(
    field: NDArray[np.float32], classes: NDArray[np.uint8], target: tuple[int, int], reach: int
) -> int:
    found = []
    for row, col in np.argwhere(np.isfinite(field)).tolist():
        dr, dc = row - target[0], col - target[1]
        if dr**2 + dc**2 > reach**2:
            continue
        between = (cell for cell in segment((row, col), target) if cell != target)
        if all(classes[cell] == FREE for cell in between):
            found.append((dr**2 + dc**2, max(abs(dr), abs(dc)), row * field.shape[1] + col))
    return min(found)[2] if found else -1


def berths(classes: NDArray[np.uint8], step: int, most: int) -> NDArray[np.uint8]:
    """Twin of ``coverage.berths``: every cell against every occupied one."""
    row, col = np.indices(classes.shape)
    occupied = np.argwhere(classes == OCCUPIED)
    found = np.full(classes.shape, most, np.int64)
    for r, c in occupied:
        away = np.maximum(abs(row - r), abs(col - c))
        found = np.minimum(found, np.maximum(away - 1, 0) // step)
    return found.astype(np.uint8)


def footprints(
    classes: NDArray[np.uint8],
    berths: NDArray[np.uint8],
    views: NDArray[np.int64],
    facing: Floats,
    range_cells: float,
    view: float,
    table: NDArray[np.float32],
    by_distance: bool,
    rays: int,
    factor: int,
    floor: float,
) -> tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float32]]:
    """Twin of ``coverage.footprints``: each cell's best ray, then means over planning cells."""
    unknown = _blocks(classes == 0, factor)
    starts, cells, shares = [0], [], []
    for viewpoint, heading in zip(views, facing, strict=True):
        seen = np.zeros(classes.shape)
        for turn in _turns(rays, view):
            where = int(viewpoint), heading + turn, range_cells
            ray = _ray(classes, berths, *where, table, by_distance, floor)
            for cell, probability in ray:
                seen.flat[cell] = max(seen.flat[cell], probability)
        share = _blocks(seen, factor) / np.maximum(unknown, 1)
        kept = np.flatnonzero((share >= floor) & (share > 0))
        cells.append(kept)
        shares.append(share[kept])
        starts.append(starts[-1] + len(kept))
    return (
        np.array(starts, np.int64),
        np.concatenate([np.empty(0), *cells]).astype(np.uint32),
        np.concatenate([np.empty(0), *shares]).astype(np.float32),
    )


def _turns(rays: int, view: float) -> list[float]:
    """Rays spread evenly about the heading."""
    turns = [math.tau * ((ray + 0.5) / rays - 0.5) for ray in range(rays)]
    return [turn for turn in turns if abs(turn) <= 0.5 * view]


def _ray(
    classes: NDArray[np.uint8],
    berths: NDArray[np.uint8],
    viewpoint: int,
    angle: float,
    range_cells: float,
    table: NDArray[np.float32],
    by_distance: bool,
    floor: float,
) -> Iterator[tuple[int, float]]:
    row, col = divmod(viewpoint, classes.shape[1])
    entry, leave = crossings((classes.shape[0], classes.shape[1]), 1.0, col + 0.5, row + 0.5, angle)
    crossed = np.flatnonzero((entry < leave) & (entry < range_cells))
    length, berth, outside = 0.0, len(table) - 1, True
    for cell in crossed[np.argsort(entry.flat[crossed])]:
        start, end = entry.flat[cell], min(leave.flat[cell], range_cells)
        if classes.flat[cell] == OCCUPIED:
            return
        if classes.flat[cell] != FREE:
            if outside:
                berth = min(berth, int(berths.flat[cell]))
            depth = 0.5 * (start + end) if by_distance else length
            probability = float(table[berth, min(int(depth), table.shape[1] - 1)])
            if probability <= 0.0 or probability < floor:
                return
            yield int(cell), probability
            length += end - start
        outside = bool(classes.flat[cell] == FREE)


def _blocks(values: NDArray[np.float64] | NDArray[np.bool_], factor: int) -> Floats:
    """Sums over ``factor x factor`` blocks, flat; blocks at the far edges may be smaller."""
    rows, cols = values.shape
    sums = [
        values[r : r + factor, c : c + factor].sum()
        for r in range(0, rows, factor)
        for c in range(0, cols, factor)
    ]
    return np.array(sums, np.float64)


# -- impacts ------------------------------------------------------------------------------------------


def combine(keys_a: Keys, misses_a: Misses, keys_b: Keys, misses_b: Misses, layers: int = LAYERS) -> Sparse:
    """Twin of ``coverage.combine``: a dictionary of sums, and in each cell what they add up to."""
    total: dict[int, int] = {}
    for key, miss in [*zip(keys_a, misses_a, strict=True), *zip(keys_b, misses_b, strict=True)]:
        total[int(key)] = total.get(int(key), 0) + int(miss)
    so_far: dict[int, int] = {}
    left: dict[int, int] = {}
    for key in sorted(total):
        before = so_far.get(key // layers, 0)
        so_far[key // layers] = min(CERTAIN, before + total[key])
        if so_far[key // layers] > before:
            left[key] = so_far[key // layers] - before
    return np.array(list(left), np.uint32), np.array(list(left.values()), np.uint8)


def missed(impact: Sparse, cells: int) -> Floats:
    """Miss probability of every planning cell by the end of every layer, shape (cells, LAYERS)."""
    added = np.zeros((cells, LAYERS))
    added.flat[impact[0]] = impact[1]
    total = np.cumsum(added, axis=1)
    return np.where(total >= CERTAIN, 0.0, np.exp(-total / STEPS_PER_NAT))


def dense(weights: CellWeights) -> NDArray[np.float32]:
    """Return the worth of every cell of the grid, (N,)."""
    return weights.of(np.arange(weights.shape[0] * weights.shape[1], dtype=np.uint32))


def value(weights: CellWeights, layer_weights: Floats, impact: Sparse) -> float:
    """``sum_s w_s sum_b w_b (1 - m(s, b))``.  docs/mapping.md (V21)"""
    worth = dense(weights).astype(np.float64)
    return float(worth @ (1.0 - missed(impact, len(worth))) @ layer_weights)


def marginals(
    weights: CellWeights,
    layer_weights: Floats,
    others: Sparse,
    starts: NDArray[np.int64],
    keys: Keys,
    misses: Misses,
) -> Floats:
    """Twin of ``coverage.marginals``: values of whole impacts, subtracted."""
    before = value(weights, layer_weights, others)
    own = [(keys[first:last], misses[first:last]) for first, last in itertools.pairwise(starts)]
    return np.array([value(weights, layer_weights, combine(*others, *one)) - before for one in own])


# -- tours --------------------------------------------------------------------------------------------


def arrivals(problem: TourProblem, tour: Sequence[int]) -> NDArray[np.float32]:
    """Arrival at each stop of a tour [s]."""
    legs = [problem.legs[a, b] for a, b in itertools.pairwise(tour)]
    return np.cumsum(
        np.array([*problem.first_leg[[int(s) for s in tour[:1]]], *legs], np.float32), dtype=np.float32
    )


def tour_impact(problem: TourProblem, tour: Sequence[int]) -> Sparse:
    """Each stop's footprint, from the layer of its arrival on."""
    impact: Sparse = np.empty(0, np.uint32), np.empty(0, np.uint8)
    marks = problem.footprints
    for stop, arrival in zip(tour, arrivals(problem, tour), strict=True):
        in_time = np.flatnonzero(problem.edges >= arrival)
        layer = int(in_time[0]) if len(in_time) else LAYERS - 1
        row = slice(marks.starts[stop], marks.starts[stop + 1])
        keys = (marks.cells[row].astype(np.int64) * LAYERS + layer).astype(np.uint32)
        impact = combine(*impact, keys, marks.misses[row])
    return impact


def tour_gain(problem: TourProblem, tour: Sequence[int]) -> float:
    """What a tour adds to the rest of the team; minus infinity if it cannot be driven."""
    if not np.isfinite(arrivals(problem, tour)).all():
        return -math.inf
    team = combine(*problem.others, *tour_impact(problem, tour))
    rest = value(problem.weights, problem.layer_weights, problem.others)
    return value(problem.weights, problem.layer_weights, team) - rest


def best_tour(problem: TourProblem, max_stops: int) -> tuple[tuple[int, ...], float]:
    """The best of all tours and its gain: what ``coverage.best_tour`` looks for."""
    stops = range(len(problem.first_leg))
    tours = (tour for length in range(max_stops + 1) for tour in itertools.permutations(stops, length))
    gains = {tour: tour_gain(problem, tour) for tour in tours}
    best = max(gains, key=lambda tour: gains[tour])
    return best, gains[best]


def greedy_tour(problem: TourProblem, max_stops: int) -> tuple[list[int], float]:
    """Insert the stop that adds most where it adds most, until nothing adds."""
    tour: list[int] = []
    gain = 0.0
    while len(tour) < max_stops:
        left = [stop for stop in range(len(problem.first_leg)) if stop not in tour]
        tries = [[*tour[:at], stop, *tour[at:]] for stop in left for at in range(len(tour) + 1)]
        gains = [tour_gain(problem, one) for one in tries]
        if not gains or max(gains) <= gain:
            break
        tour, gain = tries[int(np.argmax(gains))], max(gains)
    return tour, gain


def most_any_tour_adds(problem: TourProblem, max_stops: int) -> float:
    """Twin of ``coverage.most_any_tour_adds``: each stop alone at its earliest arrival, the best added up."""
    earliest = problem.first_leg.copy()
    for _ in earliest:
        for start, end in itertools.permutations(range(len(earliest)), 2):
            earliest[end] = min(earliest[end], earliest[start] + problem.legs[start, end])
    alone = replace(problem, first_leg=earliest)
    gains = [tour_gain(alone, [stop]) for stop in np.flatnonzero(np.isfinite(earliest)).tolist()]
    return float(sum(sorted(gains, reverse=True)[:max_stops]))
