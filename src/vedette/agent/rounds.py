"""Rounds: the team brings its evidence together, freezes it, negotiates, and everybody has a new strategy.

``Begin`` goes down the tree; evidence flows up, each robot's news ahead of its ``Flushed``; from the root it
flows down ahead of ``Freeze``. On links that lose nothing, everybody then holds the same belief. A child that
does not answer in time is cut from the round, which goes on without its part of the tree; a robot whose
parent is silent gives the round up, and keeps its strategy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from msgspec import structs

from vedette.agent.effects import Effect, Job, Send, Traffic
from vedette.agent.events import Pose, TreeChanged
from vedette.agent.mates import Mate
from vedette.agent.messages import Areas, Begin, Call, Evidence, Flushed, Freeze, Negotiate, Note, encode
from vedette.agent.mission import Mission
from vedette.agent.pace import Pace
from vedette.agent.participant import RoundParticipant
from vedette.agent.reaches import reaches_to_tell
from vedette.negotiation import Claims, JacobiNode, Negotiator, Outcome, TokenNode, messages
from vedette.problem import Reach

CALL_AGAIN = 1.0  # a call not answered is repeated after so long [s]
SETTLING = 0.2  # a new tree is left alone for so long before a round [s]
MAX_SWEEPS = 12
MOST_NOTES = 512  # in one message
CLOCKS_APART = 20.0  # that the root's may be from this robot's, where rounds keep to beats [s]
MOST_EARLY = 8  # negotiation messages of one neighbour that wait for this robot's preparation


def patience(size: int, depth: int = 0) -> float:
    """Return how long a robot, ``depth`` links below the root of so many, waits for a child's answer [s].

    The lower a robot, the sooner it cuts a child off: before its own parent loses patience with it.
    """
    return 1.0 + 0.3 * max(size - depth, 1)


@dataclass(frozen=True)
class Decision:
    """What a finished round says, besides the strategies themselves."""

    time: float
    outcome: Outcome
    approximate: bool  # this robot's belief was not the root's
    blocked: bool  # this robot planned with its mates in the way


@dataclass
class _Round:
    """One round as this robot sees it."""

    sequence: int
    tree: TreeChanged  # without who joined after it began, or was cut from it
    depth: int  # links to the root
    heard: float  # when it last went on [s]
    waiting: set[int]  # children that have not flushed yet
    notes: set[Note] = field(default_factory=set)  # told by children
    reaches: dict[int, Reach | None] = field(default_factory=dict)  # beyond each neighbour, as it told
    robots: dict[int, int] = field(default_factory=dict)  # behind each neighbour, as it told
    belief: Any = None
    approximate: bool = False
    preparing: bool = False
    blocked: bool = False
    participant: RoundParticipant | None = None
    negotiator: Negotiator[Any] | None = None
    early: list[tuple[int, Negotiate]] = field(default_factory=list)  # came before we were ready

    @property
    def children(self) -> list[int]:
        """The neighbours further from the root."""
        return [k for k in self.tree.neighbours if k != self.tree.parent]

    @property
    def awaited(self) -> set[int]:
        """Whose answer this robot waits for; empty while it has to do something itself."""
        if self.negotiator is not None:
            return set(self.negotiator.waiting_for)
        if self.belief is not None:
            return set()
        return self.waiting or ({self.tree.parent} if self.tree.parent is not None else set())

    @property
    def part(self) -> int:
        """Count the robots from this one on away from the root."""
        return 1 + sum(self.robots.get(child, 0) for child in self.children)

    def cut(self, child: int) -> None:
        """Go on without a child and all behind it."""
        self.waiting.discard(child)
        self.reaches.pop(child, None)
        self.robots.pop(child, None)
        self.tree = replace(self.tree, neighbours=tuple(k for k in self.tree.neighbours if k != child))


@dataclass
class Rounds:
    """One robot's part in the team's rounds."""

    mission: Mission
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
    _round: _Round | None = None
    _sequence: int = 0
    _wanted: bool = False
    _called: float = -1e9
    _began: float = -1e9
    _ended: float = -1e9

    @property
    def busy(self) -> bool:
        """Tell whether a round is going on."""
        return self._round is not None

    @property
    def stamp(self) -> tuple[int, int]:
        """Epoch and sequence number of the round going on, or of the last one."""
        return self.tree.epoch, self._sequence

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
        self._round = None
        self._sequence = 0
        self._called = -1e9

    def want(self) -> None:
        """Ask for a round as soon as one may begin."""
        self._wanted = True

    def tick(self, now: float) -> list[Effect]:
        """Do what is due: go on without who does not answer, call or begin a round that is wanted."""
        effects = self._hurry(now)
        if self._round or now < self._ended + self.pace.interval:
            return effects
        return effects + self._ask(now)

    def _hurry(self, now: float) -> list[Effect]:
        """Cut children that do not answer in time from the round; give it up if it is the parent."""
        round_ = self._round
        if round_ is None or now <= round_.heard + patience(self.tree.size, round_.depth):
            return []
        parent = round_.tree.parent
        effects: list[Effect] = []
        for silent in sorted(round_.awaited - {parent}):
            effects += self._cut(silent, now)
        if not effects and now > round_.heard + 1.5 * patience(self.tree.size):
            self._end(now)
            self._wanted = True
        return effects

    def _cut(self, child: int, now: float) -> list[Effect]:
        round_ = self._round
        if round_ is None:
            return []
        self.cuts += 1
        round_.heard = now
        round_.cut(child)
        if round_.negotiator is not None:
            return self._send(round_.negotiator.cut(child), now)
        return self._flush(now)

    def _ask(self, now: float) -> list[Effect]:
        if self.tree.parent is None:
            wanted = self._wanted or now >= self._ended + self.pace.period
            return self._begin(now) if wanted and self.pace.on_beat(self._began, now) else []
        # A root that takes the mission for finished begins no round: who does not, calls for one.
        wanted = self._wanted or now >= self._ended + self.pace.overdue
        if wanted and now >= self._called + CALL_AGAIN:
            self._called = now
            return [self._say(self.tree.parent, Call(self.tree.epoch))]
        return []

    # -- the round's phases ------------------------------------------------------------------------

    def call(self, now: float) -> list[Effect]:
        """Pass a call on towards the root."""
        self._wanted = True
        return self.tick(now)

    def _begin(self, now: float) -> list[Effect]:
        return self.begin(Begin(self.tree.epoch, self._sequence + 1, 0), now)

    def begin(self, message: Begin, now: float) -> list[Effect]:
        """Enter a round: hand the word on, and flush what this robot knows once its children have."""
        # Between rounds any new number will do: one that came wrong must not shut this robot out for good.
        old = self.busy and message.sequence < self._sequence
        if message.epoch != self.tree.epoch or message.sequence == self._sequence or old:
            return []
        self._sequence = message.sequence
        self._began = now
        self._wanted = False
        self._round = _Round(message.sequence, self.tree, message.depth, now, set())
        self._round.waiting.update(self._round.children)
        self.mission.publish(now)
        onwards = structs.replace(message, depth=message.depth + 1)
        effects: list[Effect] = [self._say(child, onwards) for child in self._round.children]
        return effects + self._flush(now)

    def flushed(self, sender: int, message: Flushed, now: float) -> list[Effect]:
        """Note that a child's part of the tree has been heard."""
        if not self._matches(message.epoch, message.sequence):
            return []
        assert self._round
        if sender not in self._round.waiting:
            return []
        self._round.waiting.discard(sender)
        self._round.notes.update(message.notes)
        self._round.reaches[sender] = message.reach
        self._round.robots[sender] = message.robots
        self._round.heard = now
        return self._flush(now)

    def _flush(self, now: float) -> list[Effect]:
        assert self._round
        if self._round.waiting or self._round.belief is not None:
            return []
        notes = tuple(sorted(self._round.notes.union(self.mission.notes())))[:MOST_NOTES]
        if self.tree.parent is None:
            t0 = round(1000.0 * now)
            digest = self.mission.fusion.digest
            team = self._round.part
            return self._freeze(Freeze(self.tree.epoch, self._round.sequence, t0, digest, team, notes), now)
        news = self.news(self.tree.parent, now)
        reach = self._reaches(now)[self.tree.parent]
        flushed = Flushed(self.tree.epoch, self._round.sequence, self._round.part, notes, reach)
        return [*news, self._say(self.tree.parent, flushed)]

    def freeze(self, message: Freeze, now: float) -> list[Effect]:
        """Everything known has arrived: freeze it.

        Raises:
            ValueError: a child has not been heard, so the root cannot have heard all. Or the clocks do not
                agree where rounds keep to their beats: such a mission predicts what it knows to the root's
                time, step by step, and would not come to an end.
        """
        if not self._matches(message.epoch, message.sequence):
            return []
        assert self._round
        if self._round.belief is not None:
            return []
        if self._round.waiting:
            raise ValueError(f"freeze: children {sorted(self._round.waiting)} have not been heard")
        apart = message.t0 / 1000.0 - now
        if self.pace.beat and abs(apart) > CLOCKS_APART:
            raise ValueError(f"freeze: the root's clock is {apart:.1f} s from this robot's")
        return self._freeze(message, now)

    def _freeze(self, message: Freeze, now: float) -> list[Effect]:
        assert self._round
        effects: list[Effect] = []
        self._round.heard = now
        if self.tree.parent is not None:
            self._round.reaches[self.tree.parent] = message.reach
            self._round.robots[self.tree.parent] = max(message.robots - self._round.part, 1)
        told = self._reaches(now)
        for child in self._round.children:
            effects += self.news(child, now)
            effects.append(self._say(child, structs.replace(message, reach=told[child])))
        self._round.approximate = self.mission.fusion.digest != message.digest
        self.mission.hear_notes(message.notes)
        self._round.belief = self.mission.freeze(message.t0 / 1000.0)
        return effects

    def _reaches(self, now: float) -> dict[int, Areas | None]:
        assert self._round
        return reaches_to_tell(self.mission.reach(now), self._round.reaches, self._round.tree.neighbours)

    @property
    def frozen(self) -> Any | None:
        """The round's belief, if it is frozen and nothing has been done with it yet."""
        return None if self._round is None or self._round.preparing else self._round.belief

    def preparation(self, pose: Pose, mates: list[Mate], now: float) -> Job:
        """Return the job to do between freezing and negotiating; ``pose``: where the strategy will start."""
        round_ = self._round
        assert round_
        round_.preparing, round_.blocked = True, self.blocked
        belief, blocked = round_.belief, self.blocked
        return Job(
            (self.tree.epoch, round_.sequence),
            lambda: self.mission.prepare(belief, pose, mates, blocked, now),
        )

    def prepared(self, key: tuple[int, int], now: float) -> list[Effect]:
        """Start negotiating."""
        if not self._matches(*key):
            return []
        round_ = self._round
        assert round_
        round_.heard = now
        round_.participant = RoundParticipant(self.mission, round_.belief)
        links, parent, own = round_.tree.neighbours, round_.tree.parent, round_.participant
        bounded = {k: reach for k, reach in round_.reaches.items() if reach is not None}
        claims = Claims(round_.robots, partial(self.mission.admit, round_.belief))
        round_.negotiator = (
            TokenNode(links, parent, own, max_sweeps=MAX_SWEEPS, reaches=bounded, claims=claims)
            if self.scheme == "token"
            else JacobiNode(links, parent, own, max_sweeps=MAX_SWEEPS, claims=claims)
        )
        return self._send(round_.negotiator.start(), now)

    def take_early(self) -> list[tuple[int, Negotiate]]:
        """Return the negotiation messages, with their senders, that came before this robot was prepared."""
        if self._round is None or self._round.negotiator is None:
            return []
        early, self._round.early = self._round.early, []
        return early

    def negotiate(self, sender: int, message: Negotiate, now: float) -> list[Effect]:
        """Take in a negotiation message."""
        if not self._matches(message.epoch, message.sequence):
            return []
        assert self._round
        if self._round.negotiator is None:
            if sum(early == sender for early, _ in self._round.early) < MOST_EARLY:
                self._round.early.append((sender, message))
            return []
        self.answers += 1
        sends = self._round.negotiator.receive(sender, messages.decode(message.data, self.mission.codec))
        self._round.heard = now
        return self._send(sends, now)

    def _send(self, sends: list[Any], now: float) -> list[Effect]:
        round_ = self._round
        assert round_
        assert round_.negotiator
        assert round_.participant
        effects: list[Effect] = [
            self._say(
                send.to,
                Negotiate(
                    self.tree.epoch, round_.sequence, messages.encode(send.message, self.mission.codec)
                ),
            )
            for send in sends
        ]
        outcome = round_.negotiator.finished
        if outcome is not None:
            self.mission.strategy = round_.participant.chosen
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
        self._round = None
        self._ended = now

    # -- links --------------------------------------------------------------------------------------

    def _matches(self, epoch: int, sequence: int) -> bool:
        return self._round is not None and epoch == self.tree.epoch and sequence == self._round.sequence

    def _say(self, to: int, message: Call | Begin | Flushed | Freeze | Negotiate) -> Send:
        return Send(to, Traffic.NEGOTIATION, encode(message))

    def news(self, neighbour: int, now: float) -> list[Effect]:
        """Return what a neighbour lacks of the evidence, if anything."""
        data = self.mission.fusion.outgoing(neighbour, now)
        return [] if data is None else [Send(neighbour, Traffic.FUSION, encode(Evidence(data)))]
