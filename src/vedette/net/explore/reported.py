"""What a team's robots report of the ground, laid together no more often than their maps are worth."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import planning_factor
from vedette.domains.mapping.impact import MapImpactCodec, cells_missed, moved
from vedette.maps import UNKNOWN, GridFrame
from vedette.maps.laid import around, part_laid
from vedette.net.explore.content import MOST_CELLS, MapContent, classes_of, frame_of

NOWHERE = GridFrame(1.0, 1, 1)
SHARE = 0.05  # of a core, at most, goes into laying maps together


@dataclass(frozen=True, eq=False)
class ReportedMap:
    """What robots know together, and mean to see."""

    frame: GridFrame  # the least that holds all their maps
    planning: GridFrame  # of the planning cells over it
    classes: NDArray[np.uint8]  # (R, C)
    impact: NDArray[np.float32]  # (r, c) how likely their strategies show each planning cell

    @classmethod
    def of(cls, maps: Sequence[MapContent]) -> ReportedMap:
        """Lay robots' maps on each other; ValueError: one is malformed."""
        frame, classes = _together(maps)
        planning = frame.coarse(planning_factor(frame.resolution))
        return cls(frame, planning, classes, _impact(maps, planning))

    @property
    def known_m2(self) -> float:
        """How much is known [m^2]."""
        return float(np.count_nonzero(self.classes != UNKNOWN)) * self.frame.resolution**2


@dataclass
class ReportedMaps:
    """Lays together what is new; where that takes long, what it laid before has to do for a while."""

    clock: Callable[[], float] = time.monotonic  # [s]
    spent: Callable[[], float] = time.thread_time  # CPU time of this thread [s]
    _latest: ReportedMap | None = None
    _of: tuple[tuple[bytes, bytes | None], ...] = ()  # the maps and impacts that it is of
    _due: float = -1e9  # when it may be laid anew [s]

    def of(self, maps: Sequence[MapContent]) -> ReportedMap:
        """Return what robots' maps are together; ValueError: one is malformed."""
        told = tuple((each.classes, each.impact) for each in maps)
        now = self.clock()
        if self._latest is None or (told != self._of and now >= self._due):
            began = self.spent()
            self._latest, self._of = ReportedMap.of(maps), told
            self._due = now + (self.spent() - began) / SHARE
        return self._latest


def _together(maps: Sequence[MapContent]) -> tuple[GridFrame, NDArray[np.uint8]]:
    """Return the least grid that holds all maps, and what they know together; occupied wins over free."""
    parts = [(frame_of(each), classes_of(each)) for each in maps if each.rows and each.cols]
    if not parts:
        return NOWHERE, np.zeros(NOWHERE.shape, np.uint8)
    frame = around([part for part, _ in parts])
    if frame.size > MOST_CELLS:
        raise ValueError(f"reports of maps that lie {max(frame.shape) * frame.resolution:.0f} m apart")
    whole = np.zeros(frame.shape, np.uint8)
    for part, classes in parts:
        there, under = part_laid(classes, part, frame)
        whole[there] = np.maximum(whole[there], under)  # UNKNOWN < FREE < OCCUPIED
    return frame, whole


def _impact(maps: Sequence[MapContent], planning: GridFrame) -> NDArray[np.float32]:
    """Return ``(r, c)`` how likely the robots' strategies show each planning cell, together.

    Raises:
        ValueError: an impact is malformed.
    """
    miss = np.ones(planning.size, np.float32)
    for each in maps:
        if each.impact is None or not each.rows or not each.cols:
            continue
        side = each.resolution
        corner = each.x - each.col * side, each.y - each.row * side
        own = GridFrame(side, *each.lattice, *corner).coarse(planning_factor(side))
        cells, missed = cells_missed(moved(MapImpactCodec(own.size).decode(each.impact), own, planning))
        miss[cells] *= missed
    return (1.0 - miss).reshape(planning.shape)
