"""A team of agents on a toy mission, and links that lose whatever a test wants lost."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from vedette import Tree
from vedette.agent import Agent, GroundBehaviour, State, messages, step
from vedette.agent.driving import Driver
from vedette.agent.effects import Drive, Job, Route, Send, TrafficKind
from vedette.agent.events import Event, JobDone, Message, Pose, Scan, TreeChanged
from vedette.agent.mates import Mate
from vedette.agent.messages import Wire
from vedette.fusion import Fusion, ReplicatedEvidence
from vedette.maps import GridFrame
from vedette.negotiation import Chooser
from vedette.problem import Codec, Coverage
from vedette.team import PlatformSpec

Float = NDArray[np.float64]
FRAME = GridFrame(0.1, 40, 40)
DELAY = 0.02  # of a link [s]
JOB_TIME = 0.03  # [s]
KINDS = ("Gather", "Token", "Up", "Down", "Stop", "Fork", "Joined", "Settled", "Offer", "Tidings")


class FloatCodec:
    """Impacts of a fixed number of cells as plain bytes."""

    bound = 8 * 12

    def encode(self, impact: Float) -> bytes:
        """Eight bytes a cell."""
        return impact.tobytes()

    def decode(self, payload: bytes) -> Float:
        """The array; ValueError if it has another size or is no miss probability."""
        impact = np.frombuffer(payload, np.float64)
        if len(impact) != 12 or not ((impact >= 0) & (impact <= 1)).all():
            raise ValueError("not 12 miss probabilities")
        return impact


@dataclass(eq=False)
class ToyMission:
    """Choose one of a few candidate impacts; the goal is a point for each choice."""

    fusion: Fusion
    candidates: list[Float]
    belief: Float
    codec: Codec[Float] = field(default_factory=FloatCodec)
    strategy: int | None = None
    goals: list[tuple[float, float]] = field(default_factory=list)
    released: int = 0
    prepared: int = 0
    blocked: list[bool] = field(default_factory=list)
    observed: int = 0
    frozen_at: list[float] = field(default_factory=list)
    put_off: bool = False
    no_way: bool = False

    def __post_init__(self) -> None:
        self.objective = Coverage()

    @property
    def platform(self) -> ToyMission:
        """Itself."""
        return self

    def observe(self, scan: Scan, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Count."""
        self.observed += 1

    def publish(self, now: float) -> None:
        """Nothing is seen on this mission."""

    def notes(self) -> list[tuple[int, int, int]]:
        """Nothing to tell."""
        return []

    def hear_notes(self, notes: Sequence[tuple[int, int, int]]) -> None:
        """Nothing to hear."""

    def freeze(self, t0: float) -> Float:
        """The belief is always the same."""
        self.frozen_at.append(t0)
        return self.belief

    def prepare(self, belief: Float, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float) -> None:
        """Note the call."""
        self.prepared += 1
        self.blocked.append(blocked)

    def _chooser(self, belief: Float, strategy: int | None) -> Chooser[Float, Float]:
        return Chooser(self.objective, belief, self.candidates, start=strategy)

    def impact(self, belief: Float, strategy: int | None) -> Float:
        """Of a candidate; nothing without one."""
        return self._chooser(belief, strategy).impact

    def reply(self, belief: Float, others: Float, current: int | None) -> int | None:
        """As a chooser replies."""
        chooser = self._chooser(belief, current)
        chooser.reply(others)
        return chooser.index

    def slack(self, belief: Float, base: Float) -> float:
        """Of the candidates."""
        return self._chooser(belief, None).slack(base)

    def goal(self) -> tuple[float, float] | None:
        """A point for each candidate."""
        if self.strategy is None or not self.goals:
            return None
        return self.goals[self.strategy % len(self.goals)]

    def served(self) -> bool:
        """Never."""
        return False

    def reached(self, pose: Pose, mates: Sequence[Mate], now: float) -> bool:
        """On to nothing."""
        self.strategy = None
        return True

    def stand_by(self) -> None:
        """Drop it."""
        self.strategy = None

    def release(self, now: float) -> None:
        """Drop it."""
        self.released += 1
        self.strategy = None

    def reach(self, now: float) -> None:
        """Anywhere."""

    def admit(self, belief: Any, impact: Float, robots: int) -> None:
        """As many points as there are can be claimed."""

    def nothing_left(self, value: float, now: float) -> bool:
        """As the value and the test say."""
        return value <= 0.0 and not self.put_off

    def route(
        self, pose: Pose, goal: tuple[float, float], mates: Sequence[Mate], blocked: bool, now: float
    ) -> Route | None:
        """Straight there, on a map without walls."""
        if self.no_way:
            return None
        return Route(np.array([(pose.x, pose.y), goal]), np.ones(FRAME.shape, np.bool_), FRAME)


def toy_agent(
    robot: int, candidates: list[Float], belief: Float, scheme: str = "token", *, forks: bool = False
) -> Agent:
    """An agent on a toy mission."""
    fusion = ReplicatedEvidence(robot, 1, FRAME.shape, 4)
    spec = PlatformSpec(name=f"robot-{robot + 1}")
    mission = ToyMission(fusion, candidates, belief)
    return Agent(robot, 1, spec, GroundBehaviour(mission, Driver(robot, spec)), scheme, forks=forks)


