"""What one robot could do in a round: the stops it can reach, what each would reveal, how long legs take."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.as_seen import as_seen
from vedette.domains.mapping.beams import apart, between
from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.blur import blurred
from vedette.domains.mapping.impact import MIN_SHARE, quantise
from vedette.domains.mapping.looks import LooksTaken
from vedette.domains.mapping.prior import Foresight, Shares
from vedette.domains.mapping.sightings import SightingModel
from vedette.domains.mapping.worlds import over_worlds
from vedette.kernels import coverage, distance, frontier
from vedette.kernels.coverage import Footprints, Viewpoints
from vedette.maps import FREE, UNKNOWN, GridFrame
from vedette.maps.bounds import Extent
from vedette.sensor import CheckedSensor
from vedette.team import PlatformSpec

LEAST_SHARE = 0.0008  # of the area known to be free that a stop must promise ...
ENOUGH = 0.35  # ... but no more than this [m^2]
NEARBY = 0.6  # along either axis from a frontier's middle, a cell is near it [m]
LEAST_OF_SIGHT = 0.05  # of the area that one scan can see at most: enough for any stop
PROMISED = 0.08  # an area that an old map promises is worth a stop [m^2]
GAP = 2.0  # a gap that the body does not fit through must promise so many times as much
LEFT_ALONE = 0.5  # what holds for a place holds for frontiers this near it [m] ...
LEFT_ALONE_AT_LAST = 0.25  # ... or this near, for a robot with nothing else left: a visit opens others [m]
VIEW_REACH = 0.8  # how far from a frontier to look for a place to see it from [sensor ranges]
CLOSE_VIEW = 1.0  # the same where the farther place leads nowhere [m]
CLEARANCES = (0.05, 0.01)  # kept to all that is not known free [m]; the second where the first leads nowhere
SURE_CLEARANCE = 0.025  # where what is solid in truth leaves so much, noisy maps leave the lesser one [m]
Disc = tuple[float, float, float]  # x, y, radius [m], team frame


@dataclass(frozen=True, eq=False)
class Ground:
    """Where one robot can drive, and how far everything is from it."""

    passable: NDArray[np.bool_]  # (R, C) of the belief's window
    source: int  # the robot's own cell
    field: NDArray[np.float32]  # (R, C) path length from the robot [m], inf where unreachable
    dared: bool = False  # some of it is free only if what is doubtful is


@dataclass(frozen=True, eq=False)
class Stops:
    """K candidate viewpoints, one a frontier."""

    targets: NDArray[np.float64]  # (K, 2) the frontier's middle [m], team frame
    views: NDArray[np.float64]  # (K, 2) where to stand [m], team frame
    unknown: NDArray[np.int64]  # (K,) unknown cells near the frontier, to tell whether a visit changed it
    footprints: Footprints
    first_leg: NDArray[np.float32]  # (K,) travel time from here [s], inf where unreachable
    legs: NDArray[np.float32]  # (K, K) travel time between [s], inf where unreachable
    foreseen: int = 0  # so many of them, the last, are places that nobody has seen yet

    def __len__(self) -> int:
        return len(self.targets)

    def shut(self, which: NDArray[np.bool_]) -> Stops:
        """Return them with some, ``(K,)``, out of reach."""
        first_leg, legs = self.first_leg.copy(), self.legs.copy()
        first_leg[which] = np.inf
        legs[:, which] = np.inf
        return replace(self, first_leg=first_leg, legs=legs)


def survey(
    belief: MapBelief,
    spec: PlatformSpec,
    x: float,
    y: float,
    discs: list[Disc],
    clearance: float,
    doubtful: NDArray[np.bool_] | None = None,
) -> Ground:
    """Find where a robot at (x, y) can drive in the belief's window, around discs that stand still.

    With ``doubtful``, ``(R, C)`` occupied cells of the window, as if these were free.
    """
    frame, classes = belief.frame, belief.classes
    if doubtful is not None:
        classes = np.where(doubtful, np.uint8(FREE), classes)
    passable = frontier.traversable(classes, spec.radius + clearance, frame.resolution)
    for disc in discs:
        block(passable, frame, disc, spec.radius + clearance)
    row, col = np.clip(frame.cell(x, y), 0, (frame.rows - 1, frame.cols - 1))
    source = int(row * frame.cols + col)
    field = distance.distance_field(passable, source, frame.resolution)
    return Ground(passable, source, field, dared=doubtful is not None)


def block(passable: NDArray[np.bool_], frame: GridFrame, disc: Disc, radius: float) -> None:
    """Make the cells impassable whose centres a robot of this radius cannot occupy beside the disc."""
    x, y, size = disc
    reach = int(np.ceil((size + radius) / frame.resolution)) + 1
    row, col = frame.cell(x, y)
    first_row, first_col = max(0, row - reach), max(0, col - reach)
    near = passable[first_row : max(0, row + reach + 1), first_col : max(0, col + reach + 1)]
    rows = frame.origin_y + (np.arange(near.shape[0]) + first_row + 0.5) * frame.resolution - y
    cols = frame.origin_x + (np.arange(near.shape[1]) + first_col + 0.5) * frame.resolution - x
    near[rows[:, None] ** 2 + cols**2 < (size + radius) ** 2] = False


def around(frame: GridFrame, x: float, y: float) -> Extent:
    """Return the rows and columns of a square of about 1.2 m around a point."""
    reach = max(1, round(NEARBY / frame.resolution))
    row, col = frame.cell(x, y)
    return (
        slice(max(0, row - reach), max(0, row + reach + 1)),
        slice(max(0, col - reach), max(0, col + reach + 1)),
    )


def unknown_near(classes: NDArray[np.uint8], frame: GridFrame, x: float, y: float) -> int:
    """Count the unknown cells in a square of about 1.2 m around a point."""
    return int(np.count_nonzero(classes[around(frame, x, y)] == UNKNOWN))


def find_stops(
    belief: MapBelief,
    ground: Ground,
    spec: PlatformSpec,
    model: SightingModel,
    least_area: float,
    found: Viewpoints,
    *,
    dare: float = 0.0,
    tours: bool = True,
    stall: float = 0.0,
) -> Stops:
    """Turn viewpoints into stops that reveal at least ``least_area`` [m^2] in expectation.

    On dared ground none reveals less than ``dare`` [m^2], however little the robot sees at once.

    In a large building a stop must promise more than in a small one, and a gap that the body does not fit
    through more than another: behind most of them is the inside of a wall or of furniture, and nothing leads
    on.  docs/theory.md (V66)
    A robot that stalls, ``stall`` times a metre, does not get there with the probability that grows with the
    way: it then stands where nothing is unknown.  docs/theory.md (V107)
    Legs between stops are worked out for ``tours`` only; else they are infinite.
    """
    frame, targets, views = belief.frame, found.targets, found.views
    valued, *looks = _where_valued(belief, targets, views)
    starts, cells, shares = to_be_seen(valued, spec, model, *looks)
    seen = shares * valued.to_see.ravel()[cells]
    area = _by_look(seen, starts)
    lengths = np.diff(belief.frontier_starts)[found.clusters] * frame.resolution
    least = _least(belief, lengths <= 2.0 * spec.radius + 1e-9, least_area)
    if belief.foresight is not None:  # what an old map promises is there
        sure = _by_look(seen * belief.trust.ravel()[cells], starts) / np.maximum(area, 1e-6)
        least = sure * np.minimum(max(PROMISED, least_area), least) + (1.0 - sure) * least
    asked = np.maximum(np.minimum(least, enough_of_sight(spec)), dare if ground.dared else 0.0)
    enough = area * frame.resolution**2 >= asked
    starts, cells, shares = _select(starts, cells, shares, enough)
    targets, views = targets[enough], views[enough]
    way = ground.field.ravel()[views]
    arrives = np.exp(-stall * np.where(np.isfinite(way), way, 0.0)).astype(np.float32)
    expected = shares * np.repeat(arrives, np.diff(starts))
    target_points, view_points = frame.centres(targets), frame.centres(views)
    return Stops(
        target_points,
        view_points,
        np.array([unknown_near(belief.classes, frame, x, y) for x, y in target_points], np.int64),
        Footprints(starts, valued.planning_cells(cells), quantise(expected)),
        way / np.float32(spec.speed),
        legs_between(belief, ground, views) / np.float32(spec.speed) if tours else _no_legs(len(views)),
    )


def _where_valued(
    belief: MapBelief, targets: NDArray[np.int64], views: NDArray[np.int64]
) -> tuple[MapBelief, NDArray[np.int64], NDArray[np.int64]]:
    """Return the belief on which looks are valued, and the cells of targets and views as they lie there."""
    if belief.valued is None:
        return belief, targets, views
    drawn, there = belief.valued
    frame, ends = drawn.frame, np.concatenate((targets, views))
    x, y = there.places(belief.frame.centres(ends)).T
    col = np.floor((x - frame.origin_x) / frame.resolution).astype(np.int64)
    row = np.floor((y - frame.origin_y) / frame.resolution).astype(np.int64)
    cells = np.clip(row, 0, frame.rows - 1) * frame.cols + np.clip(col, 0, frame.cols - 1)
    return drawn, cells[: len(targets)], cells[len(targets) :]


def seen_from(spec: PlatformSpec, resolution: float, close: bool) -> float:
    """Return from how far a frontier is looked at [m]; no nearer than the robot gets to it."""
    far = VIEW_REACH * spec.range
    return min(max(min(CLOSE_VIEW, far) if close else far, nearest_view(spec, resolution)), spec.range)


def nearest_view(spec: PlatformSpec, resolution: float) -> float:
    """Return how near a robot gets to a frontier that it is before [m]."""
    return spec.radius + CLEARANCES[0] + 2.0 * resolution


def enough_of_sight(spec: PlatformSpec) -> float:
    """Return an area that is always worth a visit to a robot that sees so little [m^2]."""
    return float(LEAST_OF_SIGHT * 0.5 * np.radians(spec.view) * spec.range**2)


def _by_look(values: NDArray[np.float32], starts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Add up what belongs to each look."""
    total: NDArray[np.float64] = np.add.reduceat(np.append(values, 0.0), starts[:-1])
    return total * (np.diff(starts) > 0)


