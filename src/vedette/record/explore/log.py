"""The run log: what a mission leaves in memory for its pictures, and hands on to live outputs."""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.agent.orders import Order
from vedette.domains.mapping.belief import planning_factor
from vedette.maps import GridFrame
from vedette.maps.world import World
from vedette.missions.explore.expected import Expected, Progress
from vedette.record.explore.frames import FramesFound
from vedette.record.explore.summary import LeftOut
from vedette.record.links import Link, parts
from vedette.record.log import MissionScene, Sink, VehicleSample

_FULL = 255  # impacts are kept as whole 255ths


@dataclass(frozen=True, kw_only=True)
class ExploreScene(MissionScene):
    """What stays the same all through an exploration."""

    frame: GridFrame  # of the map
    planning: GridFrame  # of the planning cells over it

    @classmethod
    def of(cls, world: World, robots: Iterable[str]) -> ExploreScene:
        """Return the scene of robots, by their names, in a world."""
        planning = world.frame.coarse(planning_factor(world.frame.resolution))
        return cls(name=world.name, vehicles=tuple(robots), frame=world.frame, planning=planning)


class Ahead(NamedTuple):
    """A stop of a robot's tour, as it means to make it."""

    x: float  # of the frontier that it goes to see [m], team frame
    y: float
    after: float  # so long from now [s]
    reveals: float  # unknown ground near it, when it was planned [m^2]


@dataclass(frozen=True, eq=False)
class RobotSample(VehicleSample):
    """One robot at one moment."""

    name: str
    goal: tuple[float, float] | None  # where it is going [m], team frame
    driven: float = 0.0  # the way that it has come [m]
    tour: tuple[Ahead, ...] = ()  # where it means to look
    way_left: float | None = None  # that its energy is good for [m]; None: nobody says
    rounds: int = 0  # that it has ended with a decision
    sent: int = 0  # [byte], of all kinds
    orders: tuple[Order, ...] = ()  # of the operator, that it holds
    trust: str = ""  # who believes it; empty: nobody signs what it says


@dataclass(frozen=True, eq=False)
class ExploreSnapshot:
    """The mission at one moment of simulated time."""

    t: float  # [s]
    robots: tuple[RobotSample, ...]  # in the order of the team
    coverage: float | None  # share of the coverable cells that the living robots know, 0..1; None: as below
    known_fraction: float | None  # share of all cells of the frame that are known, 0..1
    entropy: float | None  # of the team map [nat]; None: nobody knows how much ground there is
    classes: NDArray[np.uint8]  # (R, C) UNKNOWN, FREE or OCCUPIED
    impact: (
        NDArray[np.float32] | None
    )  # (r, c) probability that the present strategies observe a planning cell
    links: tuple[Link, ...] | None = None  # None: the network is ideal
    known_m2: float = 0.0  # that the living robots know
    frontiers: int | None = None  # where to go on, as of the latest round; None: there has been none
    left_out: tuple[LeftOut, ...] = ()  # where robots do not go on, and why
    frames: FramesFound | None = None  # whose maps are joined by now; None: all share one frame
    expected: Expected | None = None  # of its further course; None: it is too early to say, or all is over

    @property
    def progress(self) -> Progress:
        """How far it has come, as the living robots know it themselves."""
        living = [robot for robot in self.robots if robot.alive]
        way = sum(robot.driven for robot in living) / max(len(living), 1)
        return Progress(self.t, self.known_m2, self.frontiers, way, len(living))

    @property
    def rate_m2_s(self) -> float:
        """Ground that has become known in a second, from the beginning on [m^2/s]."""
        return self.known_m2 / self.t if self.t > 0.0 else 0.0

    @property
    def parts(self) -> tuple[tuple[int, ...], ...]:
        """The living robots in groups, each on a tree of its own; more than one: the team is apart."""
        return parts([robot.alive for robot in self.robots], self.links)


