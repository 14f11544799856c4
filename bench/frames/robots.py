"""What a robot would have mapped, in a frame of its own that lies anywhere: scans laid into a grid."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.align.pose import FramePose
from vedette.kernels import lidar
from vedette.kernels.distance import distance_field
from vedette.kernels.tiles import TiledGrid, Tiling
from vedette.logs import RecordedScan
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.world import World, standable
from vedette.missions.explore.evidence import CLAMP, GAIN_HIT, GAIN_MISS, NUDGE
from vedette.sim.worlds.logged import beams

RESOLUTION = 0.1  # of the maps [m]
REACH = 10.0  # of the simulated lidars [m]
BEAMS = 720
NOISE = 0.02  # of a range [m]
PLACE_NOISE, TURN_NOISE = 0.03, math.radians(0.3)  # of a scan's pose in a map, as SLAM leaves it [m], [rad]
BETWEEN_VIEWS = 1.5  # places from which a robot has looked, at least [m]
RADIUS = 0.2  # of a robot [m]


@dataclass(frozen=True, eq=False)
class Mapped:
    """A robot's map, and where its frame truly lies."""

    frame: GridFrame
    classes: NDArray[np.uint8]  # (R, C)
    pose: FramePose  # of its frame in the place's own


def anywhere(rng: np.random.Generator) -> FramePose:
    """Return a frame that lies anywhere, turned by any angle."""
    x, y = rng.uniform(-30.0, 30.0, 2).tolist()
    return FramePose.of(x, y, rng.uniform(-math.pi, math.pi))


def mapped(scans: Sequence[RecordedScan], reach: float, pose: FramePose) -> Mapped:
    """Return the map of some scans, whose poses are in the place's frame, in the frame of a robot."""
    to_own = pose.inverse()
    own = to_own.places(np.array([[scan.x, scan.y] for scan in scans]))
    low, high = own.min(axis=0) - reach - 1.0, own.max(axis=0) + reach + 1.0
    cols, rows = np.ceil((high - low) / RESOLUTION).astype(int).tolist()
    evidence = TiledGrid(Tiling(rows, cols), np.int8)
    for scan, (x, y) in zip(scans, (own - low).tolist(), strict=True):
        ranges, hits = beams(scan, reach, "ignore")
        gains = GAIN_HIT, GAIN_MISS, CLAMP, NUDGE * RESOLUTION
        lidar.integrate_scan(evidence, RESOLUTION, x, y, scan.angles + to_own.angle, ranges, hits, *gains)
    odds = evidence.window()
    classes = np.select([odds > 0, odds < 0], [OCCUPIED, FREE], UNKNOWN).astype(np.uint8)
    return Mapped(GridFrame(RESOLUTION, rows, cols, *low.tolist()), classes, pose)


def looked(world: World, start: int, way: float, rng: np.random.Generator) -> list[RecordedScan]:
    """Return scans from places up to so far by way from a cell [m], with the errors of SLAM and lidar."""
    field = distance_field(standable(world, RADIUS), start, world.frame.resolution)
    reached = np.flatnonzero(field.ravel() <= way)
    x_min, _, y_min, _ = world.frame.extent
    scans: list[RecordedScan] = []
    seen = np.empty((0, 2))
    for place in world.frame.centres(rng.permutation(reached)[:4000]):
        if len(seen) and np.hypot(*(seen - place).T).min() < BETWEEN_VIEWS:
            continue
        seen = np.vstack([seen, place])
        angles = np.linspace(0.0, 2.0 * math.pi, BEAMS, endpoint=False) + rng.uniform(0.0, math.pi)
        x, y = (place - (x_min, y_min)).tolist()
        ranges = lidar.cast_rays(world.solid, world.frame.resolution, x, y, angles, REACH, np.empty((0, 3)))
        ranges = ranges + rng.normal(0.0, NOISE, BEAMS)
        told_x, told_y = (place + rng.normal(0.0, PLACE_NOISE, 2)).tolist()
        turn = rng.normal(0.0, TURN_NOISE)
        scans.append(RecordedScan(0.0, told_x, told_y, 0.0, angles + turn, np.maximum(ranges, 0.05)))
    return scans
