"""Rounds: when the team begins one, what this robot hears of it, and what it says in the end.

A round that a child holds up goes on without it; one whose parent is silent is given up, and the robot keeps
its strategy. What happens in a round: ``vedette.agent.round``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from vedette.agent.effects import Effect, Job
from vedette.agent.events import Pose, TreeChanged
from vedette.agent.mates import Mate
from vedette.agent.messages import Begin, Call, Flushed, Freeze, Negotiate
from vedette.agent.mission import Mission
from vedette.agent.pace import Pace
from vedette.agent.round import Round, say, send_news
from vedette.negotiation import RoundOutcome

CALL_AGAIN = 1.0  # a call not answered is repeated after so long [s]
SETTLING = 0.2  # a new tree is left alone for so long before a round [s]
CLOCKS_APART = 20.0  # that the root's may be from this robot's, where rounds keep to beats [s]


def patience(size: int, depth: int = 0) -> float:
    """Return how long a robot, ``depth`` links below the root of so many, waits for a child's answer [s].

    The lower a robot, the sooner it cuts a child off: before its own parent loses patience with it.
    """
    return 1.0 + 0.3 * max(size - depth, 1)


@dataclass(frozen=True)
class Decision:
    """What a finished round says, besides the strategies themselves."""

    time: float
    outcome: RoundOutcome
    approximate: bool  # this robot's belief was not the root's
    blocked: bool  # this robot planned with its mates in the way


@dataclass
class Rounds:
    """One robot's part in the team's rounds."""

    mission: Mission[Any, Any, Any]
    scheme: str  # "token" or "jacobi"
    decided: Callable[[Decision], None]
    pace: Pace = field(default_factory=Pace)
    tree: TreeChanged = field(default_factory=lambda: TreeChanged(0, None, (), 1))
    decisions: int = 0
    sweeps: int = 0
    answers: int = 0  # negotiation messages answered
    cuts: int = 0  # children that did not answer in time
    bound_ratios: list[float] = field(default_factory=list)
    impact: Any = None  # own impact of the last decision
    blocked: bool = False  # the robot could not go on: its mates count as obstacles in the next round
    round: Round | None = None  # that is going on
    _sequence: int = 0
    _wanted: bool = False
    _called: float = -1e9
    _began: float = -1e9
    _ended: float = -1e9

    @property
    def busy(self) -> bool:
        """Tell whether a round is going on."""
        return self.round is not None

    @property
    def stamp(self) -> tuple[int, int]:
        """Epoch and sequence number of the round going on, or of the last one."""
        return self.tree.epoch, self._sequence

    # -- when rounds begin and end --------------------------------------------------------------------

    def join(self, tree: TreeChanged, now: float) -> None:
        """Take part on another tree, where what went on on the old one is void.

        In the same epoch neighbours are only added: they take part from the next round on. Whoever is new, or
        gone, makes a plan worth having soon.
        """
        before, self.tree = self.tree, tree
        if (tree.epoch, tree.neighbours) == (before.epoch, before.neighbours):
            return
        self._wanted = True
        self._ended = min(self._ended, now - self.pace.interval + SETTLING)
        if tree.epoch == before.epoch:
            return
        self.round = None
        self._sequence = 0
        self._called = -1e9

    def want(self) -> None:
        """Ask for a round as soon as one may begin."""
        self._wanted = True

    def call(self, now: float) -> list[Effect]:
        """Pass a call on towards the root."""
        self._wanted = True
        return self.tick(now)

    def tick(self, now: float) -> list[Effect]:
        """Do what is due: go on without who does not answer, call or begin a round that is wanted."""
        effects = self._hurry(now)
        if self.round or now < self._ended + self.pace.interval:
            return effects
        return effects + self._ask(now)

    def _hurry(self, now: float) -> list[Effect]:
        """Cut children that do not answer in time from the round; give it up if it is the parent."""
        round_ = self.round
        if round_ is None or now <= round_.heard + patience(self.tree.size, round_.depth):
            return []
        effects: list[Effect] = []
        for silent in sorted(round_.awaited - {round_.tree.parent}):
            if self.round is not round_:  # cutting the one before has ended it
                break
            self.cuts += 1
            effects += self._after(round_.cut(silent, now), now)
        if not effects and now > round_.heard + 1.5 * patience(self.tree.size):
            self._end(now)
            self._wanted = True
        return effects

    def _ask(self, now: float) -> list[Effect]:
        if self.tree.parent is None:
            wanted = self._wanted or now >= self._ended + self.pace.period
            begins = wanted and self.pace.on_beat(self._began, now)
            return self.begin(Begin(self.tree.epoch, self._sequence + 1, 0), now) if begins else []
        # A root that takes the mission for finished begins no round: who does not, calls for one.
        wanted = self._wanted or now >= self._ended + self.pace.overdue
        if wanted and now >= self._called + CALL_AGAIN:
            self._called = now
            return [say(self.tree.parent, Call(self.tree.epoch))]
        return []

    def _after(self, effects: list[Effect], now: float) -> list[Effect]:
        """Take up what a round has come to, if that was its last step."""
        round_ = self.round
        outcome = None if round_ is None else round_.finished
        if round_ is None or outcome is None:
            return effects
        assert round_.participant
        self.mission.strategy = round_.participant.strategy
        self.impact = round_.participant.impact
        self.decisions += 1
        self.sweeps += outcome.sweeps
        if outcome.bound is not None and outcome.bound > 0:
            self.bound_ratios.append(outcome.value / outcome.bound)
        self.blocked &= not round_.blocked  # taken into account
        self._end(now)
        self.decided(Decision(now, outcome, round_.approximate, round_.blocked))
        return effects

    def _end(self, now: float) -> None:
        self.round = None
        self._ended = now

    # -- what is heard of a round ---------------------------------------------------------------------

    def begin(self, message: Begin, now: float) -> list[Effect]:
        """Enter a round."""
        # Between rounds any new number will do: one that came wrong must not shut this robot out for good.
        old = self.busy and message.sequence < self._sequence
        if message.epoch != self.tree.epoch or message.sequence == self._sequence or old:
            return []
        self._sequence = message.sequence
        self._began = now
        self._wanted = False
        self.round = Round(self.mission, self.scheme, self.tree, message.sequence, message.depth, now)
        return self.round.begin(message, now)

    def flushed(self, sender: int, message: Flushed, now: float) -> list[Effect]:
        """Hear that a child's part of the tree has flushed."""
        round_ = self._of(message.epoch, message.sequence)
        return [] if round_ is None else round_.hear_flushed(sender, message, now)

    def freeze(self, message: Freeze, now: float) -> list[Effect]:
        """Hear that everything known has arrived.

        Raises:
            ValueError: a child has not been heard. Or the clocks do not agree where rounds keep to their
                beats: such a mission predicts what it knows to the root's time, step by step, and would not
                come to an end.
        """
        round_ = self._of(message.epoch, message.sequence)
        if round_ is None:
            return []
        apart = message.t0 / 1000.0 - now
        if self.pace.beat and abs(apart) > CLOCKS_APART:
            raise ValueError(f"freeze: the root's clock is {apart:.1f} s from this robot's")
        return round_.freeze(message, now)

    @property
    def frozen(self) -> Any | None:
        """The round's belief, if it is frozen and nothing has been done with it yet."""
        return None if self.round is None or self.round.preparing else self.round.belief

    def preparation(self, pose: Pose, mates: list[Mate], now: float) -> Job:
        """Return the job to do on a belief just frozen; ``pose``: where the strategy will start."""
        assert self.round
        return self.round.prepare(pose, mates, self.blocked, now)

    def prepared(self, key: tuple[int, int], now: float) -> list[Effect]:
        """Start negotiating."""
        round_ = self._of(*key)
        return [] if round_ is None else self._after(round_.start(now), now)

    def take_early(self) -> list[tuple[int, Negotiate]]:
        """Return the negotiation messages, with their senders, that came before this robot was prepared."""
        return [] if self.round is None else self.round.take_early()

    def negotiate(self, sender: int, message: Negotiate, now: float) -> list[Effect]:
        """Take in a negotiation message."""
        round_ = self._of(message.epoch, message.sequence)
        if round_ is None:
            return []
        self.answers += round_.negotiator is not None
        return self._after(round_.negotiate(sender, message, now), now)

    def _of(self, epoch: int, sequence: int) -> Round | None:
        """Return the round going on, if it is the one that is spoken of."""
        round_ = self.round
        known = round_ is not None and epoch == self.tree.epoch and sequence == round_.sequence
        return round_ if known else None

    def news(self, neighbour: int, now: float) -> list[Effect]:
        """Return what a neighbour lacks of the evidence, if anything."""
        return send_news(self.mission, neighbour, now)
