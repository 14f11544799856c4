"""Who moves before the lidar of a robot that makes its map itself, and whose scans are no evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from vedette.agent.events import Pose, Scan
from vedette.kernels.tiles import TiledGrid, Tiling
from vedette.maps.frame import GridFrame
from vedette.missions.explore.passers_by import Disc, PassersBy
from vedette.team import PlatformSpec


@dataclass(eq=False)
class SeenMoving:
    """Follows what stands free and may move, and leaves the robot's map alone."""

    frame: GridFrame
    spec: PlatformSpec
    _passers_by: PassersBy = field(init=False)
    _nothing: TiledGrid[np.int8] = field(init=False)  # is known: what was free ground has no say

    def __post_init__(self) -> None:
        self._passers_by = PassersBy(self.frame, self.spec.radius)
        self._nothing = TiledGrid(Tiling(*self.frame.shape), np.int8)

    def look(self, scan: Scan, pose: Pose, now: float) -> Sequence[Disc]:
        """Return what may move in a scan from a pose, as discs in the frame of the pose [m]."""
        says = ~np.isnan(scan.ranges)
        angles, told = scan.angles[says], scan.ranges[says]
        ranges, hits = np.minimum(told, self.spec.range), told < self.spec.range
        x = pose.x + scan.offset[0] - self.frame.origin_x
        y = pose.y + scan.offset[1] - self.frame.origin_y
        self._passers_by.sift(self._nothing, (x, y), angles, ranges, hits, 0.0, now)
        return self._passers_by.discs(now)
