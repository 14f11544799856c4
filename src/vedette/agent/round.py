"""One round, as one robot of the team goes through it: from evidence to a decision."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from msgspec import structs

from vedette.agent.effects import Effect, Job, Send, TrafficKind
from vedette.agent.events import Pose, TreeChanged
from vedette.agent.mates import Mate
from vedette.agent.messages import (
    MOST_DEPTH,
    MOST_ROBOTS,
    Areas,
    Begin,
    Call,
    Evidence,
    Flushed,
    FramedFreeze,
    Freeze,
    Negotiate,
    Note,
    encode,
)
from vedette.agent.mission import Framing, Mission
from vedette.agent.participant import RoundParticipant
from vedette.agent.reaches import reaches_to_tell
from vedette.agent.silence import Silences
from vedette.negotiation import Claims, Negotiator, RoundOutcome, messages, node_of
from vedette.negotiation import Outgoing as Reply
from vedette.problem import Reach

MAX_SWEEPS = 12
FORK_FROM = 16  # robots in a round from which on the token forks: sweeps are then as deep as the tree
MAX_FORKS = 50  # sweeps of forks: more, and far shorter
MOST_NOTES = 512  # in one message
MOST_EARLY = 8  # negotiation messages of one neighbour that wait for this robot's preparation


@dataclass
class Round:
    """The paper's Table 1 with the fusion before it (section 3.5), over links that bring messages in order.

    =============  ==========================================================  ==========================
    step           what this robot does, once it can                           paper
    =============  ==========================================================  ==========================
    ``begin``      hands on that a round begins                                section 3.5
    ``flush``      hands its part's evidence up, when its children have        section 3.5
    ``freeze``     hands the team's evidence down, and holds the belief still  Table 1: the prior belief
    ``prepare``    lists its strategies, the present one among them            Table 1, step 1
    ``start``      sends its own impact                                        Table 1, step 2
    ``negotiate``  hears the rest of the team's impact, replies, sends again   Table 1, steps 3 to 6
    ``finished``   holds the strategy that the team has agreed on              Table 1, step 6, yes
    =============  ==========================================================  ==========================

    On links that lose nothing, everybody freezes the same belief. A child that does not answer in time is
    ``cut``, and the round goes on without its part of the tree.
    """

    mission: Mission[Any, Any, Any]
    scheme: str  # of `SCHEMES`
    tree: TreeChanged  # without who joined after it began, or was cut from it
    sequence: int
    depth: int  # links to the root
    heard: float  # when it last went on [s]
    forks: bool = False  # the token may fork
    weigh: Callable[[int, Any], Any] = lambda neighbour, impact: (
        impact
    )  # what a neighbour's impact counts for
    mandate: Callable[[], int] = lambda: 0  # digest of the orders that this robot holds
    waiting: set[int] = field(init=False)  # children that have not flushed yet
    notes: set[Note] = field(default_factory=set)  # told by children
    reaches: dict[int, Reach | None] = field(default_factory=dict)  # beyond each neighbour, as it told
    robots: dict[int, int] = field(default_factory=dict)  # behind each neighbour, as it told
    belief: Any = None
    approximate: bool = False  # this robot's belief is not the root's
    preparing: bool = False
    blocked: bool = False  # this robot plans with its mates in the way
    participant: RoundParticipant[Any, Any, Any] | None = None
    negotiator: Negotiator[Any] | None = None
    claimed: dict[int, Any] = field(
        default_factory=dict
    )  # the last impact from each neighbour, as it was told
    told: dict[int, Any] = field(default_factory=dict)  # the last impact to each neighbour
    early: list[tuple[int, Negotiate]] = field(default_factory=list)  # came before this robot was ready
    spoilt: set[int] = field(default_factory=set)  # neighbours whose word made no sense
    silences: Silences = field(default_factory=Silences)  # of neighbours, since the belief was frozen

    def __post_init__(self) -> None:
        self.waiting = set(self.children)

    @property
    def is_alone(self) -> bool:
        """Whether nobody else has part in it."""
        return self.sequence < 0

    @property
    def children(self) -> list[int]:
        """The neighbours further from the root."""
        return [k for k in self.tree.neighbours if k != self.tree.parent]

    @property
    def part(self) -> int:
        """Count the robots from this one on away from the root."""
        return min(1 + sum(self.robots.get(child, 0) for child in self.children), MOST_ROBOTS)

    @property
    def awaited(self) -> set[int]:
        """Whose answer this robot waits for; empty while it has to do something itself."""
        if self.negotiator is not None:
            return set(self.negotiator.waiting_for)
        if self.belief is not None:
            return set()
        return self.waiting or ({self.tree.parent} if self.tree.parent is not None else set())

    @property
    def digest(self) -> int:
        """Of what this robot plans on: the team's evidence, and the operator's orders."""
        return self.mission.fusion.digest ^ self.mandate()

    @property
    def finished(self) -> RoundOutcome | None:
        """What the team has agreed on; None while the round lasts."""
        return None if self.negotiator is None else self.negotiator.finished

    @property
    def replied(self) -> bool:
        """Whether this robot has had its say."""
        return self.negotiator is not None and self.negotiator.replied

    @property
    def goes_back(self) -> bool:
        """Whether it has ended by strategies of earlier, which the sums that were told last are not of."""
        return self.negotiator is not None and self.negotiator.goes_back

    @property
    def team_seen(self) -> Any:
        """The impact of the team's choice; None: this robot does not hold all of it."""
        whole = all(reach is None for reach in self._told(self.heard).values())
        return self.negotiator.team_held() if self.negotiator is not None and whole else None

    @property
    def claims(self) -> dict[int, Any]:
        """What each neighbour's side of the tree has claimed at last."""
        return {k: impact for k, impact in self.claimed.items() if k in self.tree.neighbours}

    # -- evidence comes together ------------------------------------------------------------------------

    def begin(self, message: Begin, now: float) -> list[Effect]:
        """Hand on that a round begins; without children, flush at once."""
        self.mission.publish(now)
        onwards = structs.replace(message, depth=min(message.depth + 1, MOST_DEPTH))
        return [*(say(child, onwards) for child in self.children), *self.flush(now)]

    def hear_flushed(self, sender: int, message: Flushed, now: float) -> list[Effect]:
        """Note that a child's part of the tree has been heard."""
        if sender not in self.waiting:
            return []
        self.waiting.discard(sender)
        self.notes.update(message.notes)
        self.reaches[sender] = message.reach
        self.robots[sender] = message.robots
        self.heard = now
        return self.flush(now)

    def flush(self, now: float) -> list[Effect]:
        """Hand this part's evidence up once all of it is here; at the root, all is known then: freeze it."""
        if self.waiting or self.belief is not None:
            return []
        notes = tuple(sorted(self.notes.union(self.mission.notes())))[:MOST_NOTES]
        epoch, parent = self.tree.epoch, self.tree.parent
        if parent is None:
            t0 = round(1000.0 * now)
            if isinstance(self.mission, Framing):
                frames = self.mission.lay_out()
                self.mission.take_frames(frames)
                message = FramedFreeze(epoch, self.sequence, t0, self.digest, self.part, notes, frames=frames)
                return self.freeze(message, now)
            return self.freeze(Freeze(epoch, self.sequence, t0, self.digest, self.part, notes), now)
        news = send_news(self.mission, parent, now)
        reach = self._told(now)[parent]
        return [*news, say(parent, Flushed(epoch, self.sequence, self.part, notes, reach))]

    def freeze(self, message: Freeze, now: float) -> list[Effect]:
        """Hand the team's evidence down, and freeze the belief: everything known has arrived.

        Raises:
            ValueError: a child has not been heard, so the root cannot have heard all.
        """
        if self.belief is not None:
            return []
        if self.waiting:
            raise ValueError(f"freeze: children {sorted(self.waiting)} have not been heard")
        agrees = True
        if (
            isinstance(message, FramedFreeze)
            and isinstance(self.mission, Framing)
            and self.tree.parent is not None
        ):
            agrees = self.mission.take_frames(message.frames)
        self.heard = now
        if self.tree.parent is not None:
            self.reaches[self.tree.parent] = message.reach
            self.robots[self.tree.parent] = max(message.robots - self.part, 1)
        told, effects = self._told(now), list[Effect]()
        for child in self.children:
            effects += send_news(self.mission, child, now)
            effects.append(say(child, structs.replace(message, reach=told[child])))
        if self.scheme == "token" and self.forks and message.robots >= FORK_FROM:
            self.scheme = "fork"  # all in the round hear the same number, so all do
        self.approximate = not agrees or self.digest != message.digest
        self.mission.hear_notes(message.notes)
        self.belief = self.mission.freeze(message.t0 / 1000.0)
        self.silences.begin(now)
        return effects

    def _told(self, now: float) -> dict[int, Areas | None]:
        return reaches_to_tell(self.mission.reach(now), self.reaches, self.tree.neighbours)

    # -- the team negotiates ----------------------------------------------------------------------------

    def prepare(self, pose: Pose, mates: list[Mate], blocked: bool, now: float) -> Job:
        """Return the job to do between freezing and negotiating; ``pose``: where the strategy will start."""
        self.preparing, self.blocked = True, blocked
        key, belief = (self.tree.epoch, self.sequence), self.belief
        return Job(key, lambda: self.mission.prepare(belief, pose, mates, blocked, now))

    def start(self, now: float) -> list[Effect]:
        """Send the own impact, by the scheme's first message."""
        self.heard = now
        self.participant = RoundParticipant(self.mission, self.belief)
        links, parent, own = self.tree.neighbours, self.tree.parent, self.participant
        bounded = {k: reach for k, reach in self.reaches.items() if reach is not None}
        claims = Claims(self.robots, partial(self.mission.admit, self.belief))
        sweeps = MAX_SWEEPS if self.scheme != "fork" else MAX_FORKS
        self.negotiator = node_of(
            self.scheme, links, parent, own, max_sweeps=sweeps, reaches=bounded, claims=claims
        )
        return self._replies(self.negotiator.start())

    def negotiate(self, sender: int, message: Negotiate, now: float) -> list[Effect]:
        """Hear of the rest of the team, and reply; what comes too early waits."""
        if self.negotiator is None:
            if sum(early == sender for early, _ in self.early) < MOST_EARLY:
                self.early.append((sender, message))
            return []
        said = messages.decode(message.data, self.mission.codec)
        replies = self.negotiator.receive(sender, self._weighed(sender, said))
        if (impact := getattr(said, "mu", None)) is not None:
            self.claimed[sender] = impact
        self.heard = now
        return self._replies(replies)

    def _weighed(self, sender: int, said: messages.Message[Any]) -> messages.Message[Any]:
        """Return what a neighbour says, its impact as much as it counts for."""
        impact = getattr(said, "mu", None)
        if impact is None or (counts := self.weigh(sender, impact)) is impact:
            return said
        weighed = structs.replace(said, mu=counts)
        if isinstance(weighed, messages.Gather):
            weighed = structs.replace(weighed, value=self.mission.objective.value(self.belief, counts))
        return weighed

    def take_early(self) -> list[tuple[int, Negotiate]]:
        """Return the negotiation messages, with their senders, that came before this robot was prepared."""
        if self.negotiator is None:
            return []
        early, self.early = self.early, []
        return early

    def _replies(self, replies: Sequence[Reply[Any]]) -> list[Effect]:
        epoch, codec = self.tree.epoch, self.mission.codec
        for reply in replies:
            if (impact := getattr(reply.message, "mu", None)) is not None:
                self.told[reply.to] = impact
        return [
            say(reply.to, Negotiate(epoch, self.sequence, messages.encode(reply.message, codec)))
            for reply in replies
        ]

    # -- somebody is silent -----------------------------------------------------------------------------

    def cut(self, child: int, now: float) -> list[Effect]:
        """Go on without a child and all behind it."""
        self.heard = now
        self.waiting.discard(child)
        self.reaches.pop(child, None)
        self.robots.pop(child, None)
        self.tree = replace(self.tree, neighbours=tuple(k for k in self.tree.neighbours if k != child))
        return self.flush(now) if self.negotiator is None else self._replies(self.negotiator.cut(child))

    def go_on_alone(self, now: float) -> list[Effect]:
        """Choose alone, on the belief that all have frozen: the rest of the team is silent."""
        self.tree = replace(self.tree, parent=None, neighbours=())
        return self.start(now)


def say(to: int, message: Call | Begin | Flushed | Freeze | Negotiate) -> Send:
    """Return a message of a round to a neighbour."""
    return Send(to, TrafficKind.NEGOTIATION, encode(message))


def send_news(mission: Mission[Any, Any, Any], neighbour: int, now: float) -> list[Effect]:
    """Return what a neighbour lacks of the evidence, if anything."""
    data = mission.fusion.outgoing(neighbour, now)
    return [] if data is None else [Send(neighbour, TrafficKind.FUSION, encode(Evidence(data)))]
