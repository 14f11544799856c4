"""Rounds: when the team begins one, what this robot hears of it, and what it says in the end.

A round that a child holds up goes on without it; one whose parent is silent is given up, and the robot keeps
its strategy for a while. A child that keeps being cut is left out for longer each time, and a parent by which
no round comes to anything is shunned. Who takes part in none plans alone: nobody stands idle because somebody
else is slow, mute, or worse. What happens in a round: ``vedette.agent.round``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf
from typing import Any

from vedette.agent.attendance import Attendance, Upwards
from vedette.agent.effects import Effect, Job, Shun
from vedette.agent.events import Pose, TreeChanged
from vedette.agent.mates import Mate
from vedette.agent.messages import Begin, Call, Flushed, Freeze, Negotiate
from vedette.agent.mission import Mission
from vedette.agent.opinion import Opinion
from vedette.agent.pace import Pace
from vedette.agent.patience import TeamPatience
from vedette.agent.round import MAX_FORKS, Round, say, send_news
from vedette.agent.scrutiny import Scrutiny
from vedette.agent.silence import Slowness
from vedette.number import many

CALL_AGAIN = 1.0  # a call not answered is repeated after so long [s]
SETTLING = 0.2  # a new tree is left alone for so long before a round [s]
CLOCKS_APART = 20.0  # that the root's may be from this robot's, where rounds keep to beats [s]


@dataclass(frozen=True)
class Decision:
    """What a finished round says, besides the strategies themselves."""

    time: float
    value: float  # of the team's choice: as this robot sees it, if it sees all of it, prices not taken off
    elsewhere: bool  # it is worth something, too, on maps that nothing joins with this robot's
    approximate: bool  # its belief was not the root's, or it decided without the team or its own say
    blocked: bool  # this robot planned with its mates in the way
    alone: bool = False  # nobody else had part in the round, though there are others


@dataclass
class Rounds:
    """One robot's part in the team's rounds."""

    mission: Mission[Any, Any, Any]
    scheme: str  # of `SCHEMES`
    decided: Callable[[Decision], None]
    pace: Pace = field(default_factory=Pace)
    patience: TeamPatience = field(init=False)
    scrutiny: Scrutiny = field(init=False)
    forks: bool = False  # the token may fork in a large team
    admitted: int = 1 << 16  # robots that there can be in the team
    mandate: Callable[[], int] = lambda: 0  # digest of the orders that are held
    tree: TreeChanged = field(default_factory=lambda: TreeChanged(0, None, (), 1))
    decisions: int = 0
    sweeps: int = 0
    answers: int = 0  # negotiation messages answered
    cuts: int = 0  # children that did not answer in time
    bound_ratios: list[float] = field(default_factory=list)
    impact: Any = None  # own impact of the last decision
    team_impact: Any = None  # and all robots' together; None: not all of it is held here
    blocked: bool = False  # the robot could not go on: its mates count as obstacles in the next round
    round: Round | None = None  # that is going on
    _sequence: int = 0
    _wanted: bool = False
    _called: float = -1e9
    _asks: float = inf  # since when its calls have not been answered [s]
    _began: float = -1e9
    _ended: float = -1e9
    _attendance: Attendance = field(default_factory=Attendance)
    _upwards: Upwards = field(default_factory=Upwards)
    _slowness: Slowness = field(default_factory=Slowness)
    _shunned: set[int] = field(default_factory=set)  # parents by which no round has ended since
    _opinion: Opinion = field(init=False)
    _solos: int = 0  # rounds that this robot began for itself alone

    def __post_init__(self) -> None:
        self.patience, self.scrutiny = TeamPatience(self.pace), Scrutiny(self.mission)
        self._opinion = Opinion(self.mission, self.scrutiny)

    @property
    def busy(self) -> bool:
        """Tell whether a round is going on."""
        return self.round is not None

    @property
    def began(self) -> float:
        """When the last round began that this robot has heard of [s]."""
        return self._began

    @property
    def stamp(self) -> tuple[int, int]:
        """Epoch and sequence number of the round going on, or of the last one."""
        return self.tree.epoch, self._sequence if self.round is None else self.round.sequence

    @property
    def absent(self) -> frozenset[int]:
        """Children that rounds go on without for a while, since they kept being cut."""
        return self._attendance.absent(self.patience.ticked)

    @property
    def distrusted(self) -> frozenset[int]:
        """Robots without which this one plans, for their word is not believed."""
        return self.scrutiny.distrusted(self.patience.ticked)

    # -- when rounds begin and end --------------------------------------------------------------------

    def join(self, tree: TreeChanged, now: float) -> None:
        """Take part on another tree, where what went on on the old one is void.

        In the same epoch neighbours are only added: they take part from the next round on. Whoever is new, or
        gone, makes a plan worth having soon.
        """
        before, self.tree = self.tree, tree
        self._attendance.keep(tree.neighbours)
        if (tree.epoch, tree.neighbours) == (before.epoch, before.neighbours):
            return
        self._wanted = True
        self._ended = min(self._ended, now - self.pace.interval + SETTLING)
        if tree.epoch == before.epoch:
            return
        self.round = None
        self._sequence, self._upwards = 0, Upwards()
        self._called, self._asks = -1e9, inf

    def want(self) -> None:
        """Ask for a round as soon as one may begin."""
        self._wanted = True

    def call(self, now: float) -> list[Effect]:
        """Pass a call on towards the root."""
        self._wanted = True
        return self.tick(now)

    def tick(self, now: float) -> list[Effect]:
        """Do what is due: go on without who does not answer, call or begin a round that is wanted."""
        self.patience.tick(now)
        self.scrutiny.tick(now)
        if self.tree.parent in self.distrusted:
            return self._shun()
        effects = self._hurry(now)
        if self.round or now < self._ended + self.pace.interval:
            return effects
        return effects + self._ask(now)

    def _hurry(self, now: float) -> list[Effect]:
        """Cut children that do not answer in time from the round; give it up if it is the parent."""
        round_ = self.round
        if round_ is None:
            return []
        effects: list[Effect] = []
        waits, waited = self.patience.waits(self._size, round_.depth), now - round_.heard
        for silent in sorted(round_.awaited - {round_.tree.parent}):
            bears = self._attendance.bears(silent, waits) if round_.belief is None else waits
            if waited <= bears and silent not in round_.spoilt:
                continue
            if self.round is not round_:  # cutting the one before has ended it
                break
            self.cuts += 1
            self._attendance.missed(silent, now, self.patience.tempo)
            effects += self._after(round_.cut(silent, now), now)
        lonely, size = self._is_lonely(now), self._size
        most = self.patience.least(size) if lonely else 1.5 * self.patience.waits(size)
        if effects or (waited <= max(waits, most) and round_.tree.parent not in round_.spoilt):
            return effects
        return self._give_up(round_, now)

    def _give_up(self, round_: Round, now: float) -> list[Effect]:
        """End a round that came to nothing; alone for long, decide on it alone."""
        if self._is_lonely(now) and round_.participant is not None:
            return [*self._after(round_.go_on_alone(now), now), *self._fail()]
        self._end(now)
        self._wanted = True
        return self._fail()

    def heard(self, neighbour: int, now: float) -> None:
        """Note that a neighbour's agent has said something, whatever it is."""
        if self.round is not None and neighbour in self.round.tree.neighbours:
            self.round.silences.heard(neighbour, now)

    @property
    def slow(self) -> frozenset[int]:
        """Neighbours that round after round waits for."""
        return self._slowness.slow

    @property
    def _size(self) -> int:
        """Robots on the tree, as far as there can be so many."""
        return min(self.tree.size, self.admitted)

    def _is_lonely(self, now: float) -> bool:
        """Tell whether this robot has decided with nobody for so long that it had better plan alone."""
        return self.patience.is_over(self._size, now)

    def _fail(self) -> list[Effect]:
        """Note that the parent let a round come to nothing."""
        return self._shun() if self._upwards.fails(self.tree) or self.tree.parent in self._shunned else []

    def _shun(self) -> list[Effect]:
        if self.tree.parent is None:
            return []
        self._shunned.add(self.tree.parent)
        return [Shun(self.tree.parent)]

    def _ask(self, now: float) -> list[Effect]:
        if self.tree.parent is None:
            wanted = self._wanted or now >= self._ended + self.pace.period
            begins = wanted and self.pace.on_beat(self._began, now)
            return self.begin(Begin(self.tree.epoch, self._sequence + 1, 0), now) if begins else []
        ignored = self.patience.ignored(self._size, self._asks, now)
        if (ignored or self._is_lonely(now)) and self._wanted and self.pace.on_beat(self._began, now):
            if ignored:
                self._asks = now - self.patience.least(self._size)
            return [*self._call(now), *self._begin_alone(now), *(self._fail() if ignored else [])]
        # A root that takes the mission for finished begins no round: who does not, calls for one.
        self._wanted |= now >= self._ended + self.pace.overdue
        return self._call(now) if self._wanted else []

    def _call(self, now: float) -> list[Effect]:
        """Tell the parent that a plan is needed, unless it has just been told."""
        if self.tree.parent is None or now < self._called + CALL_AGAIN:
            return []
        self._called, self._asks = now, min(self._asks, now)
        return [say(self.tree.parent, Call(self.tree.epoch))]

    def _begin_alone(self, now: float) -> list[Effect]:
        """Begin a round that nobody else hears of."""
        self._solos += 1
        self._began, self._wanted = now, False
        tree = replace(self.tree, parent=None, neighbours=())
        self.round = Round(self.mission, self.scheme, tree, -self._solos, 0, now, mandate=self.mandate)
        return self.round.begin(Begin(self.tree.epoch, -self._solos, 0), now)

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
        self.sweeps += min(outcome.sweeps, MAX_FORKS)  # it is what somebody has told
        if outcome.bound is not None and outcome.bound > 0:
            self.bound_ratios.append(max(min(outcome.value / outcome.bound, 1.0), -1.0))
        self.blocked &= not round_.blocked  # taken into account
        lonely = not round_.tree.neighbours and self.tree.parent is not None
        took_part = not lonely and round_.replied
        if took_part:
            self.patience.together(now)
            self._attendance.attended(round_.children)
            self._shunned -= {round_.tree.parent}
            effects = effects + self.scrutiny.decided(
                round_, self.stamp, self.impact, self.tree.neighbours, now
            )
        self._end(now)
        self.team_impact = round_.team_seen
        value, elsewhere = self._opinion.of(round_, outcome, self.team_impact)
        approximate = round_.approximate or not took_part
        self.decided(Decision(now, value, elsewhere, approximate, round_.blocked, lonely))
        if lonely:
            return effects
        self._wanted |= not took_part
        if not took_part:
            return [*effects, *self._fail()]
        return [*effects, *(self._shun() if self._upwards.ends(self.tree, round_.approximate) else [])]

    def _end(self, now: float) -> None:
        if self.round is not None:
            bears = self.patience.is_no_wonder
            self._slowness.note(self.round.silences, self.tree.neighbours, bears, now)
        self.round = None
        self._ended = now

    # -- what is heard of a round ---------------------------------------------------------------------

    def begin(self, message: Begin, now: float) -> list[Effect]:
        """Enter a round."""
        # Between rounds any new number will do: one that came wrong must not shut this robot out for good.
        old = self.busy and not (self.round and self.round.is_alone) and message.sequence < self._sequence
        if message.epoch != self.tree.epoch or message.sequence == self._sequence or old:
            return []
        unfinished = [] if self.round is None or self.round.is_alone else self._give_up(self.round, now)
        self._sequence = message.sequence
        self._began, self._asks = now, inf
        self._wanted = False
        absent = (self._attendance.absent(now) | self.distrusted) - {self.tree.parent}
        tree = replace(self.tree, neighbours=tuple(k for k in self.tree.neighbours if k not in absent))
        weigh = partial(self.scrutiny.suspicion.weigh, self.mission)
        self.round = Round(
            self.mission,
            self.scheme,
            tree,
            message.sequence,
            message.depth,
            now,
            self.forks,
            weigh,
            self.mandate,
        )
        return [*unfinished, *self.round.begin(message, now)]

    def flushed(self, sender: int, message: Flushed, now: float) -> list[Effect]:
        """Hear that a child's part of the tree has flushed.

        Raises:
            ValueError: it speaks for more robots than there can be.
        """
        round_ = self._of(message.epoch, message.sequence)
        self._check_robots(message)
        if round_ is None:
            return []
        self._attendance.flushed(sender, now - self._began)
        return round_.hear_flushed(sender, message, now)

    def freeze(self, message: Freeze, now: float) -> list[Effect]:
        """Hear that everything known has arrived.

        Raises:
            ValueError: a child has not been heard, or it is of more robots than can be. Or the clocks do
                not agree where rounds keep to their beats: such a mission predicts what it knows to the
                root's time, step by step, and would not come to an end.
        """
        round_ = self._of(message.epoch, message.sequence)
        self._check_robots(message)
        if round_ is None:
            return []
        apart = message.t0 / 1000.0 - now
        if self.pace.beat and abs(apart) > CLOCKS_APART:
            raise ValueError(f"freeze: the root's clock is {apart:.1f} s from this robot's")
        return round_.freeze(message, now)

    def _check_robots(self, message: Flushed | Freeze) -> None:
        """Raise ValueError for more robots than there can be: so many more could claim to see something."""
        if message.robots > self.admitted:
            raise ValueError(
                f"round of {many(message.robots, 'robot')}; the team has {self.admitted} at most"
            )

    @property
    def frozen(self) -> Any | None:
        """The round's belief, if it is frozen and nothing has been done with it yet."""
        return None if self.round is None or self.round.preparing else self.round.belief

    def preparation(self, pose: Pose, mates: list[Mate], now: float) -> Job:
        """Return the job to do on a belief just frozen; ``pose``: where the strategy will start."""
        assert self.round
        self.patience.prepares(now)
        return self.round.prepare(pose, mates, self.blocked, now)

    def prepared(self, key: tuple[int, int], now: float) -> list[Effect]:
        """Start negotiating."""
        self.patience.prepared(now)
        round_ = self._of(*key)
        return [] if round_ is None else self._after(round_.start(now), now)

    def take_early(self) -> list[tuple[int, Negotiate]]:
        """Return the negotiation messages, with their senders, that came before this robot was prepared."""
        return [] if self.round is None else self.round.take_early()

    def negotiate(self, sender: int, message: Negotiate, now: float) -> list[Effect]:
        """Take in a negotiation message.

        Raises:
            ValueError: it makes no sense; nobody waits for this neighbour any more in this round.
        """
        round_ = self._of(message.epoch, message.sequence)
        if round_ is None:
            return []
        self.answers += round_.negotiator is not None
        try:
            return self._after(round_.negotiate(sender, message, now), now)
        except ValueError:
            round_.spoilt.add(sender)
            raise

    def _of(self, epoch: int, sequence: int) -> Round | None:
        """Return the round going on, if it is the one that is spoken of."""
        round_ = self.round
        known = round_ is not None and epoch == self.tree.epoch and sequence == round_.sequence
        return round_ if known else None

    def news(self, neighbour: int, now: float) -> list[Effect]:
        """Return what a neighbour lacks of the evidence, if anything."""
        return send_news(self.mission, neighbour, now)
