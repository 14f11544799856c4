"""Where the robots stand when a mission begins."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.kernels.distance import distance_field, lengths_to
from vedette.maps.area import Area
from vedette.maps.world import World, reachable_poses, standable
from vedette.sim.indoors import indoors
from vedette.team import PlatformSpec

_GAP = 0.05  # [m] least gap between robots that a user placed
_TOUCH = 1e-6  # [m] overlap that rounding may make
_GAPS = (0.3, 0.1)  # [m] gap between robots that are placed here: at ease, then close
_MARGIN = 64  # [cells] around the spot, in which places are looked for first
_AT_EASE = 0.3  # [m] room around the spot where a team is placed, if the world has any such


def parse_starts(text: str) -> list[tuple[float, ...]]:
    """Read ``"x,y;x,y,heading"`` [m, m, deg] as ``--starts`` gives it.

    Raises:
        InputError: an entry is not two or three finite numbers.
    """
    starts = []
    for number, entry in enumerate(text.strip().strip(";").split(";"), start=1):
        try:
            values = tuple(float(part) for part in entry.split(","))
        except ValueError:
            values = ()
        if len(values) not in (2, 3) or not all(map(math.isfinite, values)):
            raise InputError(
                f"--starts: entry {number} must be x,y or x,y,heading in deg; got {entry.strip()!r}"
            )
        starts.append(values)
    return starts


def choose_starts(
    world: World, specs: Sequence[PlatformSpec], rng: np.random.Generator, area: Area | None = None
) -> NDArray[np.float64]:
    """Return ``f64[n, 3]`` start poses x, y, heading [m, m, rad], team frame.

    A start that a spec gives is checked and kept. The others stand together, 0.3 m apart (0.1 m where that is
    too much), near the first given start or else at a random spot indoors (`vedette.sim.indoors`).

    Raises:
        InputError: a given start is outside, in or too near a wall, beside the team's area, too near another,
            or cut off from the first; or the robots do not all fit.
    """
    everything, world = world, world.within(area)
    if world.solid.all():
        raise InputError(f"area: nothing of {world.name} that is free lies in it; its corners are in m")
    starts = np.zeros((len(specs), 3))
    given = [i for i, spec in enumerate(specs) if spec.start is not None]
    for i in given:
        starts[i] = _checked(everything, specs[i])
        _check_inside(world, specs[i])
        _check_apart(specs, starts, i, [j for j in given if j < i])
    if given:
        _check_together(world, specs, starts, given[0], given)
    others = [i for i in range(len(specs)) if i not in given]
    if others:
        anchor = world.frame.flat(*starts[given[0], :2]) if given else _spot(world, specs, rng)
        _place(world, specs, starts, given, others, anchor)
    return starts


def _checked(world: World, spec: PlatformSpec) -> tuple[float, float, float]:
    assert spec.start is not None
    x, y, *heading = spec.start
    where = f"{spec.name}: start {_told(x)},{_told(y)}"
    if not world.frame.contains(x, y):
        x_min, x_max, y_min, y_max = world.frame.extent
        raise InputError(
            f"{where} is outside the map; x is {_told(x_min)} to {_told(x_max)} m, "
            f"y is {_told(y_min)} to {_told(y_max)} m"
        )
    if world.solid[world.frame.cell(x, y)]:
        raise InputError(f"{where} is in a wall; {_free_spot(world, spec, x, y)}")
    room = clearance(world, x, y, spec.radius + world.frame.resolution)
    if room < spec.radius - _TOUCH:
        raise InputError(
            f"{where} is {room:.2f} m from a wall, its radius is {spec.radius:g} m; "
            f"{_free_spot(world, spec, x, y)}"
        )
    return x, y, math.radians(heading[0]) if heading else 0.0


def _check_inside(world: World, spec: PlatformSpec) -> None:
    """Raise InputError for a start, free in the whole world, that is not in the team's part of it."""
    assert spec.start is not None
    x, y, *_ = spec.start
    if clearance(world, x, y, spec.radius + world.frame.resolution) < spec.radius - _TOUCH:
        raise InputError(
            f"{spec.name}: start {_told(x)},{_told(y)} is not all within the area; "
            f"{_free_spot(world, spec, x, y)}"
        )


def _told(metres: float) -> str:
    """Return a coordinate to the millimetre, as short as can be; UTM has seven digits before the point."""
    return f"{metres:.3f}".rstrip("0").rstrip(".")


