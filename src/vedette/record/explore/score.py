"""How well a mission went, measured against the true world."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.stops import SURE_CLEARANCE
from vedette.kernels.distance import distance_field
from vedette.kernels.visibility import visible_cells
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.maps.area import Area
from vedette.maps.bounds import EVERYWHERE, Extent
from vedette.maps.leave import Leave
from vedette.maps.world import World, reachable_poses, standable
from vedette.team import PlatformSpec


@dataclass(frozen=True, eq=False)
class Reference:
    """What a team can see of a world at all; coverage is measured against it."""

    world: World
    specs: Sequence[PlatformSpec]
    starts: NDArray[np.float64]  # (n, 3) x, y, heading [m, m, rad], team frame
    no_go: tuple[Area, ...] = ()  # where nobody may go, and nothing counts
    places: Mapping[int, tuple[float, float]] = field(default_factory=dict)  # of who lived then, by index [m]

    @cached_property
    def coverable(self) -> NDArray[np.bool_]:
        """``bool[rows, cols]``: free cells seen without noise from poses a disc can reach from its start.

        Where something is forbidden, a disc has to reach them from its place by then, and round that; it is
        wall to what is planned, so nothing beyond it is seen through it.
        """
        if not self.no_go:
            return self.visible
        leave = Leave(no_go=self.no_go)
        closed = leave.close(self.world.classes(), self.world.frame) != FREE
        left = World(self.world.frame, closed, self.world.name)
        poses = dict[tuple[float, float], NDArray[np.bool_]]()  # by body
        for robot, (x, y) in self.places.items():
            spec = self.specs[robot]
            body = spec.radius, spec.range
            there = poses.setdefault(body, np.zeros_like(closed))
            there |= self._left_to(left, spec.radius + SURE_CLEARANCE, x, y, there)
        allowed = leave.holds(self.world.frame)
        seen: NDArray[np.bool_] = np.zeros_like(closed)
        for (_, reach), there in poses.items():
            seen |= visible_cells(self.world.solid | ~allowed, there, reach / self.world.frame.resolution)
        return seen & self.visible & allowed

    def _left_to(
        self, left: World, radius: float, x: float, y: float, before: NDArray[np.bool_]
    ) -> NDArray[np.bool_]:
        """Return the poses left to a disc, or those of one before it that gets to the same.

        One that stands where nobody may be leaves by the shortest way.
        """
        frame, out = self.world.frame, standable(left, radius)
        away = distance_field(standable(self.world, radius), frame.flat(x, y), frame.resolution)
        nearest = int(np.argmin(np.where(out, away, np.inf)))
        if not out.flat[nearest] or not np.isfinite(away.flat[nearest]):
            return np.zeros_like(out)
        if before.flat[nearest]:
            return before
        return np.isfinite(distance_field(out, nearest, frame.resolution)) & out

    @property
    def forbidden_m2(self) -> float:
        """How much of what could be covered nobody may see [m^2]."""
        return self._square_metres(self.visible & ~Leave(no_go=self.no_go).holds(self.world.frame))

    @property
    def cut_off_m2(self) -> float:
        """How much more of it nobody gets to any more, because of what is forbidden [m^2]."""
        return self._square_metres(self.visible & ~self.coverable) - self.forbidden_m2

    @cached_property
    def visible(self) -> NDArray[np.bool_]:
        """``bool[rows, cols]``: the same, were nothing forbidden."""
        seen = np.zeros_like(self.world.solid)
        bodies = {
            (spec.radius, spec.range): start for spec, start in zip(self.specs, self.starts, strict=True)
        }
        for (radius, reach), start in bodies.items():
            poses = reachable_poses(self.world, radius + SURE_CLEARANCE, start[0], start[1])
            seen |= visible_cells(self.world.solid, poses, reach / self.world.frame.resolution)
        return seen & ~self.world.solid

    @cached_property
    def cells(self) -> int:
        """Number of coverable cells."""
        return int(np.count_nonzero(self.coverable))

    def _square_metres(self, cells: NDArray[np.bool_]) -> float:
        return float(np.count_nonzero(cells)) * self.world.frame.resolution**2


def coverage(reference: Reference, classes: NDArray[np.uint8], known: Extent = EVERYWHERE) -> float:
    """Return the share of coverable cells that ``classes[rows, cols]`` knows; 1 where none is coverable.

    Outside the rows and columns ``known`` it knows nothing.
    """
    found = np.count_nonzero((classes[known] != UNKNOWN) & reference.coverable[known])
    return found / reference.cells if reference.cells else 1.0


def map_errors(world: World, classes: NDArray[np.uint8]) -> tuple[int, int]:
    """Return ``(wrong, known)`` cells of a map.

    A known cell is wrong where it is free but solid in truth, or occupied but free, and all its eight
    neighbours are in truth of its own kind: next to a true boundary a range error below a cell decides.
    Outside the grid counts as solid.
    """
    rows, cols = _where(classes != UNKNOWN)
    solid, classes = world.solid[rows, cols], classes[rows, cols]
    wrong = np.where(solid, classes == FREE, classes == OCCUPIED)
    wrong &= ~_near_boundary(world.solid, rows, cols)
    return int(wrong.sum()), int(np.count_nonzero(classes != UNKNOWN))


def _where(known: NDArray[np.bool_]) -> Extent:
    """Return the rows and columns outside of which there is nothing."""
    rows, cols = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return slice(0, 0), slice(0, 0)
    return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(cols[0]), int(cols[-1]) + 1)


def overlap(own_known: Iterable[NDArray[np.bool_]]) -> float:
    """Return the share of the known cells that at least two robots saw themselves; 0 where none is known.

    ``own_known`` holds for each robot ``bool[rows, cols]``: the cells that its own sensor observed.
    """
    once: NDArray[np.bool_] | None = None
    for seen in own_known:  # one at a time: grids may be large, and many
        if once is None:
            once, twice = seen.copy(), np.zeros_like(seen)
        else:
            twice |= once & seen
            once |= seen
    known = 0 if once is None else np.count_nonzero(once)
    return float(np.count_nonzero(twice) / known) if known else 0.0


@dataclass
class CoverageProgress:
    """Coverage against time, constant between samples and 0 before the first."""

    times: list[float] = field(default_factory=list)  # [s], not descending
    coverages: list[float] = field(default_factory=list)

    def add(self, t: float, coverage: float) -> None:
        """Append a sample at ``t`` [s], which is not before the last one's."""
        if self.times and t < self.times[-1]:
            raise ValueError(f"samples come in time order; {t} s is before {self.times[-1]} s")
        self.times.append(t)
        self.coverages.append(coverage)

    def t_at(self, level: float) -> float | None:
        """Return the first sampled time [s] with coverage >= ``level``, ``None`` if never."""
        reached = (t for t, coverage in zip(self.times, self.coverages, strict=True) if coverage >= level)
        return next(reached, None)

    def auc(self, t_end: float) -> float:
        """Return the integral of ``1 - coverage`` from 0 to ``t_end``, in seconds of a wholly unknown map."""
        steps = np.minimum(np.array([0.0, *self.times, np.inf]), t_end)
        return float(np.diff(steps) @ (1.0 - np.array([0.0, *self.coverages])))


def _near_boundary(solid: NDArray[np.bool_], rows: slice, cols: slice) -> NDArray[np.bool_]:
    """Return which cells of some rows and columns have an 8-neighbour of the other kind."""
    top, left = max(rows.start - 1, 0), max(cols.start - 1, 0)
    near = solid[top : rows.stop + 1, left : cols.stop + 1]
    shape = rows.stop - rows.start, cols.stop - cols.start
    padded = np.ones((shape[0] + 2, shape[1] + 2), np.bool_)
    first = top - rows.start + 1, left - cols.start + 1
    padded[first[0] : first[0] + near.shape[0], first[1] : first[1] + near.shape[1]] = near
    some, every = np.zeros(shape, np.bool_), np.ones(shape, np.bool_)
    for row in range(3):
        for col in range(3):
            window = padded[row : row + shape[0], col : col + shape[1]]
            some |= window
            every &= window
    return some & ~every
