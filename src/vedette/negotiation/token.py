"""One at a time: a token goes round the tree, and who gets it replies to exactly the rest of the team."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Generic

import msgspec

from vedette.errors import InputError
from vedette.negotiation.messages import Gather, Message, Outcome, Stop, Tally, Token
from vedette.negotiation.node import Links, Participant, Send
from vedette.problem.bound import tightest
from vedette.problem.objective import ImpactT
from vedette.problem.reach import Reach


class TokenNode(Generic[ImpactT]):
    """Gauss-Seidel along the Euler tour: never lowers the value, ends at an equilibrium.

    Every impact is first gathered to the root, which starts the token. A platform replies when the token
    comes down to it; all messages that point to it are then fresh, so ``others`` is exact. The token stops
    where a whole team in a row was content, or where the value reaches its ceiling. A sweep takes
    ``2 (n - 1)`` messages; gathering and stopping take ``n - 1`` each.
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
    ) -> None:
        """Join a round.

        Args:
            neighbours: on the tree, in the order in which the token visits them.
            parent: the neighbour towards the root, ``None`` at the root.
            own: the platform.
            epsilon: how near the ceiling is near enough, relative to the value where that exceeds 1.
            max_sweeps: the round ends after so many.
            reaches: where the platforms behind each neighbour make a difference; without it messages hold
                everything.
        """
        self.finished: Outcome | None = None
        self.turns: list[tuple[int, float]] = []  # own: (number in the round, team value after it)
        self._own = own
        self._links = Links(own, neighbours, reaches)
        self._parent = parent
        self._children = tuple(k for k in neighbours if k != parent)
        self._epsilon = epsilon
        self._max_sweeps = max_sweeps
        self._started = False
        self._expected: int | None = None  # where the token comes from next
        self._gathered: dict[int, Gather[ImpactT]] = {}

    def start(self) -> list[Send[ImpactT]]:
        """Begin, once the own impact is ready; messages may have arrived before."""
        self._started = True
        return self._gather()

    def receive(self, sender: int, message: Message[ImpactT]) -> list[Send[ImpactT]]:
        """Take in a neighbour's message; ``InputError`` if it breaks the protocol."""
        self._links.check(sender)
        if self.finished is not None:
            return []
        match message:
            case Gather(mu=mu) if sender in self._children and sender not in self._gathered:
                self._links.receive(sender, mu)
                self._gathered[sender] = message
                return self._gather()
            case Token(mu=mu, tally=tally) if sender == self._expected:
                self._links.receive(sender, mu)
                return self._turn(tally) if sender == self._parent else self._pass_on(tally, sender)
            case Stop(outcome=outcome):
                self.finished = outcome
                return [Send(k, message) for k in self._links.neighbours if k != sender]
        raise InputError(f"message {type(message).__name__} from {sender} is out of turn; drop it")

    def _gather(self) -> list[Send[ImpactT]]:
        """Report to the parent once all children have reported; the root starts the token."""
        if not self._started or len(self._gathered) < len(self._children):
            return []
        reports = self._gathered.values()
        size = 1 + sum(report.size for report in reports)
        ceiling = self._own.slack(self._own.nothing()) + sum(report.ceiling for report in reports)
        value = sum(report.value for report in reports) + self._interplay()
        if self._parent is not None:
            self._expected = self._parent
            return [Send(self._parent, Gather(self._links.outgoing(self._parent), size, ceiling, value))]
        return self._turn(Tally(turns=0, quiet=0, value=value, slack=0.0, size=size, ceiling=ceiling))

    def _interplay(self) -> float:
        """What own impact and children's parts of the tree are worth together, less what each part is alone.

        So values add up over the tree although messages leave out what does not interact.
        docs/theory.md (V15)
        """
        if self._own.strategy is None and len(self._children) < 2:
            return 0.0
        parts = [self._links.held(child) for child in self._children]
        together = self._own.value(self._own.combine(self._links.others(), self._own.impact))
        return together - sum(self._own.value(part) for part in parts)

    def _turn(self, tally: Tally) -> list[Send[ImpactT]]:
        """Reply to the rest of the team (paper, eq. (30)); then stop or hand the token on."""
        others, before = self._links.others(), self._own.impact
        changed = self._own.reply(others)
        team = self._own.combine(others, self._own.impact)
        gain = 0.0
        if changed:
            self._links.changed()
            gain = self._own.value(team) - self._own.value(self._own.combine(others, before))
        slack = self._own.slack(team)
        tally = msgspec.structs.replace(
            tally,
            turns=tally.turns + 1,
            quiet=1 if changed else tally.quiet + 1,
            value=tally.value + gain,
            slack=slack if changed else tally.slack + slack,
        )
        self.turns.append((tally.turns, tally.value))
        self.finished = self._outcome(tally)
        if self.finished is None:
            return self._pass_on(tally, None)
        return [Send(k, Stop(self.finished)) for k in self._links.neighbours]

    def _pass_on(self, tally: Tally, last: int | None) -> list[Send[ImpactT]]:
        """Hand the token to the child after ``last``, else to the parent; the root begins a new sweep."""
        position = 0 if last is None else self._children.index(last) + 1
        onwards = self._children[position] if position < len(self._children) else self._parent
        if onwards is None:
            return self._turn(tally)
        self._expected = onwards
        return [Send(onwards, Token(self._links.outgoing(onwards), tally))]

    def _outcome(self, tally: Tally) -> Outcome | None:
        """Return how the round ends: all are content, or the value is optimal, or it took too long."""
        content = tally.quiet >= tally.size
        near = tally.value >= tally.ceiling - self._epsilon * max(1.0, abs(tally.value))
        optimal = near and tally.turns >= tally.size  # everybody has chosen
        if not (content or optimal or tally.turns >= self._max_sweeps * tally.size):
            return None
        above = tally.value + tally.slack if content else math.inf
        return Outcome(
            value=tally.value,
            bound=tightest(tally.value, tally.ceiling, above),
            sweeps=-(-tally.turns // tally.size),
            converged=content or optimal,
        )
