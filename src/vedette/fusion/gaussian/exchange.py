"""One robot's tracks, told to its neighbours whole: what the channel filter and intersection share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

from vedette.fusion.gaussian.edge import Contact
from vedette.fusion.gaussian.information import Information, TrackMotion
from vedette.fusion.gaussian.node import Node
from vedette.fusion.gaussian.wire import TrackMessage
from vedette.fusion.link import RESEND_AFTER, Boots, check_boot

ContactT = TypeVar("ContactT", bound=Contact)


class TrackExchange(ABC, Generic[ContactT]):
    """What crosses an edge are whole tracks with a number: loss, repetition and reordering do no harm.

    Tracks of a step that this robot has not reached wait until it has.
    """

    def __init__(
        self,
        robot: int,
        boot: int,
        prior: Information,
        motion: TrackMotion,
        start: int,
        *,
        resend_after: float = RESEND_AFTER,
    ) -> None:
        """``prior`` are the tracks at step ``start``, ahead of its evidence; the same for every robot.

        ``boot < 2**38`` must differ from those of the robot's earlier starts.
        """
        check_boot(boot)
        self._robot, self._boot = robot, boot
        self._node = Node(prior, motion, start)
        self._edges: dict[int, ContactT] = {}
        self._boots = Boots()
        self._resend_after = resend_after

    @property
    def digest(self) -> int:
        """64 bits that agree if step and tracks do, up to rounding."""
        return self._node.digest

    def observe(self, step: int, likelihood: Information) -> None:
        """Take in this robot's likelihood of the present step (or a later one: advance to it).

        Raises InputError for an earlier step, and for a likelihood of the wrong shape.
        """
        self.advance(step)
        self._node.observe(step, likelihood)
        self._spread(None)

    def advance(self, step: int) -> None:
        """Predict up to a step; earlier ones change nothing."""
        while self._node.step < step:
            self._predict()
            for neighbour, edge in self._edges.items():
                if edge.early is not None and edge.early.step <= self._node.step:
                    message, edge.early = edge.early, None
                    self._take(neighbour, edge, message, self._node.decoded(message))

    def estimate(self) -> tuple[int, Information]:
        """Return the step and the tracks, its evidence included."""
        return self._node.step, self._node.track

    def _predict(self) -> None:
        """Go on by one step."""
        self._node.predict()

    def _spread(self, source: ContactT | None) -> None:
        """Note that there is news for everybody but the source."""
        for edge in self._edges.values():
            edge.news |= edge is not source

    def _take(self, neighbour: int, edge: ContactT, message: TrackMessage, theirs: Information) -> None:
        """Merge a neighbour's tracks if they are later than those heard of it, now or at their step."""
        if message.sent <= edge.heard:
            return
        if message.step > self._node.step:
            edge.early = message
        else:
            self._merge(neighbour, edge, message, theirs)

    @abstractmethod
    def _merge(self, neighbour: int, edge: ContactT, message: TrackMessage, theirs: Information) -> None:
        """Merge a neighbour's tracks, which are of the present step."""
