"""Signed evidence of robots that share no frame: signed as it is made, and compared where it is drawn."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import partial

import numpy as np
from numpy.typing import NDArray

from vedette.fusion import particulars as wire
from vedette.fusion.frame_edges import room_for
from vedette.fusion.framed import FramedMap
from vedette.fusion.link import Key
from vedette.fusion.particulars import Capabilities, Note
from vedette.fusion.rendering import Frames
from vedette.fusion.sealed import SealedSnapshot
from vedette.fusion.seals import Notary
from vedette.fusion.signed import SignedEvidence
from vedette.fusion.snapshots import Change
from vedette.fusion.standing import print_of
from vedette.fusion.trust import Comparison, Times, TimesOf, Trust
from vedette.kernels.tiles import Tiling
from vedette.maps import GridFrame
from vedette.maps.transform import Transform


class TrustAcrossFrames(Trust):
    """Judges what is left once joins that evidence contradicts have been undone.

    Walls that do not fit may mean a wrong join; that what is open to others is filled does not.
    """

    def is_firm(self, tally: Comparison) -> bool:
        """Tell whether one of two has filled what is open to the other."""
        return self.is_shut(tally)


class SignedFramedEvidence(FramedMap[SealedSnapshot], SignedEvidence):
    """Each contributor signs its tiles in its own frame, and its edges with its counts.

    Nobody can sign where frames lie in each other, for that is derived. So who contradicts whom is found on
    the latest round's plane, between those that are joined: a function of what all have signed and of where
    the round says that they lie, both of which are in the digest.
    """

    def __init__(
        self,
        robot: int,
        boot: int,
        frame: GridFrame,
        counts_size: int,
        robots: int,
        *,
        notary: Notary,
        limits: Capabilities,
        mark: int = 0,
    ) -> None:
        """Start with nothing known; as `FramedEvidence` and `SignedEvidence`."""
        behind = room_for(robots)
        super().__init__(
            robot, boot, frame.shape, counts_size, notary=notary, limits=limits, mark=mark, behind=behind
        )
        self._trust = TrustAcrossFrames(Tiling(*frame.shape), limits.resolution)
        self._told_at: dict[Key, dict[int, Times]] = {}  # of each contributor's tiles on the plane
        self._begin(frame, counts_size, mark)

    @property
    def digest(self) -> int:
        """Equal for two robots iff the planes of their latest rounds are, and whom they believe."""
        return self.plane.digest ^ print_of(self.out, self._tiling.count + 1)

    @property
    def gone(self) -> Collection[int]:
        """Robots whose lies are proven, or that are revoked."""
        return self.standing.gone.keys()

    @property
    def complaints(self) -> dict[int, str]:
        """What is wrong with whom, by robot."""
        false = "it tells that maps fit where they do not: nobody is joined by that"
        return dict.fromkeys(self.misleading, false) | super().complaints

    def place_plane(self, frames: Frames) -> None:
        """Let contributors lie on the plane as these say, and compare them where they do."""
        rendering, before = self.plane.rendering, dict(self.plane.rendering.frames)
        super().place_plane(frames)
        moved = {key for key in before.keys() | frames.keys() if before.get(key) != frames.get(key)}
        for key in moved:
            self._trust.forget(key)
            self._told_at.pop(key, None)
        for key in sorted(moved & frames.keys()):
            self._drew(key, rendering.held(key))
        if moved:
            self._merge({})

    def notes(self) -> dict[int, set[Note]]:
        """Return the notes of the robots that are believed, as far as their frames are known."""
        told: dict[int, set[Note]] = {}
        for key, there in self.frames.items():
            copy = self.copies.get(key)
            if copy is not None and copy.particulars and key[0] not in self.out:
                notes = wire.decode(copy.particulars).notes
                told.setdefault(key[0], set()).update(_moved(note, there) for note in notes)
        return told

    def _merge(self, changes: Mapping[Key, Change | None]) -> NDArray[np.int64]:
        """Draw what has changed, judge anew, and show who is believed."""
        self._take_places(changes)
        tiles = self._draw(changes)
        before = self.out
        self._judge()
        self.counts = sum((copy.counts for copy in self._believed()), np.zeros_like(self.counts))
        self.plane.counts, self.plane.out = self.counts, self.out
        for key in [key for key in self.copies if key[0] in before ^ self.out]:
            self.plane.add_up(self.plane.rendering.held(key))
            tiles = np.union1d(tiles, self._show(self._own.held(key)))
        return tiles

    def _drew(self, key: Key, tiles: NDArray[np.int64]) -> None:
        """Compare what a contributor says of tiles of the plane with what others say of them."""
        copy, rendering = self.copies[key], self.plane.rendering
        times = self._told_at.setdefault(key, {})
        for tile in tiles.tolist():
            told = [copy.times[under] for under in rendering.under(key, tile, copy).tolist()]
            if told:  # one that has corrected itself lately has done so of all that it is drawn from
                times[tile] = Times(max(each.since for each in told), min(each.changed for each in told))
        self._trust.see(key, tiles, partial(rendering.read, key))

    @property
    def _times(self) -> TimesOf:
        """When who has said what of the plane's tiles."""
        return self._told_at


def _moved(note: Note, there: Transform) -> Note:
    x, y = there.place(note[0] / 100.0, note[1] / 100.0)
    return round(100.0 * x), round(100.0 * y), *note[2:]
