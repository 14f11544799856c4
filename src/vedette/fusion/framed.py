"""Replicated evidence of robots that share no frame: each maker's own, drawn where it is taken to lie."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.digest import fingerprint
from vedette.fusion.frame_edges import FrameEdge, room_for, unpacked
from vedette.fusion.link import RESEND_AFTER, Key
from vedette.fusion.rendering import Frames, Rendering
from vedette.fusion.replicated import ReplicatedEvidence
from vedette.fusion.snapshots import Change, Snapshot
from vedette.fusion.tiles import TeamMap, classes_of
from vedette.kernels.tiles import Tiling
from vedette.maps import GridFrame
from vedette.maps.transform import IDENTITY


class DrawnMap(TeamMap):
    """A map of everybody's evidence in one frame."""

    def __init__(self, frame: GridFrame, mark: int) -> None:
        super().__init__(Tiling(*frame.shape), 0, mark)
        self.rendering = Rendering(frame)

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
        return self.show(tiles, classes_of(self.rendering.summed(tiles)))

    def take(
        self, changes: Mapping[Key, Change | None], copies: Mapping[Key, Snapshot[np.uint8]]
    ) -> NDArray[np.int64]:
        """Draw what has changed of whose copy; return the tiles that changed."""
        drawn = [
            self.rendering.draw(key, copies[key], change.tiles)
            for key, change in changes.items()
            if change is not None
        ]
        return self.add_up(np.unique(np.concatenate([np.empty(0, np.int64), *drawn])))


class FramedEvidence(ReplicatedEvidence):
    """Team evidence of robots that do not share a frame: ``classes`` is the map in this robot's own.

    Beside it there is the map of the latest round's ``plane``, of which ``digest`` is. Where frames lie is
    told to ``place_own`` and ``place_plane``; who is placed nowhere is held and passed on, and not shown. So
    a join is undone by placing anew, and nothing is lost.
    """

    def __init__(
        self,
        robot: int,
        boot: int,
        frame: GridFrame,
        counts_size: int,
        robots: int,
        *,
        mark: int = 0,
        resend_after: float = RESEND_AFTER,
    ) -> None:
        """Start with nothing known; as `ReplicatedEvidence`.

        ``frame``: of everybody's cells, each about the origin of its own frame. ``counts_size``: numbers that
        are counts; behind them come each contributor's edges, of which there is room for some a robot.
        """
        size = counts_size + room_for(robots)
        super().__init__(robot, boot, frame.shape, size, mark=mark, resend_after=resend_after)
        self.edges_from = counts_size
        self.plane = DrawnMap(frame, mark)
        self.plane.counts = self.counts  # the very same
        self._own = Rendering(frame)
        self._own.move({self.key: IDENTITY}, self.copies)

    @property
    def key(self) -> Key:
        """This robot as a contributor."""
        return self._contributors.key

    @property
    def copies(self) -> Mapping[Key, Snapshot[np.uint8]]:
        """Everybody's evidence, each in its maker's frame."""
        return self._contributors.copies

    @property
    def digest(self) -> int:
        """Equal for two robots iff the planes of their latest rounds are."""
        return self.plane.digest

    @property
    def told(self) -> dict[Key, list[FrameEdge]]:
        """What each contributor has told of how frames lie."""
        return {key: unpacked(copy.counts[self.edges_from :]) for key, copy in self.copies.items()}

    @property
    def edges(self) -> list[FrameEdge]:
        """What anybody has told of how frames lie, in an order that is the same for all."""
        return sorted({edge for told in self.told.values() for edge in told})

    @property
    def frames(self) -> Frames:
        """Where contributors lie in this robot's own frame."""
        return self._own.frames

    def place_own(self, frames: Frames) -> None:
        """Let contributors lie in this robot's own frame as these say; others are not in its map."""
        tiles = self._own.move({**frames, self.key: IDENTITY}, self.copies)
        self.show(tiles, classes_of(self._own.summed(tiles)))

    def place_plane(self, frames: Frames) -> None:
        """Let contributors lie on the plane as these say; others are not on it."""
        self.plane.place(frames, self.copies)

    def _merge(self, changes: Mapping[Key, Change | None]) -> NDArray[np.int64]:
        """Draw what has changed in both maps."""
        drawn = [np.empty(0, np.int64)]
        for key, change in changes.items():
            if change is not None:
                self.counts += change.more_counts
                drawn.append(self._own.draw(key, self.copies[key], change.tiles))
        self.plane.take(changes, self.copies)
        tiles = np.unique(np.concatenate(drawn))
        return self.show(tiles, classes_of(self._own.summed(tiles)))
