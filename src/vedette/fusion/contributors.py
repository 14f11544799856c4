"""Everybody's evidence kept apart by contributor, and exchanged on any graph: for maps and steps alike."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Sequence
from functools import partial
from typing import Any, Generic, Protocol, TypeVar

from vedette.fusion.link import Boots, EvidenceLink, Key, NewsT, Payload, check_boot

MOST_CONTRIBUTORS = 1024
MOST_STARTS = 64  # of one robot; where they are signed, whoever makes more is not believed
HALF, STEP = 1 << 62, 1 << 32  # a version may be raised to the one, and beyond it by the other, at once

News_co = TypeVar("News_co", covariant=True)


class Copy(Protocol[News_co]):
    """A contributor's evidence as of one version; 0 is blank."""

    @property
    def version(self) -> int:
        """The version."""

    def since(self, base: int) -> News_co:
        """Return what is new since an earlier version, in one piece or its beginning."""

    def overtake(self, version: int) -> None:
        """As the writer: go on above a version that somebody has told in its name.

        Raises:
            ValueError: such evidence cannot be told anew.
        """


CopyT = TypeVar("CopyT", bound=Copy[Any])
CopyT_contra = TypeVar("CopyT_contra", bound=Copy[Any], contravariant=True)


class Sealing(Protocol[CopyT_contra, NewsT]):
    """Lets nobody speak for another: contributors seal what they tell, and all check what they hear."""

    @property
    def doubted(self) -> Collection[Key]:
        """Contributors whose whole evidence has to come anew."""

    def seal(self, key: Key, own: CopyT_contra) -> None:
        """As the writer: seal the present version, if it is not."""

    def with_certificate(self, robot: int, base: int, news: NewsT) -> NewsT:
        """Return news, with the certificate of who has made them for whoever holds nothing of that yet."""

    def is_gone(self, robot: int) -> bool:
        """Tell whether nobody needs to be told of a robot any more."""

    def admits(self, neighbour: int, key: Key, held: CopyT_contra, news: NewsT) -> bool:
        """Tell whether news that came over a link are the contributor's own; old news may be anything."""


