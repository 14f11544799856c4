"""A toy mission that really discovers: sites that are seen when visited, and lead on to others.

What a robot tells others says where it comes from: impacts name their contributors and the round that they
were made in, notes name round and robot. So whoever mixes rounds, or counts a robot twice, is caught at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Route
from vedette.agent.events import Pose, Sensed
from vedette.agent.mates import Mate
from vedette.agent.messages import Note
from vedette.agent.round import MOST_NOTES
from vedette.fusion.replicated_map import ReplicatedMap
from vedette.kernels.tiles import TiledGrid, Tiling
from vedette.maps import FREE, GridFrame
from vedette.problem import Coverage

FRAME = GridFrame(0.5, 40, 40)  # four tiles
SPEED = 2.0  # of all robots [m/s]
NEAR = 0.3  # a site is seen from so far [m]
TAU = 20.0  # a site seen so much later is worth 1/e [s]
LEAST_GAIN = 0.02  # for which a robot takes up a strategy
PASSABLE = np.ones(FRAME.shape, np.bool_)

Float = NDArray[np.float64]
Stamp = tuple[int, int]  # epoch and sequence number of a round
Life = tuple[int, int]  # robot and boot


class LawBroken(AssertionError):
    """Something happened that no fault may bring about."""


def check(holds: bool, law: str, *about: object) -> None:
    """Raise ``LawBroken`` unless a law holds."""
    if not holds:
        raise LawBroken(f"{law}: {', '.join(map(str, about))}")


@dataclass(frozen=True, eq=False)
class Sites:
    """Where the sites are, what leads to them, and who can go there."""

    cells: NDArray[np.int64]  # (S,) flat, each seen as this cell and, by some robots otherwise, the next
    before: NDArray[np.int64]  # (S,) the site from which each is discovered; -1: known from the start
    allowed: NDArray[np.bool_]  # (n, S) robots that can reach it; some sites nobody can

    @classmethod
    def random(cls, robots: int, sites: int, rng: np.random.Generator) -> Sites:
        """Scatter sites; a third of them are known from the start."""
        cells = np.sort(rng.choice(FRAME.rows * FRAME.cols // 2, sites, replace=False)) * 2
        order = rng.permutation(sites)
        before = np.full(sites, -1)
        for k in range(1 + sites // 3, sites):
            before[order[k]] = order[rng.integers(k)]
        allowed = rng.random((robots, sites)) < rng.uniform(0.4, 1.0)
        allowed[:, rng.random(sites) < 0.1] = False
        return cls(cells, before, allowed)

    def place(self, site: int) -> tuple[float, float]:
        """Return where a site is [m]."""
        row, col = divmod(int(self.cells[site]), FRAME.cols)
        return (col + 0.5) * FRAME.resolution, (row + 0.5) * FRAME.resolution

    def seen(self, classes: NDArray[np.uint8]) -> NDArray[np.bool_]:
        """Return which sites a map shows."""
        return np.asarray(classes.ravel()[self.cells] == FREE)

    def is_seen(self, site: int, classes: NDArray[np.uint8]) -> bool:
        """Tell whether a map shows a site."""
        return bool(classes.flat[int(self.cells[site])] == FREE)

    def open_to(self, robot: int, seen: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Return the sites that a robot could go to, as far as it knows."""
        discovered = (self.before < 0) | seen[self.before]
        return np.flatnonzero(self.allowed[robot] & discovered & ~seen)

    def misses(self, x: float, y: float, site: int) -> Float:
        """``(S,)``: what is missed if a robot goes from here to a site; the later, the more."""
        miss = np.ones(len(self.cells))
        there = self.place(site)
        miss[site] = 1.0 - math.exp(-math.hypot(there[0] - x, there[1] - y) / SPEED / TAU)
        return miss


@dataclass(frozen=True, eq=False)
class Impact:
    """Misses of sites, by whom and in which round; ``None``: by nobody."""

    miss: Float  # (S,)
    who: frozenset[Life] = frozenset()
    stamp: Stamp | None = None

    def joined(self, other: Impact) -> Impact:
        """Return both together; of different rounds, or of one robot twice, they break the law."""
        stamps = {self.stamp, other.stamp} - {None}
        check(len(stamps) <= 1, "impacts of two rounds are combined", stamps)
        check(not self.who & other.who, "a robot's impact is counted twice", self.who, other.who)
        return Impact(self.miss * other.miss, self.who | other.who, self.stamp or other.stamp)