def clearance(world: World, x: float, y: float, limit: float) -> float:
    """Return the distance [m] from a point in the grid to the nearest solid cell, at most ``limit``."""
    frame = world.frame
    reach = math.ceil(limit / frame.resolution)
    row, col = frame.cell(x, y)
    low_row, low_col = max(row - reach, 0), max(col - reach, 0)
    window = world.solid[low_row : row + reach + 1, low_col : col + reach + 1]
    rows, cols = np.nonzero(
        np.pad(window, 1, constant_values=True)
    )  # the rim is outside, or beyond the limit
    left = frame.origin_x + (cols + low_col - 1) * frame.resolution
    low = frame.origin_y + (rows + low_row - 1) * frame.resolution
    dx = np.maximum(np.maximum(left - x, x - left - frame.resolution), 0.0)
    dy = np.maximum(np.maximum(low - y, y - low - frame.resolution), 0.0)
    return float(min(np.hypot(dx, dy).min(), limit))


def _free_spot(world: World, spec: PlatformSpec, x: float, y: float) -> str:
    """Name the standable cell nearest to a point, as a remedy."""
    cells = np.flatnonzero(standable(world, spec.radius))
    if not cells.size:
        return f"nowhere in the map does a disc of radius {spec.radius:g} m fit"
    centres = world.frame.centres(cells)
    best = centres[np.hypot(centres[:, 0] - x, centres[:, 1] - y).argmin()]
    return f"the nearest free place is {best[0]:.2f},{best[1]:.2f}"


def _check_apart(
    specs: Sequence[PlatformSpec], starts: NDArray[np.float64], i: int, before: list[int]
) -> None:
    where = f"{specs[i].name}: start {_told(starts[i, 0])},{_told(starts[i, 1])}"
    for j in before:
        apart = math.dist(starts[i, :2], starts[j, :2])
        least = specs[i].radius + specs[j].radius + _GAP
        if apart < least - _TOUCH:
            raise InputError(
                f"{where} is {apart:.2f} m from that of {specs[j].name}; "
                f"keep them at least {least:.2f} m apart"
            )


def _check_together(
    world: World, specs: Sequence[PlatformSpec], starts: NDArray[np.float64], first: int, others: list[int]
) -> None:
    """Require that the smaller of the first robot and each other one could drive from start to start."""
    areas: dict[float, NDArray[np.bool_]] = {}
    for i in others:
        radius = min(specs[first].radius, specs[i].radius)
        if radius not in areas:
            areas[radius] = reachable_poses(world, radius, starts[first, 0], starts[first, 1])
        if not _joins(world, radius, areas[radius], starts[i, 0], starts[i, 1]):
            own = reachable_poses(world, specs[first].radius, starts[first, 0], starts[first, 1])
            raise InputError(
                f"{specs[i].name}: start {_told(starts[i, 0])},{_told(starts[i, 1])} is cut off; "
                f"reachable from {specs[first].name}: {_describe(world, own)}"
            )


def _joins(world: World, radius: float, area: NDArray[np.bool_], x: float, y: float) -> bool:
    """Tell whether a disc can drive from a point to the area, by a search for the nearest of its cells."""
    cells = np.flatnonzero(area)
    if not cells.size:
        return False
    centres = world.frame.centres(cells)
    nearest = cells[[np.hypot(centres[:, 0] - x, centres[:, 1] - y).argmin()]]
    lengths = lengths_to(standable(world, radius), world.frame.flat(x, y), nearest, world.frame.resolution)
    return bool(np.isfinite(lengths[0]))


def _describe(world: World, area: NDArray[np.bool_]) -> str:
    centres = world.frame.centres(np.flatnonzero(area))
    if not len(centres):
        return "nothing"
    (x_min, y_min), (x_max, y_max) = centres.min(axis=0), centres.max(axis=0)
    size = len(centres) * world.frame.resolution**2
    return f"x {x_min:.1f}..{x_max:.1f} m, y {y_min:.1f}..{y_max:.1f} m, {size:.0f} m2"


def _spot(world: World, specs: Sequence[PlatformSpec], rng: np.random.Generator) -> int:
    """Return a random cell indoors where the largest disc fits, with room around if any has."""
    radius = max(spec.radius for spec in specs)
    area = indoors(world, radius)
    if not area.any():
        raise InputError(
            f"nowhere in {world.name} does a disc of radius {radius:g} m fit; use smaller robots"
        )
    roomy = area & standable(world, radius + _AT_EASE)
    return int(rng.choice(np.flatnonzero(roomy if roomy.any() else area)))


