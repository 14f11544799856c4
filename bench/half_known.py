"""Maps as a mission has them half-way: made by scanning generated offices."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.components import largest
from vedette.kernels.distance import distance_field
from vedette.kernels.lidar import cast_rays, integrate_scan
from vedette.kernels.tiles import TiledGrid, Tiling
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.maps.world import World, standable
from vedette.missions.explore.evidence import CLAMP, GAIN_HIT, GAIN_MISS, NUDGE
from vedette.team import PlatformSpec

SPACING = 0.5  # from one scan to the next [m]
ALONE = np.empty((0, 3))  # no other robots in the scans


def half_known(world: World, spec: PlatformSpec, rng: np.random.Generator) -> NDArray[np.uint8]:
    """Scan a world from poses ever farther from a random start until half of its free cells are known.

    Returns:
        (R, C) classes, as a mission holds them.
    """
    resolution = world.frame.resolution
    log_odds = TiledGrid(Tiling(*world.frame.shape), np.int8)
    angles = np.linspace(0.0, 2 * np.pi, spec.beams, endpoint=False)
    free = ~world.solid
    for count, (x, y) in enumerate(_poses(world, spec, rng)):
        ranges = cast_rays(world.solid, resolution, x, y, angles, spec.range, ALONE)
        hits = np.isfinite(ranges)
        ranges = np.maximum(ranges + rng.normal(0.0, spec.range_noise, len(ranges)), 0.0)
        ranges = np.minimum(ranges, spec.range)
        integrate_scan(
            log_odds, resolution, x, y, angles, ranges, hits, GAIN_HIT, GAIN_MISS, CLAMP, NUDGE * resolution
        )
        if count % 8 == 0 and np.count_nonzero(log_odds.window()[free]) >= 0.5 * np.count_nonzero(free):
            break
    return np.choose(np.sign(log_odds.window()) + 1, (FREE, UNKNOWN, OCCUPIED)).astype(np.uint8)


def _poses(world: World, spec: PlatformSpec, rng: np.random.Generator) -> NDArray[np.float64]:
    """(N, 2) x, y [m] from the corner: where the robot can be, by driving distance from one such place."""
    frame = world.frame
    room = largest(standable(world, spec.radius))
    field = distance_field(room, int(rng.choice(np.flatnonzero(room))), frame.resolution)
    step = max(1, round(SPACING / frame.resolution))
    rows, cols = np.nonzero(np.isfinite(field[::step, ::step]) & room[::step, ::step])
    nearest_first = np.argsort(field[rows * step, cols * step], kind="stable")
    cells = np.column_stack((cols, rows))[nearest_first] * step
    return np.asarray((cells + 0.5) * frame.resolution, np.float64)
