"""What nodes of rounds with a root have in common: whom they hear, and who is cut."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Generic

from vedette.errors import InputError
from vedette.negotiation.messages import Message, RoundOutcome
from vedette.negotiation.node import Claims, Outgoing, Participant, TreeLinks
from vedette.problem.objective import ImpactT
from vedette.problem.reach import Reach


class RootedNode(ABC, Generic[ImpactT]):
    """A `Negotiator` that hears those whom it waits for, and nobody who is cut."""

    def __init__(
        self,
        own: Participant[ImpactT],
        neighbours: Sequence[int],
        parent: int | None,
        reaches: Mapping[int, Reach] | None,
        claims: Claims[ImpactT] | None,
    ) -> None:
        """Join a round; arguments as `TokenNode`."""
        self.finished: RoundOutcome | None = None
        self._own = own
        self._links = TreeLinks(own, neighbours, reaches, claims)
        self._claims = claims
        self._parent = parent
        self._children = [k for k in neighbours if k != parent]
        self._cut: set[int] = set()
        self._started = False

    @property
    @abstractmethod
    def waiting_for(self) -> frozenset[int]:
        """Neighbours without whose next message nothing goes on here; none once the round is over."""

    @property
    def goes_back(self) -> bool:
        """Never: who changes its mind says so."""
        return False

    def start(self) -> list[Outgoing[ImpactT]]:
        """Begin, once the own impact is ready; messages may have arrived before."""
        self._started = True
        return self._gather()

    def receive(self, sender: int, message: Message[ImpactT]) -> list[Outgoing[ImpactT]]:
        """Take in a neighbour's message; ``ValueError`` if it breaks the protocol or claims too much."""
        self._links.check(sender)
        if self.finished is not None or sender in self._cut:
            return []
        answer = self._hear(sender, message) if sender in self.waiting_for else None
        if answer is None:
            raise InputError(f"message {type(message).__name__} from {sender} is out of turn; drop it")
        return answer

    def cut(self, neighbour: int) -> list[Outgoing[ImpactT]]:
        """Go on without a child and all behind it; see `Negotiator`."""
        self._links.check_child(neighbour, self._parent)
        if self.finished is not None or neighbour in self._cut:
            return []
        self._cut.add(neighbour)
        return self._go_without(neighbour)

    @abstractmethod
    def _gather(self) -> list[Outgoing[ImpactT]]:
        """Report to the parent once the own impact is ready and all children have reported."""

    @abstractmethod
    def _hear(self, sender: int, message: Message[ImpactT]) -> list[Outgoing[ImpactT]] | None:
        """Take in a message of somebody who is waited for; ``None`` for one out of turn."""

    @abstractmethod
    def _go_without(self, child: int) -> list[Outgoing[ImpactT]]:
        """Go on without a child that has just been cut."""

    def _check_length(self, sweeps: int, most: int) -> None:
        """Raise ``InputError`` if the parent begins another sweep after the last that there can be."""
        if sweeps >= most:
            raise InputError(f"the round has had {sweeps} sweeps, and does not end; drop it")

    def _check_size(self, child: int, size: int) -> None:
        """Raise ``InputError`` if a child speaks for more platforms than can be behind it."""
        if self._claims is not None:
            self._claims.check_size(child, size)
