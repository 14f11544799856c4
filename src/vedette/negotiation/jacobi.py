"""All at once, as the paper does: everybody replies to the last iterate; the root watches for cycles."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence

from vedette.errors import InputError
from vedette.negotiation.messages import Down, Message, RoundOutcome, Stop, Up
from vedette.negotiation.node import Claims, Outgoing, Participant, slack_at
from vedette.negotiation.rooted import RootedNode
from vedette.problem.bound import attains, tightest
from vedette.problem.objective import ImpactT


class JacobiNode(RootedNode[ImpactT]):
    """``v_i <- argmax psi(Y_i(v_i) * a_{-i})`` for all i at once, from the last iterate's ``a_{-i}``.

    An iterate goes up the tree and comes down it, ``2 (n - 1)`` messages. Simultaneous replies may cycle:
    every iterate's strategies are remembered, a recurrence is proved by everybody's saying when they had
    their present ones before, and the round ends at the best iterate. Where a child is cut, iterates of the
    larger team do not count: the next report says that nobody had his present strategy before.
    Source: paper, Table 1, eqs. (29)-(31); docs/theory.md (V13).
    """

    def __init__(
        self,
        neighbours: Sequence[int],
        parent: int | None,
        own: Participant[ImpactT],
        *,
        epsilon: float = 1e-9,
        max_sweeps: int = 50,
        remove: Callable[[ImpactT, ImpactT], ImpactT] | None = None,
        claims: Claims[ImpactT] | None = None,
    ) -> None:
        """Join a round.

        Args:
            neighbours: on the tree.
            parent: the neighbour towards the root, ``None`` at the root.
            own: the platform.
            epsilon: values closer than this share of them are equal.
            max_sweeps: the root ends the round after so many replies.
            remove: ``total * own^-1``. With it the team's total goes down the tree and everybody removes
                its own impact (paper, Fig. 1); without it each gets the rest of the team, and no inverse
                is needed.
            claims: what each neighbour's side may claim; without it anything.
        """
        super().__init__(own, neighbours, parent, None, claims)
        self.values: list[float] = []  # at the root: the team's value at each iterate
        self._epsilon = epsilon
        self._max_sweeps = max_sweeps
        self._remove = remove
        self._told = False  # this iterate is reported to the parent
        self._strategies: list[Hashable] = []  # own, at each iterate
        self._reports: dict[int, Up[ImpactT]] = {}
        self._ceiling = math.inf  # own part of it
        self._slack = math.inf  # own, against the last iterate that came down
        self._slacks: list[float] = []  # at the root: the team's, at each iterate but the present
        self._teams: list[ImpactT] = []  # as this platform held it at each iterate but the present
        self._best: int | None = None  # iterate that the round ended with
        self._first = 0  # at the root: first iterate that counts, everybody having a strategy
        self._lost: list[int] = []  # those cut that the iterate last reported still counts
        self._fewer = -1  # the iterate first reported without those cut last

    @property
    def waiting_for(self) -> frozenset[int]:
        """The children that have not reported this iterate, or the parent, who is to pass it down."""
        if self.finished is not None:
            return frozenset()
        if self._told:
            return frozenset(() if self._parent is None else (self._parent,))
        return frozenset(self._children).difference(self._reports)

    def start(self) -> list[Outgoing[ImpactT]]:
        """Begin, once the own impact is ready; messages may have arrived before."""
        self._ceiling = self._own.slack(self._own.nothing())
        self._strategies.append(self._own.strategy)
        return super().start()

    def _hear(self, sender: int, message: Message[ImpactT]) -> list[Outgoing[ImpactT]] | None:
        match message:
            case Up(mu=mu) if sender != self._parent:
                self._links.receive(sender, mu)
                self._reports[sender] = message
                return self._gather()
            case Down(mu=mu) if sender == self._parent:
                self._check_length(len(self._strategies) - 1, self._max_sweeps)
                if self._remove is None:
                    self._links.receive(sender, mu)
                return self._next_iterate(message)
            case Stop() if sender == self._parent:
                return self._end(message)
        return None

    @property
    def replied(self) -> bool:
        """Whether an iterate has begun here: everybody replies in each."""
        return bool(self._strategies)

    @property
    def goes_back(self) -> bool:
        """Whether the best iterate may have been an earlier one: it is not a fixed point."""
        return self.finished is not None and not self.finished.converged

    def team_held(self) -> ImpactT | None:
        """Return the impacts held together; see `Negotiator`. None where it ends with the last iterate."""
        return None if self._best is None or self._best >= len(self._teams) else self._teams[self._best]

    def _go_without(self, child: int) -> list[Outgoing[ImpactT]]:
        self._links.cut(child)
        self._children.remove(child)
        self._reports.pop(child, None)
        if self._told:
            self._lost.append(child)
            self._fewer = len(self._strategies)  # the next one
            return []
        self._fewer = max(0, len(self._strategies) - 1)
        return self._gather()

    def _gather(self) -> list[Outgoing[ImpactT]]:
        """Send this iterate up once all children have reported it; the root decides what comes down."""
        if not self._started or self.waiting_for:
            return []
        self._told = self._parent is not None
        self._lost.clear()
        reports = tuple(self._reports.values())
        self._reports.clear()
        same = self._same()
        summary: Up[ImpactT] = Up(
            mu=None if self._parent is None else self._links.outgoing(self._parent),
            ceiling=self._ceiling + sum(report.ceiling for report in reports),
            slack=self._slack + sum(report.slack for report in reports),
            same=tuple(sorted(same.intersection(*(report.same for report in reports)))),
        )
        return self._decide(summary) if self._parent is None else [Outgoing(self._parent, summary)]

    def _same(self) -> set[int]:
        """Iterates of the present team at which this platform had its present strategy.

        None at the first one of fewer: the root then knows that those before it are void.
        """
        last, now = len(self._strategies) - 1, self._strategies[-1]
        if now is None or last == self._fewer:
            return set()
        return {m for m, then in enumerate(self._strategies) if m >= self._fewer and then == now}

    def _decide(self, summary: Up[ImpactT]) -> list[Outgoing[ImpactT]]:
        """At the root: begin the next iterate, or stop at a fixed point, a cycle, the ceiling or the cap."""
        total = self._own.combine(self._links.others(), self._own.impact)
        self.values.append(self._own.value(total))
        now = len(self.values) - 1
        complete = now in summary.same  # everybody has a strategy, nobody was cut
        if not complete:
            self._first = now + 1
        if now > 0:
            self._slacks.append(summary.slack)
        before = max((m for m in summary.same if m < now), default=None)
        optimal = complete and attains(self.values[now], summary.ceiling, self._epsilon)
        if before is None and not optimal and now < self._max_sweeps:
            return self._next_iterate(Down(total))
        best = max(range(min(self._first, now), now + 1), key=self.values.__getitem__)  # first among equals
        settled = before == now - 1 and attains(self.values[now], self.values[best], self._epsilon)
        if settled:
            best = now - 1  # the same strategies, and their slack is known
        value = self.values[best]
        above = [value + self._slacks[best]] if best < now else []
        outcome = RoundOutcome(
            value=value,
            bound=tightest(value, summary.ceiling, *above),
            sweeps=now,
            converged=settled or attains(value, summary.ceiling, self._epsilon),
            cycle=0 if before in (None, now - 1) else now - before,
        )
        return self._end(Stop(outcome, best))

    def _next_iterate(self, down: Down[ImpactT]) -> list[Outgoing[ImpactT]]:
        """Pass this iterate down, then reply to it (paper, Table 1, steps 4 and 5)."""
        if self._remove is None:
            onwards = [Outgoing(k, Down(self._links.outgoing(k))) for k in self._children]
            others = self._links.others()
        elif down.mu is not None:
            onwards = [Outgoing(k, down) for k in self._children]
            others = self._remove(down.mu, self._own.impact)  # paper, eq. (31)
        else:
            raise InputError("negotiation message Down without the team's total; drop it")
        self._told = False
        before = self._own.impact
        if self._own.reply(others):
            self._links.changed()
        self._teams.append(self._own.combine(others, before))
        self._slack = slack_at(self._own, self._teams[-1], before)
        self._strategies.append(self._own.strategy)
        return onwards + self._gather()

    def _end(self, stop: Stop) -> list[Outgoing[ImpactT]]:
        """Take up the best iterate's strategy again and tell the children."""
        if stop.iterate is None or stop.iterate >= len(self._strategies):
            raise InputError(f"negotiation message Stop at iterate {stop.iterate}, never reached; drop it")
        self._best = stop.iterate
        self._own.adopt(self._strategies[stop.iterate])
        self.finished = stop.outcome
        return [Outgoing(k, stop) for k in (*self._children, *self._lost)]
