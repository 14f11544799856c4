"""What the replay of logs has given, as figures and as a file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.sightings import BIN
from vedette.maps import FREE, UNKNOWN, GridFrame
from vedette.record.explore.frames import FramesFound
from vedette.record.summary import Figures


@dataclass(frozen=True, eq=False)
class Replayed:
    """What a team knows that a log has gone through."""

    name: str  # of the log
    frame: GridFrame
    classes: NDArray[np.uint8]  # (R, C) map of who knows most, frame of the log
    counts: NDArray[np.int64]  # (ROWS, BINS) unknown cells tried and seen, as `count_sightings` counts them
    times: tuple[float, ...]  # [s]
    known_m2: tuple[float, ...]  # area that the robot knew then that knew most
    sights: int  # scans, or maps, that were told
    of_sights: int
    maps: bool  # they were maps
    way_m: float
    reach_m: float
    agreed: bool  # all robots hold one map
    names: tuple[str, ...]  # of the robots
    whose: str  # robot it is that knows most
    ways: tuple[NDArray[np.float64], ...]  # (L, 2) of each robot [m]
    frames: FramesFound | None = None  # how the robots found each other's; None: all are the log's

    @property
    def unjoined(self) -> frozenset[str]:
        """Names of robots whose evidence is not in the map, because nobody knows where it lies."""
        if self.frames is None:
            return frozenset()
        joined = next(each for each in self.frames.components if self.whose in each)
        return frozenset(self.names) - frozenset(joined)

    @property
    def complete(self) -> bool:
        """Whether the log has gone through whole."""
        return self.sights == self.of_sights


@dataclass(frozen=True)
class Sighting:
    """How many unknown cells at a distance scans could have seen, and how many they saw: Fig. 3."""

    distance_m: float  # middle of the bin
    tried: int
    seen: int


@dataclass(frozen=True)
class ReplayedBuilding:
    """The figures of one log."""

    log: str
    robots: tuple[str, ...]
    scans: int
    maps: int
    complete: bool
    way_m: float
    time_s: float
    resolution_m: float
    reach_m: float
    free_m2: float
    known_m2: float
    agreed: bool
    observation: tuple[Sighting, ...]  # as far as anything was tried
    frames: FramesFound | None  # None: all robots' frames are the log's

    @classmethod
    def of(cls, replayed: Replayed) -> ReplayedBuilding:
        """Return the figures of a replay."""
        cell = replayed.frame.resolution**2
        return cls(
            replayed.name,
            replayed.names,
            0 if replayed.maps else replayed.sights,
            replayed.sights if replayed.maps else 0,
            replayed.complete,
            replayed.way_m,
            replayed.times[-1],
            replayed.frame.resolution,
            replayed.reach_m,
            float(np.count_nonzero(replayed.classes == FREE)) * cell,
            float(np.count_nonzero(replayed.classes != UNKNOWN)) * cell,
            replayed.agreed,
            tuple(
                Sighting((k + 0.5) * BIN, int(tried), int(seen))
                for k, (tried, seen) in enumerate(replayed.counts[:2].T.tolist())
                if tried
            ),
            replayed.frames,
        )


@dataclass(frozen=True, kw_only=True)
class ReplaySummary(Figures):
    """``summary.json`` of ``vedette replay``."""

    buildings: tuple[ReplayedBuilding, ...]
