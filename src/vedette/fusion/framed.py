"""Replicated evidence of robots that share no frame: each maker's own, drawn where it is taken to lie."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.digest import fingerprint
from vedette.fusion.frame_edges import FrameEdge, room_for, unpacked
from vedette.fusion.link import Key
from vedette.fusion.rendering import Frames, Rendering
from vedette.fusion.replicated import ReplicatedEvidence
from vedette.fusion.replicated_map import ReplicatedMap, SnapshotT
from vedette.fusion.shared import SharedTiles
from vedette.fusion.snapshots import NONE, Change, Snapshot
from vedette.fusion.tiles import TeamMap, classes_of
from vedette.kernels.tiles import Tiling
from vedette.maps import GridFrame
from vedette.maps.transform import IDENTITY, Transform


class Maker(NamedTuple):
    """One of those of whose evidence a map is made."""

    there: Transform  # where its frame lies in the map's
    codes: SharedTiles[np.uint8]  # of its cells, in its own frame


class DrawnMap(TeamMap):
    """A map of everybody's evidence in one frame."""

    def __init__(self, frame: GridFrame, mark: int) -> None:
        super().__init__(Tiling(*frame.shape), 0, mark)
        self.rendering = Rendering(frame)
        self.out = frozenset[int]()  # robots that are drawn, and not shown

    @property
    def digest(self) -> int:
        """64 bits, equal (up to 2^-64) iff classes, counts, marks and frames are."""
        told = repr(sorted((key, tuple(there)) for key, there in self.rendering.frames.items())).encode()
        return super().digest ^ fingerprint(told, self._tiling.count + 2)

    def place(self, frames: Frames, copies: Mapping[Key, Snapshot[np.uint8]]) -> None:
        """Let contributors lie as these frames say from now on."""
        self.add_up(self.rendering.move(frames, copies))

    def add_up(self, tiles: NDArray[np.int64]) -> NDArray[np.int64]:
        """Add up what all who lie in the frame say of tiles; return the tiles that changed."""
        return self.show(tiles, classes_of(self.rendering.summed(tiles, self.out)))


class FramedMap(ReplicatedMap[SnapshotT]):
    """Team evidence of robots that do not share a frame: ``classes`` is the map in this robot's own.

    Beside it there is the map of the latest round's ``plane``, of which ``digest`` is. Where frames lie is
    told to ``place_own`` and ``place_plane``; who is placed nowhere is held and passed on, and not shown. So
    a join is undone by placing anew, and nothing is lost.
    """

    edges_from: int  # numbers that are counts; behind them come a contributor's edges
    plane: DrawnMap
    misleading: frozenset[int] = frozenset()  # robots that go on telling of edges that evidence refutes
    out: frozenset[int]  # robots whose maps are not believed: held, drawn, and not shown
    _own: Rendering

    def _begin(self, frame: GridFrame, edges_from: int, mark: int) -> None:
        """Start with nothing but this robot's own map."""
        self.edges_from = edges_from
        self.plane = DrawnMap(frame, mark)
        self.plane.counts = self.counts  # the very same
        self._own = Rendering(frame)
        self._own.move({self.key: IDENTITY}, self.copies)

    @property
    def key(self) -> Key:
        """This robot as a contributor."""
        return self._contributors.key

    @property
    def copies(self) -> Mapping[Key, SnapshotT]:
        """Everybody's evidence, each in its maker's frame."""
        return self._contributors.copies

    @property
    def gone(self) -> Collection[int]:
        """Robots of whom nothing counts any more."""
        return ()

    @property
    def digest(self) -> int:
        """Equal for two robots iff the planes of their latest rounds are."""
        return self.plane.digest

    @property
    def told(self) -> dict[Key, list[FrameEdge]]:
        """What each contributor has told of how frames lie, of whom anything counts."""
        return {
            key: unpacked(copy.counts[self.edges_from :])
            for key, copy in self.copies.items()
            if key[0] not in self.gone
        }

    @property
    def edges(self) -> list[FrameEdge]:
        """What anybody has told of how frames lie, in an order that is the same for all."""
        return sorted({edge for told in self.told.values() for edge in told})

    @property
    def frames(self) -> Frames:
        """Where contributors lie in this robot's own frame."""
        return self._own.frames

    def makers(self, frames: Frames) -> list[Maker]:
        """Return of whose evidence a map is made in which contributors lie as these frames say."""
        return [
            Maker(there, self.copies[key].values)
            for key, there in frames.items()
            if key in self.copies and key[0] not in self.out
        ]

    def place_own(self, frames: Frames) -> None:
        """Let contributors lie in this robot's own frame as these say; others are not in its map."""
        self._show(self._own.move({**frames, self.key: IDENTITY}, self.copies))

    def place_plane(self, frames: Frames) -> None:
        """Let contributors lie on the plane as these say; others are not on it."""
        self.plane.place(frames, self.copies)

    def _draw(self, changes: Mapping[Key, Change | None]) -> NDArray[np.int64]:
        """Draw what has changed in both maps; return the tiles that changed in the own one."""
        own, plane = [NONE], [NONE]
        for key, change in changes.items():
            if change is not None:
                own.append(self._own.draw(key, self.copies[key], change.tiles))
                plane.append(self.plane.rendering.draw(key, self.copies[key], change.tiles))
                self._drew(key, plane[-1])
        self.plane.add_up(np.unique(np.concatenate(plane)))
        return self._show(np.unique(np.concatenate(own)))

    def _show(self, tiles: NDArray[np.int64]) -> NDArray[np.int64]:
        """Add up what all who lie in this robot's own frame say of tiles; return the tiles that changed."""
        return self.show(tiles, classes_of(self._own.summed(tiles, self.out)))

    def _drew(self, key: Key, tiles: NDArray[np.int64]) -> None:
        """Note that a contributor's tiles have been drawn on the plane."""


class FramedEvidence(FramedMap[Snapshot[np.uint8]], ReplicatedEvidence):
    """Evidence that nobody signs, of robots that do not share a frame."""

    out = frozenset()

    def __init__(
        self, robot: int, boot: int, frame: GridFrame, counts_size: int, robots: int, *, mark: int = 0
    ) -> None:
        """Start with nothing known; as `ReplicatedEvidence`.

        ``frame``: of everybody's cells, each about the origin of its own frame. ``counts_size``: numbers that
        are counts; behind them come each contributor's edges, of which there is room for some a robot.
        """
        super().__init__(robot, boot, frame.shape, counts_size + room_for(robots), mark=mark)
        self._begin(frame, counts_size, mark)

    def _merge(self, changes: Mapping[Key, Change | None]) -> NDArray[np.int64]:
        """Draw what has changed in both maps."""
        for change in changes.values():
            if change is not None:
                self.counts += change.more_counts
        return self._draw(changes)
