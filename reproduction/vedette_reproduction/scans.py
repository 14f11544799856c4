"""Scans taken in a simulated building outside any mission, and what they see of the unknown."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.sightings import BERTHS, BIN, BINS, berth_step, empty_counts
from vedette.kernels.lidar import cast_rays, count_sightings, integrate_scan
from vedette.kernels.tiles import TiledGrid, Tiling
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.maps.world import World
from vedette.missions.explore.evidence import CLAMP, GAIN_HIT, GAIN_MISS, NUDGE
from vedette.team import PlatformSpec

EVERY_BEAM = 1


@dataclass(frozen=True, eq=False)
class Scanned:
    """What a number of scans left."""

    log_odds: NDArray[np.int8]  # (R, C) [0.2 nat]
    counts: NDArray[np.int64]  # (ROWS, BINS) cells tried and seen, as ``count_sightings`` adds them up

    @property
    def classes(self) -> NDArray[np.uint8]:
        """(R, C) of UNKNOWN, FREE and OCCUPIED."""
        known = np.where(self.log_odds < 0, FREE, OCCUPIED).astype(np.uint8)
        known[self.log_odds == 0] = UNKNOWN
        return known


def scan(
    world: World,
    poses: NDArray[np.float64],
    spec: PlatformSpec,
    rng: np.random.Generator,
    *,
    forget: bool = False,
) -> Scanned:
    """Scan from each pose (n, 3) [m, m, rad] in turn, and fuse what is seen.

    Before a scan is fused, the unknown cells that it tries and sees are counted. With ``forget`` every scan
    begins with an unknown building; the log-odds are then the last scan's.
    """
    resolution = world.frame.resolution
    nudge = NUDGE * resolution
    tiling, counts = Tiling(*world.frame.shape), empty_counts()
    log_odds = TiledGrid(tiling, np.int8)
    half = np.radians(spec.view) / 2.0
    fan = np.linspace(-half, half, spec.beams, endpoint=spec.view < 360.0)
    for x, y, heading in (poses - (world.frame.origin_x, world.frame.origin_y, 0.0)).tolist():
        angles = heading + fan
        true = cast_rays(world.solid, resolution, x, y, angles, spec.range, np.empty((0, 3)))
        hits = np.isfinite(true)
        noise = spec.range_noise * rng.standard_normal(len(true))
        ranges = np.clip(np.where(hits, true + noise, spec.range), 0.0, spec.range)
        if forget:
            log_odds = TiledGrid(tiling, np.int8)
        bins = spec.range, BIN, BERTHS, berth_step(resolution)
        seen = count_sightings(log_odds, resolution, x, y, angles, ranges, hits, *bins, EVERY_BEAM, nudge)
        counts[:, : seen.shape[1]] += seen[:, :BINS]
        integrate_scan(log_odds, resolution, x, y, angles, ranges, hits, GAIN_HIT, GAIN_MISS, CLAMP, nudge)
    return Scanned(log_odds.window(), counts)


def spaced(poses: NDArray[np.float64], metres: float) -> NDArray[np.float64]:
    """Return those of a way's poses (n, 3) that are at least so far from the one returned before."""
    kept = [poses[0]]
    for pose in poses[1:]:
        if np.hypot(*(pose - kept[-1])[:2]) >= metres:
            kept.append(pose)
    return np.array(kept)
