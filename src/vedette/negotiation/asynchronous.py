"""Whenever news comes: nobody waits for anybody, and a change is confirmed before it counts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Generic

import msgspec

from vedette.errors import InputError
from vedette.negotiation.branch import Branch, value_alone
from vedette.negotiation.messages import Message, Offer, RoundOutcome, Settled, Tidings
from vedette.negotiation.node import Claims, Outgoing, Participant, slack_at
from vedette.negotiation.offers import Child, Pending
from vedette.problem.bound import tightest
from vedette.problem.objective import ImpactT
from vedette.problem.reach import Reach

MOST_SAID = 4  # offers, or news, for every change that there can be


class AsyncNode(Generic[ImpactT]):
    """Replies as soon as news come; changes travel to the root as offers, and count when they are taken.

    An offer says what a part of the tree would become. Whoever gets it prices it against all that it knows
    to count by now, whatever it was priced against before, and refuses it if it would lower the team's value;
    the root knows all, so what it takes raises the value. Offers that meet on their way are passed on
    together. On each link one offer and one piece of news are under way at most: nobody lags more than one
    message a hop behind, and nobody waits for others than those concerned. Without ``guard`` changes count at
    once and are told as facts, which others may have answered before they hear of them.
    Source: docs/theory.md (V105).
    """

    def __init__(
        self,
        neighbours: Sequence[int],
        parent: int | None,
        own: Participant[ImpactT],
        *,
        max_sweeps: int = 50,
        reaches: Mapping[int, Reach] | None = None,
        claims: Claims[ImpactT] | None = None,
        guard: bool = True,
    ) -> None:
        """Join; arguments as `TokenNode`, a platform changing ``max_sweeps`` times at most."""
        self.finished: RoundOutcome | None = None
        self.values: list[float] = []  # at the root: after each change that counts, the team as it is by now
        self._size = 0  # of that team
        self._own = own
        self._neighbours = tuple(neighbours)
        self._parent = parent
        self._children = {k: Child[ImpactT]() for k in neighbours if k != parent}
        self._max_changes = max_sweeps
        self._reaches = reaches or {}
        self._claims = claims
        self._guard = guard
        self._present = own.strategy, own.impact  # as they count
        self._beyond = own.nothing()  # all behind the parent
        self._started = False
        self._fact = True  # there is something to tell that is so already: that this platform is here
        self._ask = True  # something has changed since the last reply
        self._slack = math.inf
        self._changes = 0  # of the own strategy, offered
        self._capped = False  # it would have changed more often
        self._pending: Pending[ImpactT] | None = None
        self._serial = 0  # of the last offer
        self._heard = 0  # of the last news
        self._owes = False  # an answer to the last news
        self._said_quiet = False
        self._lost: set[int] = set()
        self._leaving: set[int] = set()  # of those: the rest of the team counts them still

    @property
    def waiting_for(self) -> frozenset[int]:
        """Children that have not said that all is well with the last news; if there are none, the parent."""
        if self.finished is not None:
            return frozenset()
        offered = self._pending.offers if self._pending is not None else {}
        owing = [
            k
            for k, child in self._children.items()
            if child.branch is None
            or child.heard < child.told
            or not (child.quiet or child.due or k in offered)
        ]
        return frozenset(owing or (() if self._parent is None else (self._parent,)))

    @property
    def replied(self) -> bool:
        """Whether this platform has replied."""
        return self._slack < math.inf or self._changes > 0

    @property
    def goes_back(self) -> bool:
        """Never: who changes its mind says so."""
        return False

    def team_held(self) -> ImpactT:
        """Return the impacts held together; see `Negotiator`."""
        return self._together(self._branches().values(), self._own.impact)

    def start(self) -> list[Outgoing[ImpactT]]:
        """Begin, once the own impact is ready; messages may have arrived before."""
        self._started = True
        return self._go_on()

    def receive(self, sender: int, message: Message[ImpactT]) -> list[Outgoing[ImpactT]]:
        """Take in a neighbour's message; ``ValueError`` if it breaks the protocol or claims too much."""
        if sender not in self._neighbours:
            raise InputError(f"negotiation message from {sender}, who is not a neighbour; drop it")
        if self.finished is not None or sender in self._lost:
            return []
        match message:
            case Offer() if sender in self._children:
                self._hear_offer(sender, message)
            case Tidings() if sender == self._parent:
                self._hear_news(sender, message)
            case Settled() if sender == self._parent:
                return self._settle(message.outcome)
            case _:
                raise InputError(f"message {type(message).__name__} from {sender} is out of turn; drop it")
        return self._go_on()

    def cut(self, neighbour: int) -> list[Outgoing[ImpactT]]:
        """Go on without a child and all behind it; see `Negotiator`."""
        if neighbour not in self._neighbours:
            raise InputError(f"negotiation message from {neighbour}, who is not a neighbour; drop it")
        if neighbour == self._parent:
            raise InputError(f"{neighbour} is the parent, who cannot be cut; give the round up")
        if self.finished is not None or neighbour in self._lost:
            return []
        self._lost.add(neighbour)
        self._leaving.add(neighbour)
        del self._children[neighbour]
        if self._pending is not None:
            self._pending.offers.pop(neighbour, None)
        self._fact = self._ask = True
        self._tell_all()
        return self._go_on()

    # -- what is heard --------------------------------------------------------------------------------------

    def _hear_offer(self, sender: int, offer: Offer[ImpactT]) -> None:
        """Note a child's offer, or that it has heard the last news."""
        child = self._children[sender]
        if offer.heard > child.told or (offer.mu is not None and offer.serial <= child.answered):
            raise InputError(f"message Offer from {sender} is out of turn; drop it")
        if self._claims is not None:
            self._claims.check_size(sender, offer.size)
            if offer.mu is not None:
                self._claims.admit(offer.mu, self._claims.platforms[sender])
                child.offers += 1
                self._check_length(sender, child.offers, self._claims.platforms[sender])
        child.heard, child.slack = offer.heard, offer.slack
        child.changes, child.capped = offer.changes, offer.capped
        child.quiet = offer.quiet and offer.mu is None and offer.heard == child.told and not child.due
        if offer.mu is not None:
            child.offer = offer

    def _hear_news(self, sender: int, news: Tidings[ImpactT]) -> None:
        """Note what the rest of the team is by now, and whether the last offer was taken."""
        if news.serial != self._heard + 1:
            raise InputError(f"message Tidings from {sender} is out of turn; drop it")
        if self._claims is not None:
            self._claims.admit(news.mu, self._claims.platforms[sender])
            self._check_length(sender, news.serial, 1 + sum(self._claims.platforms.values()))
        self._beyond, self._heard = news.mu, news.serial
        self._owes, self._said_quiet, self._ask = True, False, True
        self._tell_all()
        pending = self._pending
        if pending is None or news.answered != self._serial:
            return
        self._pending = None
        if news.taken:
            self._count(pending)
            return
        for k, offer in pending.offers.items():
            self._children[k].answer(offer.serial, taken=False)
        if pending.own:
            self._own.adopt(self._present[0])

    def _check_length(self, sender: int, said: int, platforms: int) -> None:
        """Raise ``InputError`` if somebody goes on and on: each change is offered, and answered, once."""
        if said > MOST_SAID * (self._max_changes + 2) * platforms:
            raise InputError(f"{sender} has changed the team {said} times, and does not end; drop it")

    def _tell_all(self) -> None:
        """Note that there are news for all children."""
        for child in self._children.values():
            child.due, child.quiet = True, False

    # -- what is done ---------------------------------------------------------------------------------------

    def _go_on(self) -> list[Outgoing[ImpactT]]:
        """Reply, pass offers on or let them count, and tell whom it concerns."""
        if not self._started:
            return []
        sends: list[Outgoing[ImpactT]] = []
        while self._pending is None and (pending := self._next()) is not None:
            if self._parent is None:
                self._count(pending)
                self._note_value()
            else:
                self._pending = pending
                sends.append(self._offer(self._parent, pending))
        for k, child in self._children.items():
            if child.branch is not None and child.due and (child.urgent or child.heard == child.told):
                child.told, child.due, child.urgent = child.told + 1, False, False
                sends.append(Outgoing(k, Tidings(self._for(k), child.told, child.answered, child.taken)))
        return sends + self._rest()

    def _note_value(self) -> None:
        branches = self._branches()
        size = 1 + sum(branch.size for branch in branches.values())
        if size != self._size:
            self._size, self.values = size, []
        self.values.append(self._value(self._present[1], branches))

    def _next(self) -> Pending[ImpactT] | None:
        """Return the changes to offer now, each priced with those before it; None if there are none.

        Facts go first and alone: what is not to be refused must not carry with it what may be.
        """
        if not self._fact:
            self._reply()
        own = self._own.strategy != self._present[0]
        first = own and self._present[0] is None
        fact = (
            self._fact or first or any(c.offer is not None and c.offer.fact for c in self._children.values())
        )
        pending: Pending[ImpactT] = Pending(own and (first or not fact), fact)
        pending.branches, pending.gone = self._branches(), frozenset(self._leaving)
        for k, child in self._children.items():
            if child.offer is not None and child.offer.fact == fact:
                self._add(pending, k, child, child.offer)
        self._fact = False
        return pending if pending.own or fact or pending.offers else None

    def _add(self, pending: Pending[ImpactT], k: int, child: Child[ImpactT], offer: Offer[ImpactT]) -> None:
        """Take a child's offer among those to pass on, or refuse it."""
        child.offer = None
        old = pending.branches.pop(k, Branch.of(self._own, self._own.nothing(), 0, 0.0, 0.0))
        impact = self._own.impact if pending.own else self._present[1]
        new, rest = old.after(self._own, offer), self._together(pending.branches.values(), impact)
        if offer.fact or old.is_raised_by(new, rest, self._own):
            pending.offers[k], pending.branches[k] = offer, new
        else:
            pending.branches[k] = old
            child.answer(offer.serial, taken=False)

    def _reply(self) -> None:
        """Reply to the rest of the team as it counts by now (paper, eq. (30)), if anything has changed."""
        if not self._ask:
            return
        self._ask = False
        others = self._together(self._branches().values())
        if self._changes == self._max_changes:
            self._capped = True
        elif self._own.reply(others):
            self._changes += 1
            if not self._guard:
                self._present, self._fact = (self._own.strategy, self._own.impact), True
        self._slack = slack_at(self._own, self._own.combine(others, self._own.impact), self._own.impact)

    def _count(self, pending: Pending[ImpactT]) -> None:
        """Let changes count: they are told to all whom they concern."""
        self._tell_all()
        self._ask |= bool(pending.offers)
        self._leaving -= pending.gone
        if pending.own:
            self._present = self._own.strategy, self._own.impact
        for k, offer in pending.offers.items():
            self._children[k].branch = pending.branches[k]
            self._children[k].answer(offer.serial, taken=True)

    def _offer(self, parent: int, pending: Pending[ImpactT]) -> Outgoing[ImpactT]:
        """Return the offer of what this part of the tree would become."""
        self._serial += 1
        impact = self._own.impact if pending.own else self._present[1]
        mu = self._clipped(parent, self._together(pending.branches.values(), impact, beyond=False))
        offer = self._report(pending.branches, mu, impact)
        return Outgoing(parent, msgspec.structs.replace(offer, fact=pending.fact))

    def _rest(self) -> list[Outgoing[ImpactT]]:
        """Answer the last news, or say that all is well; at the root that ends the negotiation."""
        if self._parent is None:
            return self._settle(self._outcome()) if self._is_quiet else []
        if not (self._owes or (self._is_quiet and not self._said_quiet)):
            return []
        self._said_quiet = self._is_quiet
        self._owes = False
        return [Outgoing(self._parent, self._report(self._branches(), None, self._present[1]))]

    @property
    def _is_quiet(self) -> bool:
        """Whether nobody from here on away from the root has anything to offer."""
        children = self._children.values()
        return not (self._ask or self._fact or self._pending is not None) and all(
            child.quiet and child.offer is None for child in children
        )

    def _report(
        self, branches: Mapping[int, Branch[ImpactT]], mu: ImpactT | None, impact: ImpactT
    ) -> Offer[ImpactT]:
        children = self._children.values()
        self._owes = False
        return Offer(
            mu=mu,
            serial=self._serial,
            heard=self._heard,
            quiet=mu is None and self._is_quiet,
            fact=False,
            value=self._value(impact, branches),
            slack=self._slack + sum(child.slack for child in children),
            size=1 + sum(branch.size for branch in branches.values()),
            ceiling=self._ceiling(branches),
            changes=max([self._changes, *(child.changes for child in children)]),
            capped=self._capped or any(child.capped for child in children),
        )

    def _outcome(self) -> RoundOutcome:
        """Return what the team has come to: nobody has anything to offer."""
        last = self._report(self._branches(), None, self._present[1])
        above = last.value + last.slack if not last.capped else math.inf
        bound = tightest(last.value, last.ceiling, above)
        return RoundOutcome(last.value, bound, last.changes, not last.capped)

    def _settle(self, outcome: RoundOutcome) -> list[Outgoing[ImpactT]]:
        self.finished = outcome
        if self._own.strategy != self._present[0]:
            self._own.adopt(self._present[0])
        return [
            Outgoing(k, Settled(outcome, keep=True, quiet=True)) for k in (*self._children, *self._leaving)
        ]

    # -- what is held ---------------------------------------------------------------------------------------

    def _branches(self) -> dict[int, Branch[ImpactT]]:
        """Return the children's parts, as they count."""
        return {k: child.branch for k, child in self._children.items() if child.branch is not None}

    def _together(
        self, branches: Iterable[Branch[ImpactT]], impact: ImpactT | None = None, *, beyond: bool = True
    ) -> ImpactT:
        """Return some branches combined, with an impact of the own and all beyond the parent."""
        together = self._beyond if beyond else self._own.nothing()
        for mu in (*(() if impact is None else (impact,)), *(branch.mu for branch in branches)):
            together = self._own.combine(together, mu)
        return together

    def _for(self, child: int) -> ImpactT:
        """Return what a child is told of the rest of the team."""
        others = [branch for k, branch in self._branches().items() if k != child]
        return self._clipped(child, self._together(others, self._present[1]))

    def _clipped(self, neighbour: int, mu: ImpactT) -> ImpactT:
        reach = self._reaches.get(neighbour)
        return mu if reach is None else self._own.clip(mu, reach)

    def _value(self, impact: ImpactT, branches: Mapping[int, Branch[ImpactT]]) -> float:
        """Return what this part of the tree is worth by itself; docs/theory.md (V15)."""
        together = self._together(branches.values(), impact, beyond=False)
        return value_alone(self._own, together, branches.values())

    def _ceiling(self, branches: Mapping[int, Branch[ImpactT]]) -> float:
        own = self._own.slack(self._own.nothing())
        return own + sum(branch.ceiling for branch in branches.values())
