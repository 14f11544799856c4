"""One at a time: a token goes round the tree, and who gets it replies to exactly the rest of the team."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import msgspec

from vedette.errors import InputError
from vedette.negotiation.messages import Gather, Message, RoundOutcome, Stop, Tally, Token
from vedette.negotiation.node import Claims, Outgoing, Participant, slack_at
from vedette.negotiation.part import Part
from vedette.negotiation.rooted import RootedNode
from vedette.problem.bound import attains, tightest
from vedette.problem.objective import ImpactT
from vedette.problem.reach import Reach


class TokenNode(RootedNode[ImpactT]):
    """Gauss-Seidel along the Euler tour: never lowers the value, ends at an equilibrium.

    Every impact is first gathered to the root, which starts the token. A platform replies when the token
    comes down to it; all messages that point to it are then fresh, so ``others`` is exact. The token stops
    where a whole team in a row was content, or where the value reaches its ceiling. A sweep takes
    ``2 (n - 1)`` messages; gathering and stopping take ``n - 1`` each. Where a child that has the token is
    cut, this node goes on with the tally as it handed it over, less what the child's part added to it.
    Source: docs/theory.md, section 3, (V6), (V9) to (V12).
    """

    def __init__(
        self,
        neighbours: Sequence[int],
        parent: int | None,
        own: Participant[ImpactT],
        *,
        epsilon: float = 1e-9,
        max_sweeps: int = 50,
        reaches: Mapping[int, Reach] | None = None,
        claims: Claims[ImpactT] | None = None,
    ) -> None:
        """Join a round.

        Args:
            neighbours: on the tree, in the order in which the token visits them.
            parent: the neighbour towards the root, ``None`` at the root.
            own: the platform.
            epsilon: how near the ceiling is near enough, as a share of the value.
            max_sweeps: the round ends after so many.
            reaches: where the platforms behind each neighbour make a difference; without it messages hold
                everything.
            claims: what each neighbour's side may claim; without it anything.
        """
        super().__init__(own, neighbours, parent, reaches, claims)
        self.turns: list[tuple[int, float]] = []  # own: (number in the round, team value after it)
        self.size: int | None = None  # of the team, as of the last turn
        self._most = math.inf if claims is None else 1 + sum(claims.platforms[k] for k in neighbours)
        self._epsilon = epsilon
        self._max_sweeps = max_sweeps
        self._expected: int | None = None  # where the token comes from next; None: still gathering
        self._handed: Tally | None = None  # with the token, to the child that has it
        self._parts: dict[int, Part[ImpactT]] = {}  # of the children that have gathered
        self._lost: list[int] = []  # those cut that the tally still counts

    @property
    def waiting_for(self) -> frozenset[int]:
        """The children that have not gathered; after that, from where the token comes next."""
        if self.finished is not None:
            return frozenset()
        if self._expected is None:
            return frozenset(self._children).difference(self._parts, self._cut)
        return frozenset((self._expected,))

    def _hear(self, sender: int, message: Message[ImpactT]) -> list[Outgoing[ImpactT]] | None:
        match message:
            case Gather() if self._expected is None:
                return self._note_part(sender, message)
            case Token() if self._expected == sender:
                return self._take(sender, message)
            case Stop(outcome=outcome) if self._expected == sender:
                self.finished = outcome
                return [Outgoing(k, message) for k in self._links.neighbours if k != sender]
        return None

    def _go_without(self, child: int) -> list[Outgoing[ImpactT]]:
        if self._expected is None:
            self._parts.pop(child, None)
            self._links.cut(child)
            return self._gather()
        self._lost.append(child)
        if self._expected != child:
            return []  # the token will come by, or the round stop first
        assert self._handed is not None
        return self._pass_on(self._less_the_lost(self._handed), child)

    def _note_part(self, child: int, report: Gather[ImpactT]) -> list[Outgoing[ImpactT]]:
        """Hold what a child's part of the tree is and does."""
        self._check_size(child, report.size)
        self._links.receive(child, report.mu)
        nothing, mu = self._own.nothing(), self._links.held(child)
        first = (report.value, nothing, nothing, mu)
        self._parts[child] = Part(report.size, report.ceiling, report.value, nothing, [first])
        return self._gather()

    def _gather(self) -> list[Outgoing[ImpactT]]:
        """Report to the parent once all children have reported; the root starts the token."""
        if not self._started or self.waiting_for:
            return []
        parts = self._parts.values()
        size = 1 + sum(part.size for part in parts)
        ceiling = self._own.slack(self._own.nothing()) + sum(part.ceiling for part in parts)
        value = sum(part.value for part in parts) + self._interplay()
        if self._parent is not None:
            self._expected = self._parent
            return [Outgoing(self._parent, Gather(self._links.outgoing(self._parent), size, ceiling, value))]
        return self._come_in(Tally(turns=0, quiet=0, value=value, slack=0.0, size=size, ceiling=ceiling))

    def _interplay(self) -> float:
        """What own impact and children's parts of the tree are worth together, less what each part is alone.

        So values add up over the tree although messages leave out what does not interact.
        docs/theory.md (V15)
        """
        if self._own.strategy is None and len(self._parts) < 2:
            return 0.0
        parts = [self._links.held(child) for child in self._children if child in self._parts]
        together = self._team_value()
        return together - sum(self._own.value(part) for part in parts)

    @property
    def replied(self) -> bool:
        """Whether the token has been here."""
        return bool(self.turns)

    def team_held(self) -> ImpactT | None:
        """Return the impacts held together; see `Negotiator`."""
        return self._team() if self._links.heard_all else None

    def _team(self) -> ImpactT:
        return self._own.combine(self._links.others(), self._own.impact)

    def _team_value(self) -> float:
        return self._own.value(self._team())

    def _take(self, sender: int, token: Token[ImpactT]) -> list[Outgoing[ImpactT]]:
        """Take the token: from the parent to reply, from a child to hand it on."""
        if sender == self._parent:
            self._check_team(token.tally, 1 + sum(part.size for part in self._parts.values()), math.inf)
            self._links.receive(sender, token.mu)
            return self._come_in(self._less_the_lost(token.tally))
        self._note_change(sender, token)
        return self._pass_on(self._less_the_lost(token.tally), sender)

    def _note_change(self, child: int, token: Token[ImpactT]) -> None:
        """Hold what a child's part has become while it had the token."""
        part, handed, before = self._parts[child], self._handed, self._links.held(child)
        assert handed is not None
        self._check_team(token.tally, handed.size - part.size + 1, handed.size)
        self._links.receive(child, token.mu)
        part.note(handed, token.tally, before, token.mu)

    def _check_team(self, tally: Tally, least: int, most: float) -> None:
        """Raise ``InputError`` for a team without those known to be in it, or with more than there can be."""
        most = min(most, self._most)
        if not least <= tally.size <= most:
            raise InputError(f"token of a team of {tally.size}, not {least} to {most}; drop it")

    def _less_the_lost(self, tally: Tally) -> Tally:
        """Take the parts cut since the token was last here off the tally."""
        while self._lost:
            child = self._lost.pop()
            with_it = self._team_value()
            self._links.cut(child)
            tally = self._parts.pop(child).taken_off(tally, self._own, with_it - self._team_value())
        return tally

    def _come_in(self, tally: Tally) -> list[Outgoing[ImpactT]]:
        """Do what there is to do when the token comes to this part of the tree: reply."""
        return self._turn(tally)

    def _turn(self, tally: Tally) -> list[Outgoing[ImpactT]]:
        """Reply to the rest of the team (paper, eq. (30)); then stop or hand the token on."""
        others, before = self._links.others(), self._own.impact
        changed = self._own.reply(others)
        team = self._own.combine(others, self._own.impact)
        gain = 0.0
        if changed:
            self._links.changed()
            gain = self._own.value(team) - self._own.value(self._own.combine(others, before))
        slack = slack_at(self._own, team, self._own.impact)
        tally = msgspec.structs.replace(
            tally,
            turns=tally.turns + 1,
            quiet=1 if changed else tally.quiet + 1,
            value=tally.value + gain,
            slack=slack if changed else tally.slack + slack,
        )
        self.turns.append((tally.turns, tally.value))
        self.size = tally.size
        outcome = self._outcome(tally)
        return self._go_on(tally) if outcome is None else self._end(Stop(outcome), tally)

    def _end(self, stop: Stop, tally: Tally) -> list[Outgoing[ImpactT]]:
        """Tell everybody that the round is over."""
        self.finished = stop.outcome
        return [Outgoing(k, stop) for k in self._links.neighbours]

    def _go_on(self, tally: Tally) -> list[Outgoing[ImpactT]]:
        """Hand the token on after this platform's turn: to its children first."""
        return self._pass_on(tally, None)

    def _pass_on(self, tally: Tally, last: int | None) -> list[Outgoing[ImpactT]]:
        """Hand the token to the child after ``last``, if there is one."""
        position = 0 if last is None else self._children.index(last) + 1
        ahead = (child for child in self._children[position:] if child in self._parts)
        onwards = next(ahead, None)
        return self._go_out(tally) if onwards is None else self._hand(tally, onwards)

    def _go_out(self, tally: Tally) -> list[Outgoing[ImpactT]]:
        """Hand the token to the parent when all children have had it; the root begins a new sweep."""
        return self._come_in(tally) if self._parent is None else self._hand(tally, self._parent)

    def _hand(self, tally: Tally, onwards: int) -> list[Outgoing[ImpactT]]:
        """Give the token to a neighbour."""
        mu = self._links.outgoing(onwards)
        if onwards != self._parent:
            self._handed = tally
            if mu is not None:
                self._parts[onwards].told = mu
        self._expected = onwards
        return [Outgoing(onwards, Token(mu, tally))]

    def _outcome(self, tally: Tally) -> RoundOutcome | None:
        """Return how the round ends: all are content, or the value is optimal, or it took too long.

        Own turns count too: somebody may count the team's anew for ever.
        """
        content = tally.quiet >= tally.size
        everybody = tally.turns >= tally.size  # has chosen
        optimal = everybody and attains(tally.value, tally.ceiling, self._epsilon)
        long = tally.turns >= self._max_sweeps * tally.size or len(self.turns) > self._max_sweeps
        if not (content or optimal or long):
            return None
        above = tally.value + tally.slack if content else math.inf
        return RoundOutcome(
            value=tally.value,
            bound=tightest(tally.value, tally.ceiling, above),
            sweeps=-(-tally.turns // tally.size),
            converged=content or optimal,
        )
