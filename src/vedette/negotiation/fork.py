"""A token that forks: all parts of the tree reply at once, and what does not go together is taken back."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence

from vedette.errors import InputError
from vedette.negotiation.branch import Branch, value_alone
from vedette.negotiation.messages import Fork, Gather, Joined, Message, RoundOutcome, Settled
from vedette.negotiation.node import Claims, Outgoing, Participant, slack_at
from vedette.negotiation.rooted import RootedNode
from vedette.problem.bound import attains, tightest
from vedette.problem.objective import ImpactT
from vedette.problem.reach import Reach


class ForkNode(RootedNode[ImpactT]):
    """Sweeps down all branches at once and back: ``2 depth`` hops, whatever the size of the team.

    A platform replies to what it is told, then hands the right to choose to all its children together. When
    they have joined, it takes their changes one child after the other, each priced anew against those taken
    before, and refuses what would lower the team's value: that part goes back, with the next sweep, to what
    it was. Parts whose impacts do not overlap are never refused, and then it is the token's sweep. A sweep
    never lowers the value but by first choices, and one in which nobody moved is an equilibrium.
    Source: docs/theory.md (V105).
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
        """Join a round; arguments as `TokenNode`."""
        super().__init__(own, neighbours, parent, reaches, claims)
        self.values: list[float] = []  # at the root: the team's value after each sweep
        self.sweeps = 0
        self._epsilon = epsilon
        self._max_sweeps = max_sweeps
        self._gathered = self._forked = False
        self._quiet = False  # the round ended with nobody moving
        self._branches: dict[int, Branch[ImpactT]] = {}
        self._before: tuple[Hashable, dict[int, Branch[ImpactT]]] = (own.strategy, {})  # this sweep
        self._joined: dict[int, Joined[ImpactT]] = {}
        self._refused: set[int] = set()  # children that are to go back to what they were
        self._moved = self._first = False  # this platform, in this sweep
        self._fewer = 0  # children lost in this sweep, in which others have still counted on them
        self._slack = math.inf  # own, in this sweep
        self._lost: list[int] = []  # cut, but still counted above

    @property
    def waiting_for(self) -> frozenset[int]:
        """The children that have not gathered, or not joined; or the parent, for the next sweep."""
        if self.finished is not None:
            return frozenset()
        if not self._gathered:
            return frozenset(self._children).difference(self._branches)
        if self._forked:
            return frozenset(self._children).difference(self._joined, self._cut)
        return frozenset(() if self._parent is None else (self._parent,))

    def _hear(self, sender: int, message: Message[ImpactT]) -> list[Outgoing[ImpactT]] | None:
        match message:
            case Gather() if not self._gathered:
                return self._note_branch(sender, message)
            case Joined() if self._forked:
                return self._note_joined(sender, message)
            case Fork() if sender == self._parent and self._gathered:
                self._check_length(self.sweeps, self._max_sweeps)
                self._links.receive(sender, message.mu)
                return self._sweep(keep=message.keep)
            case Settled() if sender == self._parent and self._gathered:
                return self._settle(message)
        return None

    @property
    def replied(self) -> bool:
        """Whether a sweep has come by."""
        return self.sweeps > 0

    def team_held(self) -> ImpactT | None:
        """Return the impacts held together; see `Negotiator`."""
        if not self._links.heard_all or (self.finished is not None and not self._quiet):
            return None
        return self._own.combine(self._links.others(), self._own.impact)

    def _go_without(self, child: int) -> list[Outgoing[ImpactT]]:
        if self._gathered and not self._forked:
            self._lost.append(child)
            return []  # the next sweep will come by, or the round end first
        self._drop(child)
        if not self._forked:
            return self._gather()
        self._fewer += 1
        return self._join()

    def _drop(self, child: int) -> None:
        self._children.remove(child)
        self._branches.pop(child, None)
        self._joined.pop(child, None)
        self._links.cut(child)

    # -- gathering ----------------------------------------------------------------------------------------

    def _note_branch(self, child: int, report: Gather[ImpactT]) -> list[Outgoing[ImpactT]]:
        """Hold what a child's part of the tree is and does."""
        self._check_size(child, report.size)
        self._links.receive(child, report.mu)
        self._branches[child] = Branch.of(
            self._own, self._links.held(child), report.size, report.ceiling, report.value
        )
        return self._gather()

    def _gather(self) -> list[Outgoing[ImpactT]]:
        """Report to the parent once all children have reported; the root begins the first sweep."""
        if not self._started or self.waiting_for:
            return []
        self._gathered = True
        if self._parent is None:
            return self._sweep(keep=True)
        mu = self._links.outgoing(self._parent)
        return [Outgoing(self._parent, Gather(mu, self._size(), self._ceiling(), self._value()))]

    def _size(self) -> int:
        return 1 + sum(branch.size for branch in self._branches.values())

    def _ceiling(self) -> float:
        own = self._own.slack(self._own.nothing())
        return own + sum(branch.ceiling for branch in self._branches.values())

    def _value(self) -> float:
        """Return what this part of the tree is worth by itself; docs/theory.md (V15)."""
        return value_alone(self._own, self._links.all_but(self._parent), self._branches.values())

    # -- sweeping -----------------------------------------------------------------------------------------

    def _sweep(self, *, keep: bool) -> list[Outgoing[ImpactT]]:
        """Reply to the rest of the team as told (paper, eq. (30)); then let all children do so at once."""
        if not keep:
            self._go_back()
        self._fewer = len(self._lost)
        while self._lost:
            self._drop(self._lost.pop())
        self.sweeps += 1
        self._before = self._own.strategy, dict(self._branches)
        self._first = self._own.strategy is None
        others = self._links.others()
        self._moved = self._own.reply(others)
        if self._moved:
            self._links.changed()
        self._slack = math.inf  # counts only if nobody moves
        if not self._moved:
            self._slack = slack_at(self._own, self._own.combine(others, self._own.impact), self._own.impact)
        self._forked = True
        onwards = [
            Outgoing(child, Fork(self._links.outgoing(child), child not in self._refused))
            for child in self._children
        ]
        self._refused.clear()
        return onwards + self._join()

    def _go_back(self) -> None:
        """Be as before the last sweep, and let all children be so."""
        strategy, branches = self._before
        self._own.adopt(strategy)
        self._links.changed()
        for child in self._children:
            self._branches[child] = branches[child]
            self._links.hold(child, branches[child].mu)
        self._refused.update(self._children)

    def _note_joined(self, child: int, joined: Joined[ImpactT]) -> list[Outgoing[ImpactT]]:
        """Note what a child's part has become; nothing is taken until all have joined."""
        self._check_size(child, joined.size)
        if joined.size > self._branches[child].size:
            raise InputError(f"{child} joins with more platforms than it had; drop it")
        if joined.moved > self._branches[child].size:
            raise InputError(f"{child} says that more platforms have moved than it had; drop it")
        self._links.admit(child, joined.mu)
        self._joined[child] = joined
        return self._join()

    def _join(self) -> list[Outgoing[ImpactT]]:
        """Once all children have joined, take or refuse their changes, and tell the parent."""
        if self.waiting_for:
            return []
        self._forked = False
        for child, joined in self._joined.items():
            self._take(child, joined)
        reports = self._joined.values()
        summary: Joined[ImpactT] = Joined(
            mu=None if self._parent is None else self._links.outgoing(self._parent),
            value=self._value(),
            slack=self._slack + sum(each.slack for each in reports),
            size=self._size(),
            ceiling=self._ceiling(),
            moved=int(self._moved) + self._fewer + sum(each.moved for each in reports),
            first=(self._moved and self._first) or any(each.first for each in reports),
        )
        self._joined = {}
        return self._decide(summary) if self._parent is None else [Outgoing(self._parent, summary)]

    def _take(self, child: int, joined: Joined[ImpactT]) -> None:
        """Take a child's changes if they do not lower the team's value; a first choice in any case."""
        old = self._branches[child]
        new = old.after(self._own, joined)
        forced = joined.first or joined.size < old.size or not joined.moved
        if not (forced or old.is_raised_by(new, self._links.all_but(child), self._own)):
            self._refused.add(child)
            return
        self._branches[child] = new
        if joined.mu is not None:
            self._links.hold(child, joined.mu)

    def _decide(self, summary: Joined[ImpactT]) -> list[Outgoing[ImpactT]]:
        """At the root: begin the next sweep, or end the round: all content, value optimal, or too long."""
        self.values.append(summary.value)
        content = summary.moved == 0
        optimal = attains(summary.value, summary.ceiling, self._epsilon)
        if not (content or optimal or self.sweeps >= self._max_sweeps):
            return self._sweep(keep=True)
        above = summary.value + summary.slack if content else math.inf
        bound = tightest(summary.value, summary.ceiling, above)
        outcome = RoundOutcome(summary.value, bound, self.sweeps, content or optimal)
        return self._settle(Settled(outcome, keep=True, quiet=content))

    def _settle(self, message: Settled) -> list[Outgoing[ImpactT]]:
        """End the round here, and tell the children."""
        if not message.keep:
            self._go_back()
        self.finished, self._quiet = message.outcome, message.quiet
        return [
            Outgoing(child, Settled(message.outcome, child not in self._refused, message.quiet))
            for child in self._children
        ]
