"""One platform's part in a round: what it brings, what it holds, what it sends."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol

from vedette.errors import InputError
from vedette.negotiation.fold import Fold
from vedette.negotiation.messages import Message, RoundOutcome
from vedette.number import many
from vedette.problem.objective import ImpactT
from vedette.problem.reach import Reach


class Participant(Protocol[ImpactT]):
    """A platform in a round: its strategy, what it achieves, and the team's objective on a frozen belief."""

    @property
    def impact(self) -> ImpactT:
        """Own impact of the present strategy; only ``reply`` and ``adopt`` change it."""

    @property
    def strategy(self) -> Hashable:
        """Present strategy, ``None`` while there is none; equal strategies have equal impacts."""

    def adopt(self, strategy: Hashable) -> None:
        """Take up a strategy that this participant had before in this round."""

    def reply(self, others: ImpactT) -> bool:
        """Take up the best strategy against the rest of the team if it is strictly better; tell if so."""

    def nothing(self) -> ImpactT:
        """Identity of ``*``."""

    def combine(self, a: ImpactT, b: ImpactT) -> ImpactT:
        """``a * b``."""

    def value(self, team: ImpactT) -> float:
        """``psi(team)``."""

    def price(self, impact: ImpactT) -> float:
        """Return what of an impact's value is a price, taken off: to be added again for a bound; (V193)."""

    def slack(self, base: ImpactT) -> float:
        """Most that any strategy of this platform would add to ``base``; infinite where not known."""

    def clip(self, impact: ImpactT, reach: Reach) -> ImpactT:
        """Return what of an impact can matter to platforms that make a difference only within ``reach``."""


def slack_at(own: Participant[ImpactT], team: ImpactT, impact: ImpactT) -> float:
    """Return what a platform adds to the bound at a team in which it has an impact: slack, and price again.

    docs/theory.md (V193)
    """
    return own.slack(team) + own.price(impact)


@dataclass(frozen=True, eq=False)
class Outgoing(Generic[ImpactT]):
    """A message for a neighbour."""

    to: int
    message: Message[ImpactT]


@dataclass(frozen=True, eq=False)
class Claims(Generic[ImpactT]):
    """What a neighbour's side of the tree may claim: no more than so many platforms can achieve."""

    platforms: Mapping[int, int]  # at most so many behind each neighbour
    admit: Callable[[ImpactT, int], None]  # ValueError if so many platforms cannot have such an impact

    def check_size(self, sender: int, size: int) -> None:
        """Raise ``InputError`` if a neighbour speaks for more platforms than can be behind it."""
        if size > self.platforms[sender]:
            most = self.platforms[sender]
            raise InputError(
                f"{sender} speaks for {many(size, 'platform')}, at most {most} behind it; drop it"
            )


class Negotiator(Protocol[ImpactT]):
    """One platform's protocol in one round: no clock, no network; links are reliable and in order.

    A child that does not answer in time can be cut from the round. The parent cannot: without it a round has
    no end that everybody hears of, and is given up.
    """

    @property
    def finished(self) -> RoundOutcome | None:
        """How the round ended, ``None`` while it lasts."""

    @property
    def waiting_for(self) -> frozenset[int]:
        """Neighbours without whose next message nothing goes on here; none once the round is over."""

    @property
    def replied(self) -> bool:
        """Whether this platform has had its say in the round."""

    @property
    def goes_back(self) -> bool:
        """Whether the round has ended by strategies of earlier: what was told last is of others."""

    def team_held(self) -> ImpactT | None:
        """Return the impacts held together, own one included; None: they are not all here.

        At the end of a round whose messages are whole it is worth the outcome's value, whatever that says.
        """

    def cut(self, neighbour: int) -> list[Outgoing[ImpactT]]:
        """Go on without a child and all behind it: they count as nothing, what the child says is void.

        For a child that is waited for it holds at once, for another when this platform's turn comes. A round
        that stops before that still counts the child in, and stops for it too.

        Raises:
            InputError: not a neighbour, or the parent.
        """

    def start(self) -> list[Outgoing[ImpactT]]:
        """Begin, once the own impact is ready; messages may have arrived before."""

    def receive(self, sender: int, message: Message[ImpactT]) -> list[Outgoing[ImpactT]]:
        """Take in a neighbour's message; ``InputError`` if it breaks the protocol."""