@dataclass(frozen=True, eq=False)
class _Packed:
    """A snapshot with its grids compressed."""

    snapshot: ExploreSnapshot  # its grids are empty
    classes: bytes
    impact: bytes | None

    @property
    def size(self) -> int:
        return len(self.classes) + len(self.impact or b"")


class ExploreLog:
    """Curves and poses of every snapshot; grids of as many as ``budget`` bytes hold, evenly spaced.

    Grids are compressed as they come, so a 4000 x 4000 map costs some 0.2 MB a snapshot. When the budget is
    spent, every second stored snapshot goes and from then on half as many are stored; the last one added is
    always there. A log of ``curves_only`` keeps no grid, and its snapshots have none.
    """

    def __init__(
        self,
        scene: ExploreScene,
        sinks: Sequence[Sink[ExploreSnapshot]] = (),
        budget: int = 64 << 20,
        *,
        curves_only: bool = False,
    ) -> None:
        """Start an empty log of a team; every snapshot is forwarded to the ``sinks``."""
        self.curves_only = curves_only
        self.scene = scene
        self._sinks = tuple(sinks)
        self._budget = budget
        self._curves: list[tuple[float, ...]] = []
        self._poses: list[list[tuple[float, float, float]]] = []
        self._driven: list[list[float]] = []
        self._stored: list[_Packed] = []  # every `_stride`-th snapshot
        self._stored_bytes = 0
        self._stride = 1
        self._last: _Packed | None = None

    def add(self, snapshot: ExploreSnapshot) -> None:
        """Keep a snapshot and forward it; the caller may reuse its arrays afterwards.

        Raises ``ValueError`` for another team, other grids, or a time before the last.
        """
        self._check(snapshot)
        if not self.curves_only:
            self._pack(snapshot)
        self._curves.append(
            (
                snapshot.t,
                _or_nan(snapshot.coverage),
                _or_nan(snapshot.known_fraction),
                _or_nan(snapshot.entropy),
                len(snapshot.parts) > 1,
                snapshot.known_m2,
                _or_nan(snapshot.frontiers),
            )
        )
        self._poses.append([(robot.x, robot.y, robot.heading) for robot in snapshot.robots])
        self._driven.append([robot.driven for robot in snapshot.robots])
        for sink in self._sinks:
            sink.update(snapshot)

    def __len__(self) -> int:
        """Count the snapshots added."""
        return len(self._curves)

    @property
    def times(self) -> NDArray[np.float64]:
        """``(T,)`` times of all snapshots [s]."""
        return self._curve(0)

    @property
    def coverage(self) -> NDArray[np.float64]:
        """``(T,)`` coverage of all snapshots, 0..1; NaN where nobody knows the ground, as below."""
        return self._curve(1)

    @property
    def known_fraction(self) -> NDArray[np.float64]:
        """``(T,)`` known share of the frame of all snapshots, 0..1."""
        return self._curve(2)

    @property
    def entropy(self) -> NDArray[np.float64]:
        """``(T,)`` entropy of the team map of all snapshots [nat]."""
        return self._curve(3)

    @property
    def apart(self) -> NDArray[np.bool_]:
        """``(T,)`` whether the living robots were on more than one tree, of all snapshots."""
        return self._curve(4) > 0

    @property
    def known_m2(self) -> NDArray[np.float64]:
        """``(T,)`` ground that the living robots know in all snapshots [m^2]."""
        return self._curve(5)

    @property
    def frontiers(self) -> NDArray[np.float64]:
        """``(T,)`` where to go on as of the latest round, in all snapshots; NaN before the first."""
        return self._curve(6)

    @property
    def poses(self) -> NDArray[np.float64]:
        """``(T, n, 3)`` x, y, heading of each robot in all snapshots [m, m, rad], team frame."""
        return np.array(self._poses, dtype=np.float64).reshape(len(self), len(self.scene.vehicles), 3)

    @property
    def path_length(self) -> NDArray[np.float64]:
        """``(T, n)`` way that each robot has come [m]."""
        return np.array(self._driven, dtype=np.float64).reshape(len(self), len(self.scene.vehicles))

    def snapshots(self) -> Iterator[ExploreSnapshot]:
        """Yield the stored snapshots in order, the last one added included; impacts to within 1/510."""
        for packed in self._kept():
            yield self._unpack(packed)

    @property
    def last(self) -> ExploreSnapshot:
        """The last snapshot; ``ValueError`` if there is none."""
        if self._last is None:
            raise ValueError("the log is empty, or of curves only: add a snapshot to one that keeps them")
        return self._unpack(self._last)

    def stored(self) -> int:
        """Count what `snapshots` yields."""
        return len(self._kept())

    def stages(self, n: int = 3) -> list[ExploreSnapshot]:
        """Return the first stored snapshot at each of 1/n, 2/n, ... of what is known last, then the last.

        Known is the coverage, or where nobody knows it the area.
        """
        last, kept = self.last, self._kept()
        known = np.maximum.accumulate([_known(packed.snapshot) for packed in kept])
        levels = known[-1] * np.arange(1, n) / n
        first = np.searchsorted(known, levels - 1e-12)
        return [*(self._unpack(kept[i]) for i in first), last]

    def _pack(self, snapshot: ExploreSnapshot) -> None:
        self._last = _pack(snapshot)
        if len(self._curves) % self._stride == 0:
            self._store(self._last)

    def _check(self, snapshot: ExploreSnapshot) -> None:
        names, scene = tuple(robot.name for robot in snapshot.robots), self.scene
        if names != scene.vehicles:
            raise ValueError(f"the log is of {scene.vehicles}; got a snapshot of {names}")
        if snapshot.classes.shape != scene.frame.shape:
            raise ValueError(f"classes must be {scene.frame.shape}; got {snapshot.classes.shape}")
        if snapshot.impact is not None and snapshot.impact.shape != scene.planning.shape:
            raise ValueError(f"impact must be {scene.planning.shape}; got {snapshot.impact.shape}")
        if self._curves and snapshot.t < self._curves[-1][0]:
            raise ValueError(
                f"snapshots come in order of time; got {snapshot.t} s after {self._curves[-1][0]} s"
            )

    def _store(self, packed: _Packed) -> None:
        self._stored.append(packed)
        self._stored_bytes += packed.size
        while self._stored_bytes > self._budget and len(self._stored) > 2:
            self._stored = self._stored[::2]
            self._stored_bytes = sum(kept.size for kept in self._stored)
            self._stride *= 2

    def _kept(self) -> list[_Packed]:
        if self._last is None or (self._stored and self._stored[-1] is self._last):
            return self._stored
        return [*self._stored, self._last]

    def _curve(self, column: int) -> NDArray[np.float64]:
        return np.array(self._curves, dtype=np.float64).reshape(-1, 7)[:, column]

    def _unpack(self, packed: _Packed) -> ExploreSnapshot:
        classes = np.frombuffer(zlib.decompress(packed.classes), np.uint8).reshape(self.scene.frame.shape)
        impact: NDArray[np.float32] | None = None
        if packed.impact is not None:
            level = np.frombuffer(zlib.decompress(packed.impact), np.uint8).reshape(self.scene.planning.shape)
            impact = level.astype(np.float32) / np.float32(_FULL)
        return replace(packed.snapshot, classes=classes, impact=impact)


_EMPTY = np.empty((0, 0), np.uint8)


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else value


def _known(snapshot: ExploreSnapshot) -> float:
    return snapshot.known_m2 if snapshot.coverage is None else snapshot.coverage


def _pack(snapshot: ExploreSnapshot) -> _Packed:
    """Compress the grids; level 1 is within a fifth of the best size here and ten times as fast."""
    impact = None
    if snapshot.impact is not None:
        level = np.rint(np.clip(snapshot.impact, 0.0, 1.0) * _FULL).astype(np.uint8)
        impact = zlib.compress(level.tobytes(), 1)
    thin = replace(snapshot, classes=_EMPTY, impact=None)
    return _Packed(thin, zlib.compress(np.ascontiguousarray(snapshot.classes).data, 1), impact)