class Contributors(Generic[CopyT, NewsT]):
    """A state-based replicated data type: copies of a contributor's evidence merge by "the later one wins".

    A contributor is one start of one robot, ``(robot, boot)``; only it adds to its evidence. So loss,
    repetition, reordering, cycles, partition, re-joining and restarts neither lose evidence that any holder
    lives to tell, nor count any twice; a dead robot's evidence survives.

    Whoever passes evidence on could change it. So it is sealed, where there are keys (``Sealing``); where
    there are none, a contributor that is told of more in its name than it has published goes on above that,
    and tells the whole anew.
    """

    def __init__(
        self,
        robot: int,
        boot: int,
        blank: Callable[[], CopyT],
        resend_after: float,
        sealing: Sealing[CopyT, NewsT] | None = None,
    ) -> None:
        """Start with nothing known; ``blank`` makes the copy of a contributor of whom nothing is known."""
        check_boot(boot)
        self._sealing = sealing
        self.own = blank()
        self.copies: dict[Key, CopyT] = {(robot, boot): self.own}
        self.key: Key = (robot, boot)  # this robot's own
        self._blank = blank
        self._links: dict[int, EvidenceLink[NewsT]] = {}
        self._boots = Boots()
        self._resend_after = resend_after
        self._overtook = -float("inf")  # when [s]

    def known(self) -> dict[Key, int]:
        """Return the versions of all copies that are not blank."""
        return {key: copy.version for key, copy in self.copies.items() if copy.version}

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Exchange with exactly these robots from now on; the graph may have cycles."""
        after = self._resend_after
        self._links = {n: self._links.get(n) or EvidenceLink(*self.key, after) for n in neighbours}

    def tell(self, neighbour: int, now: float) -> Payload[NewsT] | None:
        """Return what the neighbour lacks, and what it waits to see acknowledged; None if nothing."""
        held, told = self.known(), self.copies
        if self._sealing is not None:
            self._sealing.seal(self.key, self.own)
            held = {key: version for key, version in held.items() if key not in self._sealing.doubted}
            told = {key: copy for key, copy in told.items() if not self._sealing.is_gone(key[0])}
        streams = ((key, copy.version, partial(self._since, key, copy)) for key, copy in told.items())
        return self._links[neighbour].tell(held, streams, now)

    def _since(self, key: Key, copy: CopyT, base: int) -> NewsT:
        news: NewsT = copy.since(base)
        return news if self._sealing is None else self._sealing.with_certificate(key[0], base, news)

    def hear(self, neighbour: int, payload: Payload[NewsT], now: float) -> list[tuple[Key, NewsT]]:
        """Note what a neighbour says of its side of the link; return the news to merge into the copies.

        Raises ValueError, and changes nothing, if the payload claims what cannot be.
        """
        keys = {key for key, _ in payload.sections}
        if len(keys) < len(payload.sections):
            raise ValueError("fusion payload: two sections of one stream")
        if len(self.copies) + len(keys - self.copies.keys()) > MOST_CONTRIBUTORS:
            raise ValueError(f"fusion payload: more than {MOST_CONTRIBUTORS} contributors")
        if self._sealing is None:
            self._check_told(neighbour, payload)
        told = payload.told_of(self.key)
        if self._sealing is None and told > self.own.version and now >= self._overtook + self._resend_after:
            self.own.overtake(told)
            self._overtook = now
        link = self._links.get(neighbour)
        # evidence is evidence, but what an earlier start of the neighbour held is lost
        if link is not None and not self._boots.is_stale(neighbour, payload.nonce):
            link.hear(payload, now)
        news = [(key, more) for key, more in payload.sections if key != self.key]
        copies = {key: self.copies.get(key) or self._blank() for key, _ in news}
        sealing = self._sealing
        if sealing is not None:
            room = self._with_room(copies)
            news = [
                (key, more)
                for key, more in news
                if key in room and sealing.admits(neighbour, key, copies[key], more)
            ]
        self.copies |= {key: copies[key] for key, _ in news}
        return news

    def _check_told(self, neighbour: int, payload: Payload[NewsT]) -> None:
        """Raise ValueError for names, and versions, that anybody may have made up for others to carry.

        Not where names are signed: who passes on what its maker has signed is not at fault, and all else that
        it tells would be lost with it.
        """
        held = self.known()
        told = [*payload.have.items(), *((key, news.version) for key, news in payload.sections)]
        for key, version in told:
            if version > max(held.get(key, 0), HALF) + STEP:
                raise ValueError(f"fusion payload: version {version} is far beyond any that there can be")
        starts = Counter(robot for robot, _ in self.copies)
        for key, _ in payload.sections:
            if key not in self.copies and key[0] != neighbour and starts[key[0]] >= MOST_STARTS:
                raise ValueError(f"fusion payload: more than {MOST_STARTS} starts of robot {key[0]}")

    @property
    def restless(self) -> frozenset[int]:
        """Robots of which there are more starts than there can be: the same for all who hold them."""
        starts = Counter(robot for robot, _ in self.copies)
        return frozenset(robot for robot, number in starts.items() if number > MOST_STARTS)

    @property
    def complaints(self) -> dict[int, str]:
        """What is wrong with whom, by robot."""
        return dict.fromkeys(
            self.restless, f"it has started more than {MOST_STARTS} times: nothing of it counts"
        )

    def _with_room(self, keys: Iterable[Key]) -> set[Key]:
        """Return those of which there is room for what they tell: twice as many starts show enough."""
        starts, room = Counter(robot for robot, _ in self.copies), set[Key]()
        for key in keys:
            starts[key[0]] += key not in self.copies
            if key in self.copies or starts[key[0]] <= 2 * MOST_STARTS:
                room.add(key)
        return room
