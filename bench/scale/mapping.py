"""Mapping teams: robots on a floor of equal rooms, each with some tours around it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.scale.team import Lots, Team
from vedette.domains.mapping.belief import MapBelief, freeze, frontier_limits, longest_frontier
from vedette.domains.mapping.impact import NOTHING, Impact, MapImpactCodec
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.planners import planner
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.sightings import empty_counts
from vedette.kernels.coverage import LAYERS
from vedette.kernels.frontier import find_frontiers
from vedette.kernels.lidar import cast_rays, integrate_scan
from vedette.kernels.tiles import TiledGrid, Tiling
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.missions.explore.evidence import CLAMP, GAIN_HIT, GAIN_MISS, NUDGE
from vedette.problem import Reach
from vedette.team import PlatformSpec

LOT = 5.0  # a room [m]
RESOLUTION = 0.1  # [m]
ROOM = 5.0  # side of a room, half its wall included [m]
DOOR = 1.2  # in the middle of every wall [m]
SPEC = PlatformSpec(range=2.0)
AROUND = 4.0  # a robot plans tours this far around it, each way [m]
TOURS, STOPS = 8, 2  # candidates of each, and stops of each of those
FIXED_ROOMS, FIXED_SCANS = 2, 2  # rooms along each side of the fixed area, and places it was seen from
EXTENT = longest_frontier(SPEC.range)  # [m]


def dense(lots: Lots, rng: np.random.Generator) -> Team:
    """Return robots that have each looked about from where they are, one a room."""
    solid = rooms(round(lots.rows * lots.side / ROOM), round(lots.cols * lots.side / ROOM))
    places = _in_rooms(lots.places(rng))
    return _team(solid, places, places)


def fixed(n: int, rng: np.random.Generator) -> Team:
    """Return n robots on a floor of four rooms that was seen from two places, near one of them each."""
    side = FIXED_ROOMS * ROOM
    seen = _in_rooms(rng.uniform(0.0, side, (FIXED_SCANS, 2)))
    places = seen[rng.integers(FIXED_SCANS, size=n)] + rng.uniform(-1.0, 1.0, (n, 2))
    return _team(rooms(FIXED_ROOMS, FIXED_ROOMS), seen, places)


def rooms(rows: int, cols: int) -> NDArray[np.bool_]:
    """Return the solid cells of a floor of so many square rooms, with a door in every wall."""
    cells = round(ROOM / RESOLUTION)
    room = np.zeros((cells, cells), bool)
    room[[0, -1]] = room[:, [0, -1]] = True
    first, width = round((ROOM - DOOR) / 2.0 / RESOLUTION), round(DOOR / RESOLUTION)
    room[:, first : first + width] = room[first : first + width] = False
    return np.tile(room, (rows, cols))


def _in_rooms(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Move points into the middle of their rooms, but for a metre, so that nobody stands in a wall."""
    corner = points // ROOM * ROOM
    return np.asarray(corner + 1.5 + (points - corner) * ((ROOM - 3.0) / ROOM))


def _team(solid: NDArray[np.bool_], seen: NDArray[np.float64], places: NDArray[np.float64]) -> Team:
    """Return the team on the map that scans from the places ``seen`` make."""
    frame = GridFrame(RESOLUTION, solid.shape[0], solid.shape[1], 0.0, 0.0)
    tours = planner("tours")
    belief = freeze(
        _scanned(solid, seen),
        frame,
        reach=SPEC.range,
        extent=EXTENT,
        hidden=tours.hidden,
        return_price=tours.return_price,
        layers=tours.layers,
        counts=empty_counts(),
    )
    candidates = [_tours(belief, x, y) for x, y in places.tolist()]
    codec = MapImpactCodec(belief.planning.size)
    reaches = [_reach(belief, own) for own in candidates]
    return Team(MappingObjective(), belief, places, candidates, reaches, codec, codec.bound)


def _scanned(solid: NDArray[np.bool_], places: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return (R, C) classes as one scan from each place shows them."""
    log_odds = TiledGrid(Tiling(*solid.shape), np.int8)
    angles = np.linspace(0.0, 2.0 * np.pi, SPEC.beams, endpoint=False)
    for x, y in places.tolist():
        ranges = cast_rays(solid, RESOLUTION, x, y, angles, SPEC.range, np.empty((0, 3)))
        hits, ranges = np.isfinite(ranges), np.minimum(ranges, SPEC.range)
        nudge = NUDGE * RESOLUTION
        integrate_scan(log_odds, RESOLUTION, x, y, angles, ranges, hits, GAIN_HIT, GAIN_MISS, CLAMP, nudge)
    return np.choose(np.sign(log_odds.window()) + 1, (FREE, UNKNOWN, OCCUPIED)).astype(np.uint8)


def _tours(belief: MapBelief, x: float, y: float) -> list[Impact]:
    """What a robot at (x, y) would see on tours that begin with each of its nearest stops."""
    near = _window(belief, x, y)
    platform = MappingPlatform(SPEC, max_stops=STOPS)
    platform.place(x, y, [], [(0, x, y)], 0.0)
    platform.prepare(near)
    stops = platform.stops
    assert stops is not None
    found: list[Impact] = []
    for first in np.argsort(stops.first_leg, kind="stable")[:TOURS]:
        order, left = [int(first)], stops.legs.copy()
        while len(order) < min(STOPS, len(stops)):
            left[:, order] = np.inf
            order.append(int(np.argmin(left[order[-1]])))
        found.append(platform.impact(near, platform.tour(np.array(order))))
    return found or [NOTHING]


def _window(belief: MapBelief, x: float, y: float) -> MapBelief:
    """Return the belief as a robot sees it that plans within ``AROUND`` of (x, y)."""
    factor, frame = belief.factor, belief.frame
    corner = frame.cell(max(frame.origin_x, x - AROUND), max(frame.origin_y, y - AROUND))
    low = np.array(corner) // factor * factor
    high = np.minimum(low + round(2.0 * AROUND / frame.resolution), frame.shape)
    rows, cols = slice(int(low[0]), int(high[0])), slice(int(low[1]), int(high[1]))
    classes = belief.classes[rows, cols].copy()
    cells, starts = find_frontiers(classes, *frontier_limits(EXTENT, frame.resolution))
    return replace(
        belief,
        frame=GridFrame(
            frame.resolution,
            classes.shape[0],
            classes.shape[1],
            frame.origin_x + low[1] * frame.resolution,
            frame.origin_y + low[0] * frame.resolution,
        ),
        classes=classes,
        first=(belief.first[0] + rows.start // factor, belief.first[1] + cols.start // factor),
        unknown=np.ascontiguousarray(
            belief.unknown[
                rows.start // factor : -(-rows.stop // factor), cols.start // factor : -(-cols.stop // factor)
            ]
        ),
        frontier_cells=cells,
        frontier_starts=starts,
    )


def _reach(belief: MapBelief, candidates: list[Impact]) -> Reach:
    """Return the box around all planning cells that the candidates would see [m]."""
    cells = np.concatenate([impact.keys for impact in candidates]) // LAYERS
    if not len(cells):
        return ()
    row, col = np.divmod(cells, belief.planning.cols)
    side, x, y = belief.planning.resolution, belief.planning.origin_x, belief.planning.origin_y
    return (
        (
            x + float(col.min()) * side,
            y + float(row.min()) * side,
            x + float(col.max() + 1) * side,
            y + float(row.max() + 1) * side,
        ),
    )
