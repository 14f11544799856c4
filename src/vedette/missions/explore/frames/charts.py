"""Contributors' maps made ready to be laid on each other, each version once in this process."""

from __future__ import annotations

import math
from collections import OrderedDict
from hashlib import blake2b
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.align import Charted, FramePose, charted
from vedette.align.agreement import MapAgreement, agreement, middles, own_frames
from vedette.align.candidates import ROUGHLY
from vedette.align.fitted import fitted
from vedette.fusion.framed import FramedMap
from vedette.fusion.link import Key
from vedette.fusion.tiles import CLASSES
from vedette.kernels.tiles import SIDE, TiledGrid, Tiling
from vedette.maps import FREE, GridFrame
from vedette.maps.bounds import Extent
from vedette.maps.transform import Transform

MOST = 64, 1 << 25  # charts that are kept, and their cells ...
FEW = 4  # ... but so many, however large
LARGEST = 1 << 24  # that a chart is made of: 410 m square at 0.1 m [cells]


class _Told(NamedTuple):
    """A version of a map, by its content."""

    version: int
    name: bytes
    free: int  # cells
    cells: int  # of what holds it all


_NOTHING = _Told(0, b"", 0, 0)


class Charts:
    """The charts of everybody's evidence, as one robot holds it."""

    _kept: ClassVar[OrderedDict[tuple[bytes, GridFrame], Charted | None]] = OrderedDict()  # by content

    def __init__(self, evidence: FramedMap[Any], frame: GridFrame) -> None:
        self._evidence, self._frame = evidence, frame
        self._told: dict[Key, _Told] = {}  # the latest that has been looked at

    def versions(self, *keys: Key) -> int:
        """Return how often contributors have told something new."""
        return sum(self._evidence.copies[key].version for key in keys)

    def ground(self, key: Key) -> float:
        """Return how much free ground a contributor's map has [m^2]."""
        return self._latest(key).free * self._frame.resolution**2

    def size(self, key: Key) -> int:
        """Return how many millions of cells a contributor's chart has, at least 1."""
        return max(1, self._latest(key).cells >> 20)

    def name(self, key: Key) -> bytes:
        """Return what is the same for two maps iff they are."""
        return self._latest(key).name

    def of(self, key: Key) -> Charted | None:
        """Return a contributor's chart in its own frame.

        None: it has no wall beside free ground, or says to reach so far that nobody would draw it up.
        """
        copy = self._evidence.copies.get(key)
        if copy is None or not len(copy.known_tiles) or self._latest(key).cells > LARGEST:
            return None
        name = self.name(key), self._frame
        if name not in self._kept:
            tiles = copy.known_tiles
            self._kept[name] = self._made(tiles, CLASSES[copy.values.read(tiles)])
            while len(self._kept) > FEW and (len(self._kept) > MOST[0] or self._cells > MOST[1]):
                self._kept.popitem(last=False)
        self._kept.move_to_end(name)
        return self._kept[name]

    @property
    def _cells(self) -> int:
        """How many cells the charts have that are kept."""
        return sum(chart.classes.size for chart in self._kept.values() if chart is not None)

    def _latest(self, key: Key) -> _Told:
        """Return what a contributor's latest version is, without drawing it up."""
        copy, known = self._evidence.copies.get(key), self._told.get(key, _NOTHING)
        if copy is not None and known.version != copy.version:
            tiles = copy.known_tiles
            codes = copy.values.read(tiles)
            name = blake2b(tiles.tobytes() + codes.tobytes(), digest_size=16).digest()
            free = int(np.count_nonzero(CLASSES[codes] == FREE))
            rows, cols = self._extent(tiles)
            cells = (rows.stop - rows.start) * (cols.stop - cols.start)
            known = self._told[key] = _Told(copy.version, name, free, cells)
        return known

    def agreement(self, a: Key, b: Key, there: Transform) -> MapAgreement | None:
        """Return how far two contributors agree where b lies in a's frame so; None: one has no chart."""
        on, of = self.of(a), self.of(b)
        if on is None or of is None:
            return None
        return agreement(on, of, middles(on, of, pose_of(there)))

    def pulled(self, a: Key, b: Key, there: Transform) -> tuple[Transform, float, float]:
        """Return where walls have b lie that is taken to lie there, and how far that is [m], [rad].

        Without charts it is infinitely far.
        """
        on, of = self.of(a), self.of(b)
        if on is None or of is None:
            return there, math.inf, math.inf
        taken = middles(on, of, pose_of(there))
        pose = fitted(on, of, taken, ROUGHLY).pose
        to = own_frames(on, of, pose)
        return Transform.of(to.x, to.y, to.angle), *pose.apart(taken, np.zeros(2))

    def _made(self, tiles: NDArray[np.int64], classes: NDArray[np.uint8]) -> Charted | None:
        tiling = Tiling(*self._frame.shape)
        grid: TiledGrid[np.uint8] = TiledGrid(tiling, np.uint8)
        grid.write(tiles, classes)
        rows, cols = self._extent(tiles)
        return charted(self._frame.window(rows, cols), grid.window(rows, cols))

    def _extent(self, tiles: NDArray[np.int64]) -> Extent:
        """Return the rows and columns that hold some tiles."""
        if not len(tiles):
            return slice(0, 0), slice(0, 0)
        tiling = Tiling(*self._frame.shape)
        top, left = tiling.corners(tiles)
        rows = slice(int(top.min()), min(int(top.max()) + SIDE, tiling.rows))
        return rows, slice(int(left.min()), min(int(left.max()) + SIDE, tiling.cols))


def pose_of(there: Transform) -> FramePose:
    """Return an integer transform as a motion in metres and radians."""
    return FramePose(there.x / 1000.0, there.y / 1000.0, there.radians)
