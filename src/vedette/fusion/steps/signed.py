"""Replicated step evidence that is signed by who has made it: nobody speaks for another."""

from __future__ import annotations

from typing import TypeVar

from vedette.fusion.contributors import Contributors
from vedette.fusion.link import RESEND_AFTER, Key, Payload
from vedette.fusion.particulars import SignedPlace
from vedette.fusion.seals import Notary
from vedette.fusion.standing import Standing, print_of
from vedette.fusion.steps.elements import Elements
from vedette.fusion.steps.replicated import SharedLogs
from vedette.fusion.steps.sealed import LogSealings, SealedEntries, SealedLog
from vedette.fusion.steps.wire import MOST_STEP, decode, encode, unpack

E = TypeVar("E")


class SignedSteps(SharedLogs[E, SealedLog, SealedEntries]):
    """Each total is the sum over the contributors of whom something counts; all logs are held.

    ``vedette.fusion.steps.ReplicatedSteps`` is the same without keys, where everybody is believed.
    """

    def __init__(
        self,
        robot: int,
        boot: int,
        elements: Elements[E],
        *,
        notary: Notary,
        resend_after: float = RESEND_AFTER,
    ) -> None:
        """Start with nothing known; ``boot < 2**38`` must differ from those of the robot's earlier starts."""
        self.standing = Standing(notary)
        self.out: frozenset[int] = frozenset()  # robots of whom nothing counts
        sealing = LogSealings(self.standing)
        super().__init__(elements, Contributors(robot, boot, SealedLog, resend_after, sealing))

    @property
    def signed(self) -> SignedSteps[E]:
        """Itself."""
        return self

    covers = False  # what vehicles see says nothing of where they are

    def be_at(self, sequence: int, x: int, y: int) -> None:
        """Tell nothing of the robot's place."""

    def take_places(self) -> dict[Key, tuple[SignedPlace, int]]:
        """Return nothing: nobody tells of its place."""
        return {}

    @property
    def complaints(self) -> dict[int, str]:
        """What is wrong with whom, by robot."""
        return self._contributors.complaints | self.standing.said

    @property
    def digest(self) -> int:
        """64 bits that agree (up to 2^-64) iff the totals do, and whom robots believe."""
        return super().digest ^ print_of(self.out, MOST_STEP + 1)

    def heed(self) -> None:
        """Take what somebody has signed who is gone out of the totals."""
        before, self.out = self.out, frozenset(self.standing.gone) | self._contributors.restless
        for (robot, _), log in self._contributors.copies.items():
            if robot in self.out - before:
                for step, data, _ in unpack(log.data(0, log.version), self._elements.most_bytes):
                    self.add(
                        step, self._elements.subtract(self._elements.zero(), self._elements.decode(data))
                    )

    def publish(self, step: int, element: E) -> None:
        """Add the robot's own evidence of a step."""
        super().publish(step, element)
        self._contributors.own.time = self.standing.notary.now()

    def _take(self, key: Key, step: int, element: E) -> None:
        if key[0] not in self.out:
            self.add(step, element)

    def _taken(self, key: Key, news: SealedEntries) -> None:
        self._contributors.copies[key].put_seal(news.seal)
        if key[0] not in self.out and key[0] in self._contributors.restless:
            self.heed()

    def _encode(self, payload: Payload[SealedEntries]) -> bytes:
        sections = [(key, entries.packed()) for key, entries in payload.sections]
        return encode(Payload(payload.nonce, payload.greeting, payload.have, sections))

    def _decode(self, data: bytes) -> Payload[SealedEntries]:
        told = decode(data)
        sections = [(key, SealedEntries.unpacked(entries)) for key, entries in told.sections]
        return Payload(told.nonce, told.greeting, told.have, sections)