def _place(
    world: World,
    specs: Sequence[PlatformSpec],
    starts: NDArray[np.float64],
    given: list[int],
    others: list[int],
    anchor: int,
) -> None:
    """Fill in the others' starts: each takes the place nearest to the anchor by path that is still free.

    Larger robots choose first, since they have the fewer places.
    """
    order = sorted(others, key=lambda i: -specs[i].radius)
    for gap in _GAPS:
        placed = list(given)
        for radius, group in itertools.groupby(order, key=lambda i: specs[i].radius):
            places = _Places(world, radius, anchor)
            for j in placed:
                places.keep_clear(starts[j, :2], radius + specs[j].radius + gap)
            for i in group:
                place = places.take()
                if place is None:
                    break
                starts[i, :2] = place
                placed.append(i)
                places.keep_clear(place, 2 * radius + gap)
        if len(placed) == len(specs):
            return
    if len(specs) == 1:
        raise InputError(f"the robot does not fit in {world.name}; use a smaller one")
    room = {0: "none does", 1: "only 1 does"}.get(len(placed), f"only {len(placed)} do")
    raise InputError(f"{len(specs)} robots do not fit in {world.name}; {room}: use fewer or smaller ones")


class _Places:
    """The places where one size of disc can stand, nearest to the anchor by path first.

    They are sorted in a window about the anchor, which grows once all in it are taken: of a large world few
    are asked for.
    """

    def __init__(self, world: World, radius: float, anchor: int) -> None:
        self._frame = world.frame
        self._anchor = anchor
        self._cells = standable(world, radius)
        self._open = self._cells.copy()
        self._margin = _MARGIN
        self._order = self._nearest()
        self._next = 0

    def _nearest(self) -> NDArray[np.int64]:
        """Return the flat cells that are nearer than any beyond the window, the nearest first."""
        row, col = divmod(self._anchor, self._frame.cols)
        top, left = max(row - self._margin, 0), max(col - self._margin, 0)
        cells = self._cells[top : row + self._margin + 1, left : col + self._margin + 1]
        local = (row - top) * cells.shape[1] + col - left
        field = distance_field(cells, local, self._frame.resolution)
        edges = [
            field[0, :] if top else None,
            field[:, 0] if left else None,
            field[-1, :] if top + cells.shape[0] < self._frame.rows else None,
            field[:, -1] if left + cells.shape[1] < self._frame.cols else None,
        ]
        # No path that leaves the window is shorter than the way to the nearest of its inner edges.
        certain = min((float(edge.min()) for edge in edges if edge is not None), default=math.inf)
        near = np.flatnonzero(np.isfinite(field) & (field <= certain) & cells)
        near = near[np.argsort(field.ravel()[near], kind="stable")]
        rows, cols = np.divmod(near, cells.shape[1])
        return (rows + top) * self._frame.cols + cols + left

    def keep_clear(self, point: NDArray[np.float64], distance: float) -> None:
        """Close the places nearer than ``distance`` [m] to a point."""
        frame = self._frame
        row, col = frame.cell(point[0], point[1])
        reach = math.ceil(distance / frame.resolution) + 1
        rows = np.arange(max(row - reach, 0), min(row + reach + 1, frame.rows))
        cols = np.arange(max(col - reach, 0), min(col + reach + 1, frame.cols))
        dy = frame.origin_y + (rows + 0.5) * frame.resolution - point[1]
        dx = frame.origin_x + (cols + 0.5) * frame.resolution - point[0]
        self._open[np.ix_(rows, cols)] &= np.hypot(dy[:, None], dx[None, :]) >= distance - _TOUCH

    def take(self) -> NDArray[np.float64] | None:
        """Return the nearest place still open, ``None`` if there is none."""
        still_open = self._open.ravel()
        while True:
            while self._next < len(self._order):
                ahead = still_open[self._order[self._next : self._next + 4096]]
                if ahead.any():
                    self._next += int(ahead.argmax())
                    x, y = self._frame.centres(self._order[self._next : self._next + 1])[0]
                    return np.array([x, y])
                self._next += len(ahead)
            if self._margin >= max(self._frame.shape):
                return None
            self._margin *= 4
            self._order = self._nearest()  # begins with those of the smaller window