def to_be_seen(
    belief: MapBelief,
    spec: PlatformSpec,
    model: SightingModel,
    targets: NDArray[np.int64],
    views: NDArray[np.int64],
) -> Shares:
    """Return what looks from the views are expected to reveal in each world."""
    cols = belief.frame.cols
    toward = np.arctan2(targets // cols - views // cols, targets % cols - views % cols)
    sharp = _footprints(belief, belief.classes, spec, model, views, toward)
    plain = blurred(sharp, belief.unknown, spec.pose_std / belief.planning.resolution)
    return in_worlds(belief, spec, views, toward, plain)


def in_worlds(
    belief: MapBelief,
    spec: PlatformSpec,
    views: NDArray[np.int64],
    toward: NDArray[np.float64],
    plain: Shares | None = None,
) -> Shares:
    """Return what looks reveal in each world, the mean over whether what is foreseen in it is right.

    ``plain``: what they do of what is not foreseen; None: nobody gets there then, so nothing.
    """
    if plain is None:
        plain = np.zeros(len(views) + 1, np.int64), np.empty(0, np.uint32), np.empty(0, np.float32)
    return over_worlds(
        [
            plain
            if foresight is None
            else foresight.mean(plain, _if_right(belief, foresight, spec, views, toward), belief.unknown)
            for foresight in belief.worlds
        ]
    )


def _if_right(
    belief: MapBelief,
    foresight: Foresight,
    spec: PlatformSpec,
    views: NDArray[np.int64],
    toward: NDArray[np.float64],
) -> Shares:
    """Return what looks reveal if an old map is right: all that no wall of it hides, within range."""
    sure = SightingModel(np.ones((1, 1), np.float32), by_distance=True)
    sharp = _footprints(belief, foresight.classes, spec, sure, views, toward)
    return blurred(sharp, foresight.seeable, spec.pose_std / belief.planning.resolution)


def _footprints(
    belief: MapBelief,
    classes: NDArray[np.uint8],
    spec: PlatformSpec,
    model: SightingModel,
    views: NDArray[np.int64],
    toward: NDArray[np.float64],
) -> Shares:
    reach, view = spec.range / belief.frame.resolution, float(np.radians(spec.view))
    rays = _rays(spec, belief.frame.resolution)

    def work_out(new: list[int]) -> Shares:
        return coverage.footprints(
            classes, belief.berths, views[new], toward[new], reach, view,
            model.table, model.by_distance, rays, belief.factor, MIN_SHARE,
        )  # fmt: skip

    lidar = id(classes), reach, view, model.table.tobytes(), model.by_distance, rays
    looks = list(zip(views.tolist(), toward.tolist(), strict=True))
    seen = LooksTaken.at(belief).reveal(lidar, looks, work_out)
    sensor = CheckedSensor.of(spec)
    return seen if sensor is None else as_seen(sensor, belief, seen, views, toward)


def _rays(spec: PlatformSpec, resolution: float) -> int:
    """As many rays in a full turn as a look takes; more than one a cell at full range tell nothing."""
    looks = apart(spec, VIEW_REACH * spec.range, resolution)
    rays = spec.beams * 360.0 / spec.view if looks == between(spec) else 2 * np.pi / looks
    return int(min(np.ceil(2 * np.pi * spec.range / resolution), np.ceil(rays)))


def _select(
    starts: NDArray[np.int64],
    cells: NDArray[np.uint32],
    shares: NDArray[np.float32],
    rows: NDArray[np.bool_],
) -> Shares:
    sizes = np.diff(starts)
    entries = np.repeat(rows, sizes)
    return np.concatenate(([0], np.cumsum(sizes[rows]))), cells[entries], shares[entries]


def _least(belief: MapBelief, gap: NDArray[np.bool_], floor: float) -> NDArray[np.float64]:
    free = int(np.count_nonzero(belief.classes == FREE)) * belief.frame.resolution**2
    least = min(LEAST_SHARE * free, ENOUGH)
    return np.maximum(np.where(gap, GAP * least, least), floor)


def _no_legs(stops: int) -> NDArray[np.float32]:
    return np.full((stops, stops), np.inf, np.float32)


def legs_between(belief: MapBelief, ground: Ground, views: NDArray[np.int64]) -> NDArray[np.float32]:
    """Path lengths between viewpoints, on the planning grid: a planning cell is passable if any of it is."""
    factor, cols = belief.factor, belief.frame.cols
    rows_over, cols_over = -belief.frame.rows % factor, -cols % factor
    padded = np.pad(ground.passable, ((0, rows_over), (0, cols_over)))
    coarse = np.zeros(belief.unknown.shape, bool)
    for row in range(factor):
        for col in range(factor):
            coarse |= padded[row::factor, col::factor]
    cells = views // cols // factor * belief.unknown.shape[1] + views % cols // factor
    return distance.distance_matrix(coarse, cells, belief.planning.resolution, np.inf)
