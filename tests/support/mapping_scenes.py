"""Small half-explored buildings for the tests of the mapping domain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping import layers
from vedette.domains.mapping.belief import MapBelief, freeze
from vedette.domains.mapping.layers import TimeLayers
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.prior import PriorMap
from vedette.domains.mapping.sightings import empty_counts
from vedette.kernels import lidar
from vedette.kernels.tiles import TiledGrid, Tiling
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.team import PlatformSpec

RESOLUTION = 0.1
FRAME = GridFrame(RESOLUTION, 101, 143, -3.0, 2.0)  # not multiples of a planning cell
SPEC = PlatformSpec(range=4.0)
BEAMS = np.radians(np.arange(360.0) + 0.3)


def building() -> NDArray[np.bool_]:
    """Solid cells of six rooms in two rows, with a corridor between and doors on it."""
    solid = np.zeros(FRAME.shape, bool)
    solid[[0, 1, -1, -2]] = solid[:, [0, 1, -1, -2]] = True
    solid[[42, 43, 58, 59]] = True
    solid[:43, [46, 47, 94, 95]] = solid[59:, [46, 47, 94, 95]] = True
    for col in (20, 68, 116):
        solid[42:44, col : col + 9] = solid[58:60, col : col + 9] = False
    return solid


def explored(places: Sequence[tuple[float, float]], reach: float = 4.0) -> NDArray[np.uint8]:
    """Return the map after one scan from each place, (x, y) [m] in the team frame."""
    grid = TiledGrid(Tiling(*FRAME.shape), np.int8)
    for x, y in places:
        x, y = x - FRAME.origin_x, y - FRAME.origin_y
        ranges = lidar.cast_rays(building(), RESOLUTION, x, y, BEAMS, reach, np.empty((0, 3)))
        hits = np.isfinite(ranges)
        ranges = np.minimum(ranges, reach)
        lidar.integrate_scan(grid, RESOLUTION, x, y, BEAMS, ranges, hits, 4, 2, 20, 0.025)
    log_odds = grid.window()
    return np.where(log_odds > 0, OCCUPIED, np.where(log_odds < 0, FREE, UNKNOWN)).astype(np.uint8)


CORRIDOR = [(-0.5, 7.1), (3.0, 7.1)]  # its left half


def frozen(
    classes: NDArray[np.uint8] | None = None,
    *,
    reach: float = 4.0,
    hidden: float = 2.0,
    worth: TimeLayers | None = None,
    frame: GridFrame = FRAME,
    prior: PriorMap | None = None,
) -> MapBelief:
    """Return the belief of a round; by default on the left half of the corridor."""
    return freeze(
        explored(CORRIDOR) if classes is None else classes,
        frame,
        reach=reach,
        extent=2.5,
        hidden=hidden,
        layers=worth or layers.rate(start=5.0),
        counts=empty_counts(),
        prior=prior,
    )


def plan_of(solid: NDArray[np.bool_]) -> PriorMap:
    """Return a plan of a building as an old map."""
    return PriorMap.of(np.where(solid, OCCUPIED, FREE).astype(np.uint8), FRAME)


def placed(
    platform: MappingPlatform, belief: MapBelief, x: float = -0.5, y: float = 7.1, now: float = 0.0
) -> None:
    """Put a robot somewhere, alone, and let it prepare a round."""
    platform.place(x, y, [], [(0, x, y)], now)
    platform.prepare(belief)
