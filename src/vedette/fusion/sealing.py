"""Signing one's own evidence, and checking everybody's: once a version, however often it comes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from vedette.fusion.contradictions import SignedWord, Twice
from vedette.fusion.link import Key
from vedette.fusion.seals import Seal
from vedette.fusion.standing import Standing


class SealedNews(Protocol):
    """What turns a version of somebody's evidence into a later one, and who vouches for it."""

    @property
    def base(self) -> int:
        """The least version that it can be added to."""

    @property
    def version(self) -> int:
        """The later version."""

    @property
    def seal(self) -> Seal:
        """The contributor's word for the later version."""

    @property
    def certificate(self) -> bytes:
        """The contributor's; empty for who has it."""

    def certified(self, certificate: bytes) -> Any:
        """Return the same with a certificate."""


NewsT = TypeVar("NewsT", bound=SealedNews)
NewsT_contra = TypeVar("NewsT_contra", bound=SealedNews, contravariant=True)


class SealedCopy(Protocol[NewsT_contra]):
    """One contributor's evidence as of a version that it has signed."""

    root: bytes  # of all of it

    @property
    def version(self) -> int:
        """The version."""

    @property
    def seal(self) -> Seal:
        """The contributor's word for it; for the writer, of the time alone if it is not signed yet."""

    def put_seal(self, seal: Seal) -> None:
        """As the writer: sign what there is."""

    def root_after(self, news: NewsT_contra) -> bytes:
        """Return the root that there would be after news that connect; nothing changes."""


CopyT = TypeVar("CopyT", bound=SealedCopy[Any])


@dataclass
class Sealings(ABC, Generic[CopyT, NewsT]):
    """``vedette.fusion.contributors.Sealing`` of evidence of one kind."""

    kind: ClassVar[str]  # under every signature

    standing: Standing
    doubted: set[Key] = field(default_factory=set)  # contributors whose whole evidence has to come anew
    _certificates: dict[int, bytes] = field(default_factory=dict)  # by robot
    _sealed: int = 0  # version of this robot's own

    def seal(self, key: Key, own: CopyT) -> None:
        """Sign the root of what this robot has seen, if it has changed."""
        if own.version == self._sealed:
            return
        self._sealed, time = own.version, own.seal.time
        notary = self.standing.notary
        own.put_seal(Seal(time, notary.sign(self.kind, *key, own.version, time, own.root)))
        self._certificates[key[0]] = notary.certificate

    def with_certificate(self, robot: int, base: int, news: NewsT) -> NewsT:
        """Give the certificate to who holds nothing of this robot's yet."""
        certified: NewsT = news.certified(b"" if base else self._certificates[robot])
        return certified

    def is_gone(self, robot: int) -> bool:
        """Tell whether nothing of a robot counts any more, so that nobody needs to be told of it."""
        return robot in self.standing.gone

    def admits(self, neighbour: int, key: Key, held: CopyT, news: NewsT) -> bool:
        """Check who has signed the news, and that they can be so; else say whose fault it is."""
        robot = key[0]
        if self.is_gone(robot):
            return False
        if news.version == held.version:
            self._compare(key, held, news)
        if not news.base <= held.version < news.version:
            return True
        try:
            if news.certificate:
                self.standing.notary.admit(robot, news.certificate)
            self.word(key, news.version, news.seal, held.root_after(news)).check(self.standing.notary, robot)
        except ValueError as error:
            return self.unlike(neighbour, key, held, news, f"{error}")
        self.doubted.discard(key)
        if news.certificate:
            self._certificates[robot] = news.certificate
        try:
            self.admit(news, held)
        except ValueError as error:
            self.standing.complaints[robot] = f"its evidence is refused: {error}"
            return False
        return True

    def word(self, key: Key, version: int, seal: Seal, root: bytes) -> SignedWord:
        """Return a seal as it was signed."""
        return SignedWord((self.kind, *key, version, seal.time, root), seal.signature)

    def _compare(self, key: Key, held: CopyT, news: NewsT) -> None:
        """Find out whether a contributor has signed a version twice; by the whole, which is asked for."""
        if news.seal != held.seal and news.base:
            self.doubted.add(key)
            return
        self.doubted.discard(key)
        if news.seal == held.seal:
            return
        first = self.word(key, held.version, held.seal, held.root)
        second = self.word(key, news.version, news.seal, self.blank().root_after(news))
        with suppress(ValueError):  # nobody's word: it changes nothing
            second.check(self.standing.notary, key[0])
            self.standing.catch(key[0], Twice(first, second))

    def unlike(self, neighbour: int, key: Key, held: CopyT, news: NewsT, why: str) -> bool:
        """Refuse news that their contributor has not signed, as this robot sees it.

        It may be that what this robot holds is another evidence of one version: then the whole tells. But
        nobody honest passes on a whole that it has not checked: who does has changed it.
        """
        if news.base:
            self.doubted.add(key)
            return False
        self.standing.forgers.add(neighbour)
        self.standing.complaints[neighbour] = (
            f"what it passes on of robot-{key[0] + 1} is not that robot's: {why}"
        )
        return False

    @abstractmethod
    def blank(self) -> CopyT:
        """Return the evidence of who has told nothing."""

    @abstractmethod
    def admit(self, news: NewsT, held: CopyT) -> None:
        """Raise ValueError for what the contributor cannot have seen."""