class ImpactCodec:
    """Impacts as MessagePack."""

    bound = 1 << 20

    def encode(self, impact: Impact) -> bytes:
        """Return who, round, misses."""
        return msgspec.msgpack.encode((sorted(impact.who), impact.stamp, impact.miss.tobytes()))

    def decode(self, payload: bytes) -> Impact:
        """Return the impact."""
        who, stamp, miss = msgspec.msgpack.decode(payload, type=tuple[frozenset[Life], Stamp | None, bytes])
        return Impact(np.frombuffer(miss, np.float64), who, stamp)


@dataclass(frozen=True, eq=False)
class Belief:
    """What a round is planned on."""

    stamp: Stamp
    digest: int
    seen: NDArray[np.bool_]  # (S,)


def weights_of(belief: Belief) -> Float:
    """``(S,)``: 1 for each site not seen yet."""
    return (~belief.seen).astype(np.float64)


def worth(belief: Belief, miss: Float) -> float:
    """Return how many sites not seen yet will be, the later the less."""
    return Coverage().value(weights_of(belief), miss)


Published = Callable[[Life, int, NDArray[np.int8], NDArray[np.int64]], None]


@dataclass(eq=False)
class SiteMission:
    """One robot's share; ``vedette.agent.mission.GroundMission``. Strategies are sites."""

    life: Life
    sites: Sites
    fusion: ReplicatedMap[Any]
    published: Published  # is told each version of the robot's evidence
    suffers: bool = False  # from somebody who says what is not so
    stamp: Callable[[], Stamp] = field(init=False)  # of the round going on
    codec: ImpactCodec = field(default_factory=ImpactCodec)
    strategy: int | None = None
    own: NDArray[np.int8] = field(init=False)  # (R, C) log-odds
    counts: NDArray[np.int64] = field(init=False)  # (S,) how often this robot has seen each site
    last: Belief | None = None  # of the latest round; the impacts are of that round too
    initial: Impact | None = None  # own
    present: Impact | None = None  # own
    whole: Impact | None = None  # of the whole team, as this robot last knew it
    _dirty: list[int] = field(default_factory=list)
    _candidates: dict[int, Float] = field(default_factory=dict)
    _version: int = 0

    def __post_init__(self) -> None:
        self.own = TiledGrid(Tiling(*FRAME.shape), np.int8)
        self.counts = np.zeros(len(self.sites.cells), np.int64)

    # -- evidence ------------------------------------------------------------------------------------

    @property
    def platform(self) -> SiteMission:
        """Itself."""
        return self

    @property
    def objective(self) -> SiteMission:
        """Itself."""
        return self

    def observe(self, seen: Sensed, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """See sites; what is beside them looks otherwise to robots of odd number."""
        assert isinstance(seen.data, list)
        for site in seen.data:
            cell = int(self.sites.cells[site])
            pair = -10, 10 if self.life[0] % 2 else -1
            self.own.put(np.array((cell, cell + 1)), np.array(pair, np.int8))
            self.counts[site] += 1
            self._dirty.append(cell)

    def publish(self, now: float) -> None:
        """Publish what was seen since the last time."""
        if not self._dirty:
            return
        cells = np.array(sorted({cell + k for cell in self._dirty for k in (0, 1)}), np.int64)
        self._dirty.clear()
        self.fusion.publish(self.own, cells, self.counts)
        self._version += 1
        self.published(self.life, self._version, self.own.window(), self.counts.copy())

    # -- rounds --------------------------------------------------------------------------------------

    def notes(self) -> list[Note]:
        """Tell of the robot and the round."""
        epoch, sequence = self.stamp()
        return [(self.life[0], sequence, epoch)]

    def hear_notes(self, notes: Sequence[Note]) -> None:
        """All notes are of this round, and this robot's own is among them."""
        stamp = self.stamp()
        if self.suffers:
            return
        check({(epoch, k) for _, k, epoch in notes} == {stamp}, "notes of another round", notes, stamp)
        told = [robot for robot, _, _ in notes]
        there = self.life[0] in told or len(told) == MOST_NOTES
        check(there, "a round goes on with who was cut from it", self.life, notes)

    def freeze(self, t0: float) -> Belief:
        """Remember which round it is, and which sites are seen."""
        seen = self.sites.seen(self.fusion.classes.window())
        self.last = Belief(self.stamp(), self.fusion.digest, seen)
        return self.last

    def prepare(self, belief: Belief, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float) -> None:
        """List the sites that this robot could go to."""
        reachable = self.sites.open_to(self.life[0], belief.seen).tolist()
        self._candidates = {site: self.sites.misses(pose.x, pose.y, site) for site in reachable}
        self.initial = self.whole = None
        if self.strategy not in self._candidates:
            self.strategy = None

    def impact(self, belief: Belief, strategy: int | None) -> Impact:
        """Return what going to a site would achieve."""
        miss = self._candidates.get(-1 if strategy is None else strategy)
        ones = np.ones(len(self.counts))
        self.present = Impact(ones if miss is None else miss, frozenset((self.life,)), belief.stamp)
        self.initial = self.initial or self.present
        return self.present

    def reply(self, belief: Belief, others: Impact, current: int | None) -> int | None:
        """Return the best site, if it is strictly better and worth going to at all."""
        check(others.stamp in (None, belief.stamp), "a reply to another round", others.stamp, belief.stamp)
        check(self.life not in others.who, "a robot replies to itself", self.life, others.who)
        left = weights_of(belief) * others.miss
        gains = {site: float(left @ (1.0 - miss)) for site, miss in self._candidates.items()}
        least = LEAST_GAIN if current is None else gains.get(current, 0.0) + 1e-9
        best = max(gains, key=gains.__getitem__, default=None)
        return best if best is not None and gains[best] > least else current

    def nothing(self, belief: Belief) -> Impact:
        """Return nobody's impact."""
        return Impact(np.ones(len(self.counts)))

    def combine(self, a: Impact, b: Impact) -> Impact:
        """Return both together."""
        return a.joined(b)

    def value(self, belief: Belief, impact: Impact) -> float:
        """Return the share of what is not seen yet that will be, in sites."""
        return worth(belief, impact.miss)

    def price(self, impact: Impact) -> float:
        """Return nothing: sites are free."""
        return 0.0

    def gross(self, belief: Belief, impact: Impact) -> float:
        """Return the value."""
        return self.value(belief, impact)

    def slack(self, belief: Belief, base: Impact) -> float:
        """Return the most that a site adds."""
        self.whole = base
        left = weights_of(belief) * base.miss
        return max((float(left @ (1.0 - miss)) for miss in self._candidates.values()), default=0.0)

    def reach(self, now: float) -> None:
        """Anywhere."""

    def admit(self, belief: Belief, impact: Impact, robots: int) -> None:
        """No more robots have made it than there are."""
        if len(impact.who) > robots:
            raise ValueError(f"impact of {len(impact.who)} robots, {robots} are there")

    def nothing_left(self, value: float, now: float) -> bool:
        """Nobody goes anywhere."""
        return value <= 0.0

    # -- driving -------------------------------------------------------------------------------------

    def goal(self) -> tuple[float, float] | None:
        """Return where the site is."""
        return None if self.strategy is None else self.sites.place(self.strategy)

    def served(self) -> bool:
        """Tell whether somebody has been there."""
        return self.strategy is not None and bool(
            self.sites.seen(self.fusion.classes.window())[self.strategy]
        )

    def reached(self, pose: Pose, mates: Sequence[Mate], now: float) -> bool:
        """On to nothing."""
        self.strategy = None
        return True

    def stand_by(self) -> None:
        """Drop it."""
        self.strategy = None

    def release(self, now: float) -> None:
        """Drop it."""
        self.strategy = None

    def route(
        self, pose: Pose, goal: tuple[float, float], mates: Sequence[Mate], blocked: bool, now: float
    ) -> Route | None:
        """Straight there."""
        return Route(np.array([(pose.x, pose.y), goal]), PASSABLE, FRAME)