def toy(agent: Agent) -> ToyMission:
    """An agent's mission as the toy it is."""
    assert isinstance(agent.mission, ToyMission)
    return agent.mission


def ground(agent: Agent) -> GroundBehaviour:
    """An agent's behaviour as the one on the ground that it is."""
    assert isinstance(agent.behaviour, GroundBehaviour)
    return agent.behaviour


def state(agent: Agent) -> State:
    """What a robot is doing now."""
    return agent.state


@dataclass(frozen=True)
class Post:
    """A message as it was sent."""

    time: float
    sender: int
    to: int
    traffic: TrafficKind
    message: Wire


Lose = Callable[[Post], bool]


def keep(post: Post) -> bool:
    """Lose nothing."""
    return False


class Team:
    """Agents that stand still ten metres apart, their tree, and the post between them."""

    def __init__(self, agents: Sequence[Agent], tree: Tree, lose: Lose = keep) -> None:
        """Plant the tree; robot 0 is the root."""
        self.agents = list(agents)
        self.alive = [True] * len(agents)
        self.kept: set[int] = set()  # those whom somebody keeps from work
        self.lose = lose
        self.log: list[Post] = []
        self.driven: list[list[Drive]] = [[] for _ in agents]
        self.now = 0.0
        self._queue: list[tuple[float, int, int, Event]] = []
        self._count = itertools.count()
        self._tick = 0.0
        self._epoch = 0
        self.plant(tree, list(range(len(agents))))

    def plant(self, tree: Tree, robots: Sequence[int]) -> None:
        """Put these robots on a new tree, the first the root."""
        self._epoch += 1
        parents = tree.parents(0)
        for place, robot in enumerate(robots):
            parent = parents[place]
            event = TreeChanged(
                self._epoch,
                None if parent is None else robots[parent],
                tuple(robots[k] for k in tree.neighbours(place)),
                len(robots),
            )
            self.tell(robot, event)

    def tell(self, robot: int, *events: Event) -> None:
        """Let a robot take in events now."""
        for effect in step(self.agents[robot], events, self.now):
            match effect:
                case Send(to, traffic, payload):
                    post = Post(self.now, robot, to, traffic, messages.decode(payload))
                    self.log.append(post)
                    if not self.lose(post):
                        self._later(DELAY, to, Message(robot, payload))
                case Drive():
                    self.driven[robot].append(effect)
                case Job(key, run):
                    run()
                    self._later(JOB_TIME, robot, JobDone(key))

    def _later(self, delay: float, robot: int, event: Event) -> None:
        self._queue.append((self.now + delay, next(self._count), robot, event))
        self._queue.sort(key=lambda entry: entry[:2])

    def run(self, seconds: float) -> None:
        """Let time pass: poses ten times a second, messages as they arrive."""
        end = self.now + seconds
        while min(self._tick, self._queue[0][0] if self._queue else np.inf) < end - 1e-9:
            self._happen()
        self.now = end

    def run_until(self, condition: Callable[[], bool]) -> None:
        """Let time pass until a condition holds; 5 s at most."""
        end = self.now + 5.0
        while not condition() and self.now < end:
            self._happen()

    def _happen(self) -> None:
        """Let the next thing happen."""
        if self._queue and self._queue[0][0] < self._tick:
            self.now, _, robot, event = self._queue.pop(0)
            if self.alive[robot]:
                self.tell(robot, event)
            return
        self.now = self._tick
        self._tick += 0.1
        for robot in range(len(self.agents)):
            if self.alive[robot]:
                self.tell(robot, Pose(1.0 + 10.0 * robot, 1.0, 0.0, at_work=robot not in self.kept))

    def run_round(self) -> None:
        """Let time pass until everybody has decided once more; 5 s at most."""
        before = self.decisions()
        self.run_until(lambda: all(now > then for now, then in zip(self.decisions(), before, strict=True)))

    def decisions(self) -> list[int]:
        """How many rounds each robot has ended with a decision."""
        return [agent.rounds.decisions for agent in self.agents]

    def choices(self) -> tuple[int | None, ...]:
        """What each robot has chosen."""
        return tuple(agent.mission.strategy for agent in self.agents)

    def negotiation(self, since: float = 0.0) -> list[Post]:
        """Negotiation messages sent since a time."""
        return [p for p in self.log if p.traffic is TrafficKind.NEGOTIATION and p.time >= since]


def toy_team(
    tree: Tree, seed: int = 0, scheme: str = "token", lose: Lose = keep, *, forks: bool = False
) -> tuple[Team, list[list[Float]], Float]:
    """A team with random candidates; also the candidates and the belief."""
    rng = np.random.default_rng(seed)
    misses = rng.uniform(size=(tree.n, 4, 12))
    misses[rng.uniform(size=misses.shape) < 0.2] = 0.0
    misses[rng.uniform(size=misses.shape) < 0.4] = 1.0
    candidates = [list(own) for own in misses]
    belief = rng.uniform(0.5, 1.0, size=12)
    agents = [toy_agent(i, candidates[i], belief, scheme, forks=forks) for i in range(tree.n)]
    return Team(agents, tree, lose), candidates, belief


def nested_kind(post: Post) -> str:
    """Name a message's kind; of a negotiation message, the kind of what it carries."""
    if not isinstance(post.message, messages.Negotiate):
        return type(post.message).__name__
    tag = msgspec.msgpack.decode(post.message.data)[0]
    return KINDS[tag]
