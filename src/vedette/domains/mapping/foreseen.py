"""Stops that an old map lets foresee: places that nobody has seen yet, from which much more is to be seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import quantise
from vedette.domains.mapping.prior import Shares
from vedette.domains.mapping.stops import Ground, Stops, in_worlds, legs_between, unknown_near
from vedette.kernels.coverage import Footprints
from vedette.kernels.misses import STEPS_PER_NAT
from vedette.maps import FREE, UNKNOWN
from vedette.team import PlatformSpec

APART = 1.4  # between places that are considered [m]
TRUSTED = 0.5  # plans lead over ground that an old map says is free and is right about with this probability
WORTH_A_PLACE = 1.0  # a place must add so much to what all other stops show [m^2] ...
MOST_PLACES = 24  # ... and so many are taken at most
LONG_TOUR = 12  # stops, where tours lead on into what is foreseen


def supposed(belief: MapBelief) -> MapBelief:
    """Return a belief in which is known what is free, and trusted to be, in at least half of the worlds."""
    rows, cols = belief.classes.shape
    open_ = np.zeros(belief.classes.shape, np.int64)
    for world in belief.worlds:
        if world is not None:
            trusted = np.repeat(np.repeat(world.trust >= TRUSTED, belief.factor, 0), belief.factor, 1)
            open_ += trusted[:rows, :cols] & (world.classes == UNKNOWN)
    free = (belief.classes == UNKNOWN) & (2 * open_ >= len(belief.worlds))
    return replace(belief, classes=np.where(free, np.uint8(FREE), belief.classes))


def with_foreseen(belief: MapBelief, ground: Ground, spec: PlatformSpec, stops: Stops) -> Stops:
    """Return the stops at frontiers, and after them those that are foreseen.

    Nobody can drive to a foreseen one yet: the way leads by the frontier stop that makes it shortest, and
    that sum is its first leg.

    Args:
        belief: of the round.
        ground: where the robot could drive if it were as supposed.
        spec: the robot.
        stops: at frontiers.
    """
    places = _places(belief, ground)
    if not len(places):
        return stops
    looks = in_worlds(belief, spec, places, _away_from(ground, places, belief.frame.cols))
    left = (belief.to_see * belief.trust).ravel().astype(np.float64)
    shown, missed = _shown(belief, stops.footprints)
    left[shown] *= missed
    chosen = _cover(looks, left, WORTH_A_PLACE / belief.frame.resolution**2)
    views = np.concatenate((_cells_of(belief, stops.views), places[chosen]))
    legs = legs_between(belief, ground, views) / np.float32(spec.speed)
    at_frontiers = np.where(np.isfinite(stops.legs), legs[: len(stops), : len(stops)], np.float32(np.inf))
    legs[: len(stops), : len(stops)] = at_frontiers
    legs[:, : len(stops)][:, np.isinf(stops.first_leg)] = np.inf
    by_way_of = (stops.first_leg[:, None] + legs[: len(stops), len(stops) :]).min(axis=0, initial=np.inf)
    rows = [slice(*looks[0][k : k + 2]) for k in chosen]
    marks, points = stops.footprints, belief.frame.centres(places[chosen])
    cells = np.concatenate([np.empty(0, np.uint32), *(looks[1][row] for row in rows)])
    shares = np.concatenate([np.empty(0, np.float32), *(looks[2][row] for row in rows)])
    ends = marks.starts[-1] + np.cumsum([row.stop - row.start for row in rows], dtype=np.int64)
    near = [unknown_near(belief.classes, belief.frame, x, y) for x, y in points]
    return Stops(
        np.concatenate((stops.targets, points)),
        np.concatenate((stops.views, points)),
        np.concatenate((stops.unknown, np.array(near, np.int64))),
        Footprints(
            np.concatenate((marks.starts, ends)),
            np.concatenate((marks.cells, belief.planning_cells(cells))),
            np.concatenate((marks.misses, quantise(shares))),
        ),
        np.concatenate((stops.first_leg, by_way_of.astype(np.float32))),
        legs,
        len(chosen),
    )


def by_way_of_frontier(stops: Stops, order: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return a tour that begins at a frontier: before a foreseen stop comes the one that it is reached by."""
    frontiers = len(stops) - stops.foreseen
    if order[0] < frontiers:
        return order
    first = np.argmin(stops.first_leg[:frontiers] + stops.legs[:frontiers, order[0]])
    return np.concatenate(([first], order[order != first]))


def _places(belief: MapBelief, ground: Ground) -> NDArray[np.int64]:
    """Return the unknown cells, about ``APART`` from each other, at which the robot could stand; flat."""
    step = max(1, round(APART / belief.planning.resolution)) * belief.factor
    rows, cols = belief.classes.shape
    row = np.arange((step // 2 - belief.first[0] * belief.factor) % step, rows, step)
    col = np.arange((step // 2 - belief.first[1] * belief.factor) % step, cols, step)
    flat = (row[:, None] * cols + col).ravel()
    there = ground.passable.ravel()[flat] & np.isfinite(ground.field.ravel()[flat])
    return np.asarray(flat[there & (belief.classes.ravel()[flat] == UNKNOWN)])


def _away_from(ground: Ground, places: NDArray[np.int64], cols: int) -> NDArray[np.float64]:
    """Return where a robot faces that comes to places from where it is [rad]."""
    rows, columns = places // cols - ground.source // cols, places % cols - ground.source % cols
    return np.asarray(np.arctan2(rows, columns))


def _cover(looks: Shares, left: NDArray[np.float64], least: float) -> list[int]:
    """Return looks, each of which adds the most to those before, until none adds ``least``.

    Args:
        looks: what each shows.
        left: (N,) what is to be seen of each planning cell in each world [cells]; less and less is.
        least: [cells].
    """
    starts, cells, shares = looks
    chosen: list[int] = []
    while len(chosen) < MOST_PLACES:
        gains = np.add.reduceat(np.append(shares * left[cells], 0.0), starts[:-1]) * (np.diff(starts) > 0)
        best = int(np.argmax(gains))
        if gains[best] < least:
            break
        chosen.append(best)
        row = slice(*starts[best : best + 2])
        left[cells[row]] *= 1.0 - shares[row]
    return chosen


def _shown(belief: MapBelief, marks: Footprints) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return what of the window stops show, in each world, and how likely all of them miss it."""
    cells, where = np.unique(marks.cells, return_inverse=True)
    missed = np.exp(-np.bincount(where, marks.misses, len(cells)) / STEPS_PER_NAT)
    worlds = len(belief.worlds)
    row, col = np.divmod(cells.astype(np.int64), belief.planning.cols * worlds)
    wide = belief.unknown.shape[1] * worlds
    return (row - belief.first[0]) * wide + col - belief.first[1] * worlds, missed


def _cells_of(belief: MapBelief, places: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the flat cells of the window that places (K, 2) [m] lie in."""
    return np.array([belief.frame.flat(x, y) for x, y in places], np.int64)
