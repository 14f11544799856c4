"""Everybody's evidence, each in its maker's frame, drawn together in one frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.link import Key
from vedette.fusion.shared import SharedTiles
from vedette.fusion.snapshots import NONE
from vedette.fusion.tiles import WORDS
from vedette.kernels.render import TileGround, TileMotion, render_tiles
from vedette.kernels.tiles import CELLS, SIDE, Tiling
from vedette.maps import GridFrame
from vedette.maps.transform import IDENTITY, MILLIMETRE, Transform

Frames = Mapping[Key, Transform]  # where contributors' frames lie in one frame; who is not in it is not drawn
MICROMETRES = 1_000_000
_REACH = SIDE / 2 * 2**0.5 + 1.0  # from a tile's middle to what it touches, turned and rounded [cells]


class FramedCopy(Protocol):
    """A contributor's evidence."""

    @property
    def values(self) -> SharedTiles[np.uint8]:
        """Codes of its cells, in its own frame."""


class Rendering:
    """Each contributor's tiles as they lie in one frame, kept while its version and its transform stand.

    All frames have cells of one size at the same places about their origins.
    """

    def __init__(self, frame: GridFrame) -> None:
        self.tiling = Tiling(*frame.shape)
        cell = round(MICROMETRES * frame.resolution)
        left, low = round(MICROMETRES * frame.origin_x), round(MICROMETRES * frame.origin_y)
        self._ground = TileGround(frame.rows, frame.cols, left, low, cell)
        self.frames: dict[Key, Transform] = {}
        self._drawn: dict[Key, SharedTiles[np.uint8]] = {}

    def move(self, frames: Frames, copies: Mapping[Key, FramedCopy]) -> NDArray[np.int64]:
        """Let contributors lie as these frames say from now on; return the tiles to add up anew."""
        anew = [NONE]
        for key in self.frames.keys() | frames.keys():
            if frames.get(key) == self.frames.get(key):
                continue
            if (before := self._drawn.pop(key, None)) is not None:
                anew.append(before.held)
            self.frames.pop(key, None)
            if key in frames:
                self.frames[key] = frames[key]
                if key in copies:
                    anew.append(self.draw(key, copies[key], copies[key].values.held))
        return np.unique(np.concatenate(anew))

    def draw(self, key: Key, copy: FramedCopy, changed: NDArray[np.int64]) -> NDArray[np.int64]:
        """Draw the tiles that a contributor has changed, if it lies in the frame; return those to add up."""
        there = self.frames.get(key)
        if there is None:
            return NONE
        if there == IDENTITY:
            self._drawn[key] = copy.values
            return changed
        touched = self._touched(changed, there)
        under = self._touched(touched, there.inverse())
        under = under[copy.values.holds(under)]
        motion = TileMotion(MILLIMETRE * there.x, MILLIMETRE * there.y, *there.cosine)
        blocks = render_tiles(under, copy.values.read(under), touched, self._ground, motion)
        self._drawn.setdefault(key, SharedTiles(np.uint8)).write(touched, blocks)
        return touched

    def held(self, key: Key) -> NDArray[np.int64]:
        """Return the tiles of the frame that a contributor says something of, increasing."""
        return self._drawn[key].held if key in self._drawn else NONE

    def under(self, key: Key, tile: int, copy: FramedCopy) -> NDArray[np.int64]:
        """Return the tiles of a contributor's own frame that may be drawn on one of this frame."""
        there, tiles = self.frames[key], np.array([tile])
        under = tiles if there == IDENTITY else self._touched(tiles, there.inverse())
        return under[copy.values.holds(under)]

    def read(self, key: Key, tiles: NDArray[np.int64]) -> NDArray[np.uint8]:
        """Return ``(T, 1024)`` what a contributor says of tiles of the frame."""
        drawn = self._drawn.get(key)
        return np.zeros((len(tiles), CELLS), np.uint8) if drawn is None else drawn.read(tiles)

    def summed(self, tiles: NDArray[np.int64], out: frozenset[int] = frozenset()) -> NDArray[np.int32]:
        """Return ``(T, 1024)`` packed sums of what all in the frame, but for some robots, say of tiles."""
        words = np.zeros((len(tiles), CELLS), np.int32)
        for drawn in (drawn for (robot, _), drawn in self._drawn.items() if robot not in out):
            held = np.flatnonzero(drawn.holds(tiles))
            if len(held):
                words[held] += WORDS.take(drawn.read(tiles[held]))
        return words

    def _touched(self, tiles: NDArray[np.int64], there: Transform) -> NDArray[np.int64]:
        """Return the tiles, increasing, that some tiles may touch when they are moved."""
        ground, tiling = self._ground, self.tiling
        corner = np.array((ground.left, ground.low)) / MICROMETRES
        cell = ground.cell / MICROMETRES
        top, left = tiling.corners(tiles)
        middles = corner + (np.column_stack((left, top)) + SIDE / 2) * cell
        x, y = ((there.places(middles) - corner) / cell).T
        steps = np.arange(3)
        first_row, last_row = np.floor((y - _REACH) / SIDE), np.floor((y + _REACH) / SIDE)
        first_col, last_col = np.floor((x - _REACH) / SIDE), np.floor((x + _REACH) / SIDE)
        rows, cols = first_row[:, None] + steps, first_col[:, None] + steps
        down = tiling.count // tiling.across
        in_rows = (rows <= last_row[:, None]) & (rows >= 0) & (rows < down)
        in_cols = (cols <= last_col[:, None]) & (cols >= 0) & (cols < tiling.across)
        ids = rows[:, :, None] * tiling.across + cols[:, None, :]
        return np.unique(ids[in_rows[:, :, None] & in_cols[:, None, :]].astype(np.int64))
