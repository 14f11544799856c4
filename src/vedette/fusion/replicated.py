"""Replicated evidence: everybody's own evidence, kept apart by contributor, summed into the team map."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.codec import MOST_SECTIONS, MOST_TILES, Codec, Payload
from vedette.fusion.link import Boots, Key, Link, check_boot
from vedette.fusion.packing import CodePacking
from vedette.fusion.snapshots import NONE, Change, Snapshot, tiles_to_publish
from vedette.fusion.tiles import CELLS, WORDS, TeamMap, Tiling, classes_of, codes_of

RESEND_AFTER = 2.5  # [s]: more than two of the agents' 1 s rounds, one to send and one to acknowledge
MOST_CONTRIBUTORS = 1024


class ReplicatedEvidence:
    """Team evidence = sum over contributors of the latest known snapshot of each one's own evidence.

    A state-based replicated data type: a contributor is one start of one robot, ``(robot, boot)``; its
    copies merge by "the later version wins". So loss, repetition, reordering, cycles, partition, re-joining
    and restarts neither lose evidence that any holder lives to tell, nor count any twice.

    Memory is O(contributors x the area each has seen), 3 bytes a cell, beside 6 bytes a cell for the team. A
    contributor that shows nothing costs addresses, not memory: the system hands out pages as tiles fill.
    ``own`` grids are int8 log-odds ``(rows, cols)``; times are seconds of any one clock of this robot.
    """

    def __init__(
        self,
        robot: int,
        boot: int,
        shape: tuple[int, int],
        counts_size: int,
        *,
        resend_after: float = RESEND_AFTER,
    ) -> None:
        """Start with nothing known; ``boot < 2**38`` must differ from those of the robot's earlier starts."""
        check_boot(boot)
        self._key: Key = (robot, boot)
        self._tiling = Tiling(*shape)
        self._codec = Codec(self._tiling, counts_size, CodePacking())
        self._team = TeamMap(self._tiling, counts_size)
        self._words: NDArray[np.int32] = np.zeros((self._tiling.count, CELLS), dtype=np.int32)
        self._own = Snapshot(self._tiling.count, counts_size, np.uint8)
        self._snapshots: dict[Key, Snapshot] = {self._key: self._own}
        self._links: dict[int, Link] = {}
        self._boots = Boots()
        self._resend_after = resend_after

    @property
    def classes(self) -> NDArray[np.uint8]:
        """``(rows, cols)`` team map: UNKNOWN, FREE or OCCUPIED; the same array, kept up to date."""
        return self._team.classes

    @property
    def counts(self) -> NDArray[np.int64]:
        """``(counts_size,)`` sum of everybody's published counts."""
        return self._team.counts

    @property
    def digest(self) -> int:
        """64 bits that agree iff team map and counts do."""
        return self._team.digest

    def contributors(self) -> int:
        """Return how many robots' evidence this robot holds; each start of a robot counts."""
        return sum(snapshot.version > 0 for snapshot in self._snapshots.values())

    def publish(
        self, own: NDArray[np.int8], changed: NDArray[np.int64] | None, counts: NDArray[np.int64] | None
    ) -> NDArray[np.int64]:
        """Share the tiles of ``own`` that hold ``changed`` flat cells (None: find those whose class changed).

        Returns the tiles in which the team map changed.
        """
        tiles = tiles_to_publish(self._tiling, own, changed, self._own)
        change = self._own.write(tiles, codes_of(self._tiling.gather(own, tiles)), counts)
        return NONE if change is None else self._merge([change])

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Exchange with exactly these robots from now on; the graph may have cycles."""
        boot, after = self._key[1], self._resend_after
        self._links = {n: self._links.get(n) or Link(boot, after) for n in neighbours}

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return what the neighbour lacks, and what it waits to see acknowledged; None if nothing."""
        link = self._links[neighbour]
        greeting = link.greeting(now)
        if greeting is not None:
            have = {key: snapshot.version for key, snapshot in self._snapshots.items() if snapshot.version}
        else:
            have = {key: self._snapshots[key].version for key in sorted(link.owed)}
        link.owed.clear()
        payload = Payload(link.nonce, greeting, have)
        if link.met:
            self._add_sections(payload, link, now)
        if greeting is None and not have and not payload.sections:
            return None
        return self._codec.encode(payload)

    def receive(self, neighbour: int, payload: bytes, now: float) -> NDArray[np.int64]:
        """Merge a neighbour's payload; returns the tiles in which the team map changed.

        Raises ValueError, and changes nothing, if the payload is malformed.
        """
        message = self._codec.decode(payload)
        self._check(message)
        link = self._links.get(neighbour)
        if link is not None:
            if self._boots.is_stale(neighbour, message.nonce):
                link = None  # evidence is evidence, but what that start of the neighbour held is lost
            else:
                link.hear(message.nonce, message.greeting, message.have, now)
        changes = []
        for key, delta in message.sections:
            if key == self._key:
                continue
            change = self._snapshot(key).apply(delta)
            if change is not None:
                changes.append(change)
            if link is not None:
                link.owed.add(key)
                link.holds(key, delta.version, now)
        return self._merge(changes)

    def _add_sections(self, payload: Payload, link: Link, now: float) -> None:
        tiles = 0
        for key, snapshot in self._snapshots.items():
            base = link.base(key, now)
            if base >= snapshot.version:
                continue
            if tiles > MOST_TILES or len(payload.sections) == MOST_SECTIONS:
                break  # the rest goes with the next call
            delta = snapshot.since(base)
            link.sending(key, base, snapshot.version, now)
            payload.sections.append((key, delta))
            tiles += len(delta.tiles)

    def _check(self, message: Payload) -> None:
        told = [*message.have.items(), *((key, delta.version) for key, delta in message.sections)]
        if any(key == self._key and version > self._own.version for key, version in told):
            raise ValueError("fusion payload: claims evidence of this robot that it never published")
        strange = sum(key not in self._snapshots for key, _ in message.sections)
        if len(self._snapshots) + strange > MOST_CONTRIBUTORS:
            raise ValueError(f"fusion payload: more than {MOST_CONTRIBUTORS} contributors")

    def _snapshot(self, key: Key) -> Snapshot:
        if key not in self._snapshots:
            self._snapshots[key] = Snapshot(self._tiling.count, len(self.counts), np.uint8)
        return self._snapshots[key]

    def _merge(self, changes: list[Change]) -> NDArray[np.int64]:
        """team += new - old, tile by tile."""
        if not changes:
            return NONE
        for change in changes:
            self._words[change.tiles] += WORDS[change.after] - WORDS[change.before]
            self._team.counts += change.more_counts
        tiles = np.unique(np.concatenate([change.tiles for change in changes]))
        return self._team.show(tiles, classes_of(self._words[tiles]))
