"""What a robot knows of a neighbour: which tracks went and came, and on a channel what both sides know."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from vedette.fusion.gaussian.information import Information
from vedette.fusion.gaussian.node import Node
from vedette.fusion.gaussian.wire import TrackMessage

MOST_PENDING = 8  # tracks sent and not known to have arrived


class Told(NamedTuple):
    """The latest tracks sent, kept in case they get lost."""

    included: int = 0
    step: int = 0
    data: bytes = b""


_NOTHING = Told()


@dataclass(eq=False)
class Contact:
    """Numbers of the tracks that go to one neighbour and come from it."""

    peer: int = -1  # the neighbour's side of the edge; -1: never heard
    sent: int = 0
    acknowledged: int = 0
    heard: int = 0
    sent_at: float = -float("inf")
    news: bool = True  # we hold something that we have not told
    owed: bool = False  # an acknowledgement
    early: TrackMessage | None = None  # of a step that we have not reached

    def acknowledge(self, heard: int) -> None:
        """Note that the neighbour has merged our tracks up to a number."""
        self.acknowledged = max(self.acknowledged, min(heard, self.sent))

    def is_overdue(self, now: float, resend_after: float) -> bool:
        """Tell whether the latest tracks seem to have got lost."""
        return self.acknowledged < self.sent and now - self.sent_at >= resend_after


@dataclass(eq=False)
class TrackEdge(Contact):
    """One end of a channel, at the node's step.

    ``common[n]`` is what both sides know if the neighbour has taken in the tracks that we sent as number n,
    and none later; 0 stands for none at all. Numbers that it cannot come back to are dropped.
    """

    common: dict[int, Information] = field(default_factory=dict)
    latest: Told = _NOTHING
    greeted_at: float = -float("inf")
    taken: bool = False  # the neighbour's offer is merged into our tracks

    @property
    def has_room(self) -> bool:
        """Whether one more message may be on its way."""
        return len(self.common) < MOST_PENDING

    def tell(self, node: Node, now: float) -> None:
        """Note that the node's tracks go to the neighbour under a new number."""
        self.sent += 1
        self.common[self.sent] = node.track
        self.latest = Told(self.heard, node.step, node.encoded())
        self.sent_at = now
        self.news = False

    def learnt(self, theirs: Information, included: int) -> dict[int, Information]:
        """Return what both sides know once they know what the neighbour's tracks add to what they knew."""
        news = theirs - self.common[included]
        return {n: track + news for n, track in self.common.items() if n >= included}

    def take(self) -> None:
        """Note that the neighbour's offer is merged, and that any of ours will not be."""
        self.taken = True
        self.acknowledged = self.sent
        self.common = {}

    def release(self, message: TrackMessage) -> None:
        """Drop what the neighbour cannot come back to: all that it sent is here, and it has heard more."""
        if self.heard >= message.sent and message.heard in self.common:
            self.common = {n: track for n, track in self.common.items() if n >= message.heard}
