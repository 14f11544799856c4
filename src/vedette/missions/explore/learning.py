"""What one robot learns of how likely it is to see what it plans to see."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.sightings import BERTHS, BIN, BINS, berth_step, empty_counts
from vedette.kernels import lidar
from vedette.kernels.tiles import TiledGrid, Tiling

SIGHTING_STRIDE = 4  # one beam in so many teaches the sighting model
LEARNING_STEP = 2.0  # a robot learns from one scan in so many metres of its way [m]
MOST_CHANGES = 256  # scans whose changes are kept apart


@dataclass(eq=False)
class Learning:
    """Counts what scans reveal of what was unknown when the robot last was a way from where it is.

    That is what the planner asks of a stop. Counting every scan would teach it that unknown cells are never
    seen, the more so the longer a robot stands.
    """

    tiling: Tiling
    resolution: float  # [m]
    range: float  # of the lidar [m]
    nudge: float  # so much farther a return counts [m]
    counts: NDArray[np.int64] = field(default_factory=empty_counts)  # (ROWS, BINS) own sightings
    _at: tuple[float, float] | None = None  # where it last learned
    _then: TiledGrid[np.int8] = field(init=False)  # its evidence then, to the class
    _since: list[NDArray[np.int64]] = field(default_factory=list)  # cells whose own class changed since

    def __post_init__(self) -> None:
        self._then = TiledGrid(self.tiling, np.int8)

    def scan(
        self,
        log_odds: TiledGrid[np.int8],
        angles: NDArray[np.float64],
        ranges: NDArray[np.float64],
        hits: NDArray[np.bool_],
        x: float,
        y: float,
    ) -> None:
        """Learn from a scan that is not yet in the evidence, if the robot has moved on since it last did.

        Args:
            log_odds: the evidence.
            angles, ranges, hits: ``(B,)`` of the beams.
            x, y: of the lidar [m], from the corner of the grid.
        """
        if self._at is not None and np.hypot(x - self._at[0], y - self._at[1]) < LEARNING_STEP:
            return
        beams = self._then, self.resolution, x, y, angles, ranges, hits
        bins = self.range, BIN, BERTHS, berth_step(self.resolution)
        seen = lidar.count_sightings(*beams, *bins, SIGHTING_STRIDE, self.nudge)
        self.counts[:, : seen.shape[1]] += seen[:, :BINS]
        self._at = x, y
        for cells in self._since:
            self._then.put(cells, log_odds.take(cells))
        self._since.clear()

    def note(self, changed: NDArray[np.int64]) -> None:
        """Remember cells whose own class has changed."""
        if len(changed):
            self._since.append(changed)
        if len(self._since) > MOST_CHANGES:
            self._since = [np.unique(np.concatenate(self._since))]