class TreeLinks(Generic[ImpactT]):
    """``mu_{i->j} = Y_i * (* of mu_{k->i}, k in N(i) without j)``: one platform's end of its links.

    A mu is sent only if something that it is made of has changed since it was last sent, and only what of it
    can matter beyond that link, if the reach of the platforms there is known.
    Source: docs/theory.md (V5), (V6), (V14).
    """

    def __init__(
        self,
        own: Participant[ImpactT],
        neighbours: Sequence[int],
        reaches: Mapping[int, Reach] | None = None,
        claims: Claims[ImpactT] | None = None,
    ) -> None:
        """Hold nothing yet; ``reaches`` gives the joint reach of the platforms behind each neighbour."""
        self.neighbours = tuple(neighbours)
        self._claims = claims
        self._reaches = reaches or {}
        self._own = own
        self._place = {k: place for place, k in enumerate(self.neighbours)}
        self._held = Fold(len(self.neighbours), own.combine)  # the last mu from each neighbour
        self._rests = dict[int | None, ImpactT]()  # all but a neighbour's, since the last change
        self._stale = set(neighbours)  # those that have yet to hear of a change

    def check(self, sender: int) -> None:
        """Raise ``InputError`` if the sender is not a neighbour."""
        if sender not in self._place:
            raise InputError(f"negotiation message from {sender}, who is not a neighbour; drop it")

    def check_child(self, neighbour: int, parent: int | None) -> None:
        """Raise ``InputError`` if a neighbour cannot be cut from the round."""
        self.check(neighbour)
        if neighbour == parent:
            raise InputError(f"{neighbour} is the parent, who cannot be cut; give the round up")

    def receive(self, sender: int, mu: ImpactT | None) -> None:
        """Hold a neighbour's mu; ``None`` keeps the one held. ``ValueError`` if it claims too much."""
        self.admit(sender, mu)
        if mu is not None:
            self.hold(sender, mu)

    def admit(self, sender: int, mu: ImpactT | None) -> None:
        """Raise ``ValueError`` for a mu that claims too much, or for none where none is held."""
        if mu is not None:
            if self._claims is not None:
                self._claims.admit(mu, self._claims.platforms[sender])
        elif self._held[self._place[sender]] is None:
            raise InputError(f"negotiation message from {sender} refers to an impact never sent; drop it")

    def hold(self, sender: int, mu: ImpactT) -> None:
        """Hold a mu that has been admitted."""
        self._held.put(self._place[sender], mu)
        self._rests.clear()
        self._stale.update(k for k in self.neighbours if k != sender)

    def cut(self, neighbour: int) -> None:
        """Hold nothing of a neighbour, and count it as one no more."""
        self.neighbours = tuple(k for k in self.neighbours if k != neighbour)
        self._held.put(self._place[neighbour], self._own.nothing())
        self._rests.clear()
        self._stale.discard(neighbour)
        self._stale.update(self.neighbours)

    def held(self, sender: int) -> ImpactT:
        """Return the last mu from a neighbour that has sent one."""
        mu = self._held[self._place[sender]]
        assert mu is not None
        return mu

    def changed(self) -> None:
        """Note that the own impact has changed."""
        self._rests.clear()
        self._stale.update(self.neighbours)

    def outgoing(self, receiver: int) -> ImpactT | None:
        """Return ``mu_{i->receiver}``, or ``None`` if the receiver holds it already."""
        if receiver not in self._stale:
            return None
        self._stale.remove(receiver)
        mu, reach = self.all_but(receiver), self._reaches.get(receiver)
        return mu if reach is None else self._own.clip(mu, reach)

    def all_but(self, neighbour: int | None) -> ImpactT:
        """Return what is held of everybody not behind a neighbour, the own impact included; None: of all."""
        if neighbour not in self._rests:
            held, own = self._held, self._own
            rest = held.total if neighbour is None else held.without(self._place[neighbour])
            self._rests[neighbour] = own.impact if rest is None else own.combine(own.impact, rest)
        return self._rests[neighbour]

    @property
    def heard_all(self) -> bool:
        """Whether every neighbour has sent a mu."""
        return all(self._held[self._place[k]] is not None for k in self.neighbours)

    def others(self) -> ImpactT:
        """Return the rest of the team, ``* of mu_{k->i}`` over all neighbours: exact if all are fresh."""
        total = self._held.total
        return self._own.nothing() if total is None else total
