"""What a contributor has signed of itself that cannot be: it stands within its own walls, or leaps.

docs/trust.md
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.link import Key
from vedette.fusion.particulars import ABOUT, Capabilities, Particulars, SignedPlace
from vedette.fusion.sealed import SealedSnapshot
from vedette.fusion.trust import FREE, OCCUPIED, WEAKLY_FREE
from vedette.kernels.tiles import Tiling

WITHIN = 0.3  # about its place there is no free ground, and half or more is wall [m]
PATIENCE = 24  # of its versions in a row say so

_IN_WALLS = "it signs to stand where its own map has walls all about"
_LEAPS = "it signs to have come farther than anybody drives"


@dataclass(eq=False)
class OwnWord:
    """Holds where contributors sign to be against what they have signed before, and beside it."""

    tiling: Tiling
    limits: Capabilities
    _walled: dict[Key, int] = field(default_factory=dict)  # versions in a row that are within walls
    _last: dict[Key, tuple[float, float, int]] = field(default_factory=dict)  # x, y [m], when [0.1 s]
    _false: dict[int, str] = field(default_factory=dict)  # what is wrong, by robot

    @property
    def complaints(self) -> dict[int, str]:
        """What is wrong with whom, by robot."""
        return dict(self._false)

    def take(self, key: Key, place: SignedPlace, told: Particulars, copy: SealedSnapshot) -> None:
        """Take in a version with the place, and the start, that are signed with it."""
        x, y, time = place.x / 100.0, place.y / 100.0, copy.seal.time
        from_x, from_y, since = self._last.get(key, (*self._start(told), told.began))
        self._last[key] = x, y, time
        driven = self.limits.speed * max(time - since, 0) / 10.0
        if math.dist((from_x, from_y), (x, y)) > ABOUT + driven:
            self._false[key[0]] = _LEAPS
        self._walled[key] = self._walled.get(key, 0) + 1 if self._is_within_walls(x, y, copy) else 0
        if self._walled[key] >= PATIENCE:
            self._false[key[0]] = _IN_WALLS

    def _start(self, told: Particulars) -> tuple[float, float]:
        (left, low), cell = self.limits.origin, self.limits.resolution
        return left + (told.col + 0.5) * cell, low + (told.row + 0.5) * cell

    def _is_within_walls(self, x: float, y: float, copy: SealedSnapshot) -> bool:
        codes = self._about(x, y, copy)
        free, walls = np.isin(codes, (FREE, WEAKLY_FREE)), np.count_nonzero(codes == OCCUPIED)
        return bool(len(codes) and not free.any() and 2 * walls >= len(codes))

    def _about(self, x: float, y: float, copy: SealedSnapshot) -> NDArray[np.uint8]:
        """Return what a contributor says of the cells about a place of its frame [m], as far as there are."""
        (left, low), cell = self.limits.origin, self.limits.resolution
        steps = np.arange(-math.ceil(WITHIN / cell), math.ceil(WITHIN / cell) + 1)
        rows = math.floor((y - low) / cell) + steps[:, None]
        cols = math.floor((x - left) / cell) + steps
        inside = (rows >= 0) & (rows < self.tiling.rows) & (cols >= 0) & (cols < self.tiling.cols)
        tiles, places = self.tiling.split((rows * self.tiling.cols + cols)[inside])
        held, which = np.unique(tiles, return_inverse=True)
        codes: NDArray[np.uint8] = copy.values.read(held)[which, places]
        return codes
