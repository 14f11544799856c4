"""Twice from the same beginning, in opposite orders: the better of two rounds of the token."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import Generic

from vedette.negotiation.messages import Message, RoundOutcome, Stop, Tally
from vedette.negotiation.node import Claims, Outgoing, Participant
from vedette.negotiation.token import TokenNode
from vedette.problem.bound import attains, tightest
from vedette.problem.objective import ImpactT
from vedette.problem.reach import Reach

FIRST = 0  # iterate that everybody takes up again, where that was better


class BackwardNode(TokenNode[ImpactT]):
    """A token that goes round as `TokenNode`'s, but whom it passes replies when all its children have.

    With the children in reverse, that is the opposite order. It ends by the better of its own outcome and
    that of the round before, if the same platforms are in both.
    """

    before: RoundOutcome | None = None  # the first round's
    size_before: int | None = None  # platforms in it, as this one last heard
    first_is_better = False

    def _come_in(self, tally: Tally) -> list[Outgoing[ImpactT]]:
        return self._pass_on(tally, None)

    def _go_out(self, tally: Tally) -> list[Outgoing[ImpactT]]:
        return self._turn(tally)

    def _go_on(self, tally: Tally) -> list[Outgoing[ImpactT]]:
        return self._come_in(tally) if self._parent is None else self._hand(tally, self._parent)

    def _hear(self, sender: int, message: Message[ImpactT]) -> list[Outgoing[ImpactT]] | None:
        self.first_is_better = isinstance(message, Stop) and message.iterate == FIRST
        return super()._hear(sender, message)

    def _end(self, stop: Stop, tally: Tally) -> list[Outgoing[ImpactT]]:
        """Tell everybody which choice it is; the first one counts whoever has been cut since."""
        first, second = self.before, stop.outcome
        assert first is not None
        sweeps = first.sweeps + second.sweeps
        if tally.size != self.size_before:
            return super()._end(Stop(_with(second, second.bound, sweeps)), tally)
        self.first_is_better = first.value > second.value
        better = first if self.first_is_better else second
        bounds = [bound for bound in (first.bound, second.bound) if bound is not None]
        bound = tightest(better.value, *bounds) if bounds else None
        return super()._end(
            Stop(_with(better, bound, sweeps), FIRST if self.first_is_better else None), tally
        )


def _with(outcome: RoundOutcome, bound: float | None, sweeps: int) -> RoundOutcome:
    return RoundOutcome(outcome.value, bound, sweeps, outcome.converged)


class MultistartNode(Generic[ImpactT]):
    """A `Negotiator` of two rounds of the token: as it goes, and backwards from the same strategies.

    Everybody then has its strategy of the better one. Each round keeps all that the token promises, so this
    does too, and it is never worse than the token, at twice the messages. Where the first has attained its
    bound there is no second.  docs/theory.md, section 13
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
        """Join a round; arguments as `TokenNode`, ``max_sweeps`` for each of both."""
        self._own, self._epsilon = own, epsilon
        self._join: Callable[[type[TokenNode[ImpactT]], Sequence[int]], TokenNode[ImpactT]] = (
            lambda kind, links: kind(
                links, parent, own, epsilon=epsilon, max_sweeps=max_sweeps, reaches=reaches, claims=claims
            )
        )
        self._neighbours = tuple(neighbours)
        self._begun: Hashable = own.strategy
        self._found: Hashable = None  # in the first round
        self._gone: set[int] = set()  # cut
        self.rounds = [self._join(TokenNode, neighbours)]
        self.finished: RoundOutcome | None = None

    @property
    def waiting_for(self) -> frozenset[int]:
        """Neighbours without whose next message nothing goes on here; none once both rounds are over."""
        return self.rounds[-1].waiting_for

    @property
    def replied(self) -> bool:
        """Whether the token has been here."""
        return self.rounds[0].replied

    @property
    def goes_back(self) -> bool:
        """Whether the first round was better than the second."""
        last = self.rounds[-1]
        return isinstance(last, BackwardNode) and last.first_is_better

    def team_held(self) -> ImpactT | None:
        """Return the impacts held together; see `Negotiator`."""
        last = self.rounds[-1]
        return (
            self.rounds[0] if isinstance(last, BackwardNode) and last.first_is_better else last
        ).team_held()

    def start(self) -> list[Outgoing[ImpactT]]:
        """Begin, once the own impact is ready; messages may have arrived before."""
        return self._onwards(self.rounds[-1].start())

    def receive(self, sender: int, message: Message[ImpactT]) -> list[Outgoing[ImpactT]]:
        """Take in a neighbour's message; ``InputError`` if it breaks the protocol."""
        if sender in self._gone:
            return []
        return self._onwards(self.rounds[-1].receive(sender, message))

    def cut(self, neighbour: int) -> list[Outgoing[ImpactT]]:
        """Go on without a child and all behind it; see `Negotiator`."""
        if neighbour in self._gone:
            return []
        answer = self.rounds[-1].cut(neighbour)
        self._gone.add(neighbour)
        return self._onwards(answer)

    def _onwards(self, sent: list[Outgoing[ImpactT]]) -> list[Outgoing[ImpactT]]:
        """Begin the second round when the first is over, and end with it.

        Links keep order: whoever says something of the second round has told of the first one's end before.
        """
        last = self.rounds[-1]
        if self.finished is not None or last.finished is None:
            return sent
        if isinstance(last, BackwardNode):
            if last.first_is_better:
                self._own.adopt(self._found)
            self.finished = last.finished
            return sent
        outcome = last.finished
        if outcome.bound is not None and attains(outcome.value, outcome.bound, self._epsilon):
            self.finished = outcome
            return sent
        self._found = self._own.strategy
        self._own.adopt(self._begun)
        second = self._join(BackwardNode, [k for k in self._neighbours[::-1] if k not in self._gone])
        assert isinstance(second, BackwardNode)
        second.before, second.size_before = outcome, last.size
        self.rounds.append(second)
        return self._onwards([*sent, *second.start()])
