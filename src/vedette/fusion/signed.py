"""Replicated evidence that is signed by who has made it, and believed as far as it agrees with others'."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from vedette.fusion import particulars as wire
from vedette.fusion.codec import EvidenceCodec
from vedette.fusion.contributors import Contributors
from vedette.fusion.link import RESEND_AFTER, Key
from vedette.fusion.own_word import OwnWord
from vedette.fusion.packing import CodePacking
from vedette.fusion.particulars import Capabilities, Note, Particulars, SignedPlace
from vedette.fusion.replicated import summed
from vedette.fusion.replicated_map import ReplicatedMap
from vedette.fusion.sealed import SealedSnapshot
from vedette.fusion.sealing import Sealings
from vedette.fusion.seals import EVIDENCE, Notary
from vedette.fusion.snapshots import NONE, Change, Delta, tiles_to_publish
from vedette.fusion.standing import Standing, print_of
from vedette.fusion.tiles import classes_of, codes_of
from vedette.fusion.trust import STANDS, Comparison, TimesOf, Trust
from vedette.kernels.tiles import TiledGrid, Tiling

FIRM_AFTER, RESTATES, COVERS = 10, 20, 30  # [0.1 s]


class MapSealings(Sealings[SealedSnapshot, Delta[np.uint8]]):
    """Of maps: a robot cannot have seen what is farther than it can have driven."""

    kind = EVIDENCE

    def __init__(
        self, standing: Standing, tiling: Tiling, counts_size: int, counted: int, limits: Capabilities
    ) -> None:
        """Check so many ``counted`` numbers; what stands behind them is told, and no count."""
        super().__init__(standing)
        self._tiling, self._counts_size, self._limits = tiling, counts_size, limits
        self._counted = counted

    def blank(self) -> SealedSnapshot:
        """Return one without tiles."""
        return SealedSnapshot(self._tiling, self._counts_size)

    def admit(self, news: Delta[np.uint8], held: SealedSnapshot) -> None:
        """Raise ValueError for what its contributor cannot have seen."""
        assert news.voucher is not None
        told = news.voucher.particulars
        now = wire.decode(held.particulars if told is None else told)
        if held.particulars:
            then = wire.decode(held.particulars)
            if (now.row, now.col, now.began) != (then.row, then.col, then.began):
                raise ValueError("it has set out from two places")
        if news.voucher.place is not None:
            wire.decode_place(news.voucher.place)
        self._limits.check_visits(now)
        if news.counts is not None:
            self._limits.check_counts(news.counts[: self._counted], now, news.voucher.seal.time)
        self._limits.check(self._tiling, news.tiles, now, news.voucher.seal.time)


class SignedEvidence(ReplicatedMap[SealedSnapshot]):
    """Team evidence = sum over the contributors that are believed; all are held and passed on.

    Who is believed is a function of what all have signed, and of nothing else, so that robots that hold the
    same believe the same: it is in the digest. ``vedette.fusion.ReplicatedEvidence`` is the same without
    keys, where everybody is believed.
    """

    def __init__(
        self,
        robot: int,
        boot: int,
        shape: tuple[int, int],
        counts_size: int,
        *,
        notary: Notary,
        limits: Capabilities,
        mark: int = 0,
        behind: int = 0,
    ) -> None:
        """Start with nothing known; ``boot < 2**38`` must differ from those of the robot's earlier starts.

        ``behind``: numbers that each contributor tells behind its counts.
        """
        counted, counts_size = counts_size, counts_size + behind
        tiling = Tiling(*shape)
        standing = Standing(notary)
        sealing = MapSealings(standing, tiling, counts_size, counted, limits)
        contributors: Contributors[SealedSnapshot, Delta[np.uint8]] = Contributors(
            robot, boot, lambda: SealedSnapshot(tiling, counts_size), RESEND_AFTER, sealing
        )
        codec = EvidenceCodec(tiling, counts_size, CodePacking(), sealed=True)
        super().__init__(tiling, counts_size, mark, codec, contributors)
        self.out: frozenset[int] = frozenset()  # robots that are not believed
        self.unsettled = False  # time alone may change who is believed
        self.standing = standing
        self._trust = Trust(tiling, limits.resolution)
        self._own_word = OwnWord(tiling, limits)
        self._excluded, self._reinstated = frozenset[int](), frozenset[int]()  # by the operator's word
        self._again: dict[int, int] = {}  # tiles to look at again, since evidence grows firm: when [0.1 s]
        self._told: Particulars | None = None  # by this robot
        self._place = b""  # of this robot
        self._placed: dict[Key, tuple[SignedPlace, int]] = {}  # others, since that was last asked for

    @property
    def signed(self) -> SignedEvidence:
        """Itself."""
        return self

    @property
    def digest(self) -> int:
        """64 bits, equal (up to 2^-64) for two robots iff what they show, and whom they believe, is equal."""
        return super().digest ^ print_of(self.out, self._tiling.count + 1)

    @property
    def complaints(self) -> dict[int, str]:
        """What is wrong with whom, by robot."""
        alone = "its evidence contradicts that of two others or more: the map and the plans leave it out"
        told = dict.fromkeys(self.out, alone) | self._own_word.complaints
        return told | self._contributors.complaints | self.standing.said

    def heed(self) -> None:
        """Take up that somebody has gone."""
        self._merge({})

    def overrule(self, excluded: frozenset[int], reinstated: frozenset[int]) -> None:
        """Believe none of the first robots, and all of the second, whatever their evidence says."""
        if (excluded, reinstated) != (self._excluded, self._reinstated):
            self._excluded, self._reinstated = excluded, reinstated
            self._merge({})

    def contradictions(self, now: int) -> dict[tuple[int, int], Comparison]:
        """Return how far pairs of robots contradict each other, of what stands at a time [0.1 s]."""
        return self._trust.contradictions(self._times, now)

    def set_out(self, row: int, col: int) -> None:
        """Note the cell at which this robot starts; the first one stands."""
        if self._told is None:
            self._told = Particulars(row, col, self.standing.notary.now())

    def tell(self, notes: Iterable[tuple[int, int, int]]) -> None:
        """Put these notes, x, y [cm] and a number, in the place of this robot's earlier ones."""
        if self._told is not None:
            since = {(x, y, number): when for x, y, number, when in self._told.notes}
            dated = [(*note, since.get(note, self.standing.notary.now())) for note in notes]
            self._told = structs.replace(self._told, notes=tuple(dated[: wire.MOST_NOTES]))

    def be_at(self, sequence: int, x: int, y: int) -> None:
        """Note where this robot is by one of its beacons [cm]: that goes with its next evidence."""
        self._place = wire.encode(SignedPlace(sequence, x, y))

    @property
    def covers(self) -> bool:
        """Tell whether this robot's latest evidence has told of its place lately."""
        own = self._contributors.own
        return bool(own.place) and self.standing.notary.now() < own.seal.time + COVERS

    def take_places(self) -> dict[Key, tuple[SignedPlace, int]]:
        """Return where others have signed to be, and when [0.1 s], since that was last asked for."""
        placed, self._placed = self._placed, {}
        return placed

    def publish(
        self, own: TiledGrid[np.int8], changed: NDArray[np.int64] | None, counts: NDArray[np.int64] | None
    ) -> NDArray[np.int64]:
        """Share the tiles of ``own`` that hold ``changed`` flat cells (None: find those whose class changed).

        And once again a little later: what contradicts others has to be firm. While it is not settled whom to
        believe, the time is told even if there is nothing new. Returns the tiles in which the team map
        changed.
        """
        published, now = self._contributors.own, self.standing.notary.now()
        fresh = tiles_to_publish(own, changed, published)
        firmer = [tile for tile, due in self._again.items() if due <= now]
        tiles = np.union1d(fresh, np.array(firmer, np.int64))
        for tile in firmer:
            del self._again[tile]
        self._again |= dict.fromkeys(fresh.tolist(), now + FIRM_AFTER)
        told = b"" if self._told is None else wire.encode(self._told)
        restates = self.unsettled and now >= published.seal.time + RESTATES
        change = published.put(tiles, codes_of(own.read(tiles)), counts, told, self._place, now, restates)
        return self._merge({self._contributors.key: change})

    def _merge(self, changes: Mapping[Key, Change | None]) -> NDArray[np.int64]:
        """Judge anew, and add up anew what has changed, tile by tile."""
        copies = self._contributors.copies
        changed = [NONE]
        self._take_places(changes)
        for key, change in changes.items():
            if change is not None:
                changed.append(change.tiles)
                self._trust.see(key, change.tiles, copies[key].values.read)
        before = self.out
        self._judge()
        changed += [copy.known_tiles for (robot, _), copy in copies.items() if robot in before ^ self.out]
        self.counts = sum((copy.counts for copy in self._believed()), np.zeros_like(self.counts))
        tiles = np.unique(np.concatenate(changed))
        return self.show(tiles, classes_of(summed(self._believed(), tiles)))

    def _take_places(self, changes: Mapping[Key, Change | None]) -> None:
        """Note where others say to be by their news."""
        for key, change in changes.items():
            copy = self._contributors.copies[key]
            if change is not None and key != self._contributors.key and copy.place:
                place = wire.decode_place(copy.place)
                self._placed[key] = place, copy.seal.time
                if copy.particulars:
                    self._own_word.take(key, place, wire.decode(copy.particulars), copy)

    @property
    def _times(self) -> TimesOf:
        """When who has said what of the tiles that are compared."""
        return {key: copy.times for key, copy in self._contributors.copies.items()}

    def notes(self) -> dict[int, set[Note]]:
        """Return the notes of the robots that are believed, by robot."""
        told: dict[int, set[Note]] = {}
        for (robot, _), copy in self._contributors.copies.items():
            if copy.particulars and robot not in self.out:
                told.setdefault(robot, set()).update(wire.decode(copy.particulars).notes)
        return told

    def counts_of_each(self) -> NDArray[np.int64]:
        """``(n, K)`` what each robot that is believed has counted, all its starts together."""
        told: dict[int, NDArray[np.int64]] = {}
        for (robot, _), copy in self._contributors.copies.items():
            if robot not in self.out:
                told[robot] = told.get(robot, 0) + copy.counts
        return np.array([told[robot] for robot in sorted(told)], np.int64).reshape(-1, len(self.counts))

    def _believed(self) -> Iterable[SealedSnapshot]:
        return (copy for (robot, _), copy in self._contributors.copies.items() if robot not in self.out)

    def _judge(self) -> None:
        """Find out whom not to believe, and whether time alone would change that."""
        copies = self._contributors.copies
        said: dict[int, int] = {}
        for (robot, _), copy in copies.items():
            said[robot] = max(said.get(robot, 0), copy.seal.time)
        # nobody alone makes it late: the time that two robots have told, at least
        now = sorted(said.values())[-2] if len(said) > 1 else 0
        times = self._times
        gone = frozenset(self.standing.gone) | self._contributors.restless
        self.out = gone | self._overruled(self._trust.out(times, now, gone))
        self.unsettled = self.out != gone | self._overruled(self._trust.out(times, now + STANDS, gone))

    def _overruled(self, out: frozenset[int]) -> frozenset[int]:
        """Return whom not to believe by the operator's word; who is proved to lie, or revoked, stays out."""
        return (out | self._excluded) - self._reinstated
