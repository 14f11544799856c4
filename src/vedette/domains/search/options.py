"""What a vehicle can choose from in a round: its flights as paths of looks, and their promises."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.belief import SearchBelief
from vedette.domains.search.flights import Branches, Flight
from vedette.domains.search.goals import Goals
from vedette.domains.search.impact import quantise
from vedette.kernels.search import Paths


@dataclass(frozen=True, eq=False)
class FlightOptions:
    """What a vehicle can choose from in a round."""

    flights: list[Flight]  # the present one, restated, first
    index: dict[Flight, int]  # of each flight
    to_best: int  # the flight to the best block, for when none detects anything
    paths: Paths  # their looks, beginnings shared, and promises
    ends: NDArray[np.int64]  # (C,) the last look of each flight
    boxes: NDArray[np.float64]  # (B, 4) what gains depend on: x_min, x_max, y_min, y_max [m], team frame


def quantised_looks(
    tree: Branches,
    starts: NDArray[np.int64],
    cells: NDArray[np.uint32],
    probability: NDArray[np.float64],
) -> Paths:
    """Round what the looks of each node detect, and leave out what rounds to nothing."""
    misses = quantise(probability)
    some = misses > 0
    kept = np.concatenate(([0], np.cumsum(some)))
    return Paths(tree.parents, kept[starts], cells[some], misses[some])


def with_promises(
    paths: Paths,
    ends: NDArray[np.int64],
    goals: Goals,
    after: NDArray[np.int64],
    delays: NDArray[np.int64],
    levels: NDArray[np.uint8],
) -> tuple[Paths, NDArray[np.int64]]:
    """Append to each flight its promise as one more look, so many layers later as it is delayed."""
    if not len(goals):
        return paths, ends
    size, at, parents, count = goals.cells.shape[1], ends.copy(), [paths.parents], len(paths.parents)
    for layer in range(delays.max()):  # looks at nothing, to get there
        later = np.flatnonzero(delays > layer)
        parents.append(at[later])
        at[later] = count + np.arange(len(later))
        count += len(later)
    nothing = np.full(count - len(paths.parents), paths.starts[-1])
    promised = paths.starts[-1] + size * np.arange(1, len(ends) + 1)
    return Paths(
        np.concatenate((*parents, at)),
        np.concatenate((paths.starts, nothing, promised)),
        np.concatenate((paths.cells, goals.cells[after].ravel())),
        np.concatenate((paths.misses, np.repeat(levels, size))),
    ), count + np.arange(len(ends))


def boxes_of(belief: SearchBelief, paths: Paths, goals: Goals) -> NDArray[np.float64]:
    """The boxes of the looks and of each goal, grown by how far the target moves in all layers."""
    frame = belief.frame
    margin = (belief.stencil.reach * belief.horizon + 0.5) * frame.resolution
    boxes = []
    if len(paths.cells):
        row, col = np.divmod(paths.cells, np.uint32(frame.cols))
        x = frame.origin_x + (np.array([col.min(), col.max()]) + 0.5) * frame.resolution
        y = frame.origin_y + (np.array([row.min(), row.max()]) + 0.5) * frame.resolution
        boxes.append(np.array([x[0] - margin, x[1] + margin, y[0] - margin, y[1] + margin]))
    half = goals.side / 2.0 + margin
    boxes.extend(np.array([x - half, x + half, y - half, y + half]) for x, y in goals.places)
    return np.array(boxes).reshape(-1, 4)
