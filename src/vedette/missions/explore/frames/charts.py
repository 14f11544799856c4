"""Contributors' maps made ready to be laid on each other, each version once in this process."""

from __future__ import annotations

import math
from collections import OrderedDict
from hashlib import blake2b
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from vedette.align import Charted, FramePose, charted
from vedette.align.agreement import MapAgreement, agreement, middles
from vedette.align.candidates import ROUGHLY
from vedette.align.fitted import pulled
from vedette.fusion.framed import FramedMap
from vedette.fusion.link import Key
from vedette.fusion.tiles import CLASSES
from vedette.kernels.tiles import SIDE, TiledGrid, Tiling
from vedette.maps import GridFrame
from vedette.maps.transform import Transform

MOST = 64  # charts that are kept


class Charts:
    """The charts of everybody's evidence, as one robot holds it."""

    _kept: ClassVar[OrderedDict[tuple[bytes, GridFrame], Charted | None]] = OrderedDict()  # by content

    def __init__(self, evidence: FramedMap[Any], frame: GridFrame) -> None:
        self._evidence, self._frame = evidence, frame

    def size(self, key: Key) -> int:
        """Return how much a contributor has seen [tiles]."""
        copy = self._evidence.copies.get(key)
        return 0 if copy is None else len(copy.known_tiles)

    def versions(self, *keys: Key) -> int:
        """Return how often contributors have told something new."""
        return sum(self._evidence.copies[key].version for key in keys)

    def of(self, key: Key) -> Charted | None:
        """Return a contributor's chart in its own frame; None: it has no wall beside free ground."""
        copy = self._evidence.copies.get(key)
        if copy is None or not len(copy.known_tiles):
            return None
        tiles = copy.known_tiles
        codes = copy.values.read(tiles)
        name = blake2b(tiles.tobytes() + codes.tobytes(), digest_size=16).digest(), self._frame
        if name not in self._kept:
            self._kept[name] = self._made(tiles, CLASSES[codes])
            if len(self._kept) > MOST:
                self._kept.popitem(last=False)
        self._kept.move_to_end(name)
        return self._kept[name]

    def agreement(self, a: Key, b: Key, there: Transform) -> MapAgreement | None:
        """Return how far two contributors agree where b lies in a's frame so; None: one has no chart."""
        on, of = self.of(a), self.of(b)
        if on is None or of is None:
            return None
        return agreement(on, of, middles(on, of, pose_of(there)))

    def pulled(self, a: Key, b: Key, there: Transform) -> tuple[float, float]:
        """Return how far walls pull b from where it is taken to lie [m], [rad]; infinite without charts."""
        on, of = self.of(a), self.of(b)
        if on is None or of is None:
            return math.inf, math.inf
        return pulled(on, of, middles(on, of, pose_of(there)), ROUGHLY)

    def _made(self, tiles: NDArray[np.int64], classes: NDArray[np.uint8]) -> Charted | None:
        tiling = Tiling(*self._frame.shape)
        grid: TiledGrid[np.uint8] = TiledGrid(tiling, np.uint8)
        grid.write(tiles, classes)
        top, left = tiling.corners(tiles)
        rows = slice(int(top.min()), min(int(top.max()) + SIDE, tiling.rows))
        cols = slice(int(left.min()), min(int(left.max()) + SIDE, tiling.cols))
        return charted(self._frame.window(rows, cols), grid.window(rows, cols))


def pose_of(there: Transform) -> FramePose:
    """Return an integer transform as a motion in metres and radians."""
    return FramePose(there.x / 1000.0, there.y / 1000.0, there.radians)
