"""Targets with a state of their own: every way of fusing, the overlay, and a reliable link."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Protocol

import numpy as np

from tests.fuzz.keep import Kept
from tests.fuzz.scripts import Script, Stage, Told, scripted
from tests.fuzz.target import Target
from tests.support.step_network import Exchange
from vedette.fusion import ChannelFilter, ReplicatedEvidence
from vedette.fusion.gaussian import WAYS, Information, TrackFusion, TrackMotion, track_fusion
from vedette.fusion.steps import ReplicatedSteps, Sparse, SparseIntegers, StepSums
from vedette.kernels.tiles import TiledGrid
from vedette.overlay import Overlay, ReliableLink

NOW = 20.0  # [s]
ME, NEIGHBOURS = 1, (0, 2)
SHAPE, COUNTS = (50, 70), 3
ELEMENTS = 40
ROUNDS = 4


class Robot(Protocol):
    """One robot's share of fusion, and what it does with it from step to step."""

    share: Exchange

    def see(self, step: int, rng: np.random.Generator) -> None:
        """Take in own evidence of a step."""

    def use(self) -> None:
        """Ask for what the team knows."""


class MapRobot:
    """Evidence of a map."""

    def __init__(self, kind: type[ReplicatedEvidence] | type[ChannelFilter], robot: int) -> None:
        """Know nothing."""
        self.share: ReplicatedEvidence | ChannelFilter = kind(robot, 1, SHAPE, COUNTS)
        self._own = np.zeros(SHAPE, np.int8)

    def see(self, step: int, rng: np.random.Generator) -> None:
        """A patch."""
        row, col = int(rng.integers(30)), int(rng.integers(50))
        self._own[row : row + 12, col : col + 12] = rng.integers(-20, 21)
        self.share.publish(TiledGrid.of(self._own), None, np.arange(COUNTS) + step)

    def use(self) -> None:
        """Look at the map."""
        self.see(50, np.random.default_rng(9))
        assert self.share.classes.blocks.max() <= 2
        _ = self.share.contributors(), self.share.digest


class StepRobot:
    """Evidence by steps."""

    def __init__(self, way: str, robot: int) -> None:
        """Know nothing."""
        self._elements = SparseIntegers(ELEMENTS)
        self.share: ReplicatedSteps[Sparse] | StepSums[Sparse] = (
            ReplicatedSteps(robot, 1, self._elements)
            if way == "replicated"
            else StepSums(robot, 1, self._elements, window=6)
        )

    def see(self, step: int, rng: np.random.Generator) -> None:
        """A few entries."""
        index = rng.choice(ELEMENTS, 4, replace=False)
        self.share.publish(step, self._elements.of(index, rng.integers(-900, 900, 4)))

    def use(self) -> None:
        """Look at all totals."""
        _ = self.share.digest
        for step in self.share.steps():
            self._elements.dense(self.share.total(step))
        self.see(ROUNDS, np.random.default_rng(9))


class TrackRobot:
    """Gaussian tracks of two moving targets."""

    def __init__(self, way: str, robot: int) -> None:
        """Know the prior."""
        transition = np.tile(np.eye(4) + np.eye(4, k=2), (2, 1, 1))
        noise = np.tile(np.diag([0.2, 0.2, 0.1, 0.1]), (2, 1, 1))
        prior = Information(np.tile(np.diag([0.01, 0.01, 0.2, 0.2]), (2, 1, 1)), np.zeros((2, 4)))
        self.share: TrackFusion = track_fusion(
            way,
            robot,
            1,
            prior,
            TrackMotion(transition, noise),
            0,
            most_matrix=1.0,
            most_vector=1e3,
            window=6,
        )

    def see(self, step: int, rng: np.random.Generator) -> None:
        """The place of one target."""
        matrix, vector = np.zeros((2, 4, 4)), np.zeros((2, 4))
        target = int(rng.integers(2))
        matrix[target, [0, 1], [0, 1]] = 0.25
        vector[target, :2] = 0.25 * rng.normal(0.0, 9.0, 2)
        self.share.advance(step)
        self.share.observe(step, Information(matrix, vector))

    def use(self) -> None:
        """Go on for a few steps."""
        step, tracks = self.share.estimate()
        for _ in range(3):
            step += 1
            self.share.advance(step)
            assert tracks.is_proper
        _, tracks = self.share.estimate()
        tracks.moments()
        _ = self.share.digest


def _refuses(robot: Robot, sender: int, payload: bytes) -> bool:
    try:
        robot.share.receive(sender, payload, NOW)
    except ValueError:
        return True
    return False


def _go_on(robot: Robot) -> None:
    robot.use()
    for neighbour in NEIGHBOURS:
        for now in (NOW + 1.0, NOW + 9.0):
            robot.share.outgoing(neighbour, now)


def _stage(make: Callable[[int], Robot]) -> Stage:
    """Let three robots on a chain exchange what they see; note what comes to the middle one."""
    robots = [make(i) for i in range(3)]
    rng = np.random.default_rng(5)
    for i, robot in enumerate(robots):
        robot.share.set_neighbours([k for k in (i - 1, i + 1) if 0 <= k < 3])
    scenes, scripts = [Kept(robots[ME])], list[Script]()
    for step in range(ROUNDS):
        told: list[Told] = []
        for robot in robots:
            robot.see(step, rng)
        for a, b in ((0, 1), (2, 1), (1, 0), (1, 2)):
            payload = robots[a].share.outgoing(b, float(step))
            if payload is None:
                continue
            if b == ME:
                told.append(Told(a, payload))
            robots[b].share.receive(a, payload, float(step))
        here = len(scenes) - 1
        scripts += [Script(here, tuple(told)), *(Script(here, (one,)) for one in told)]
        scenes.append(Kept(robots[ME]))
    return Stage(scenes, scripts)


# -- overlay and link ------------------------------------------------------------------------------------


def _overlay_stage() -> Stage:
    """A chain of three that forms its tree."""
    robots = [Overlay(i, 10 + i, 0.0) for i in range(3)]
    robots[0].peers([1], 0.0)
    robots[1].peers([0, 2], 0.0)
    robots[2].peers([1], 0.0)
    scenes, scripts = [Kept(robots[ME])], list[Script]()
    for tick in range(1, 60):
        now, told = 0.05 * tick, []
        for i, robot in enumerate(robots):
            for to, hello in robot.tick(now):
                if to == ME:
                    told.append(Told(i, hello))
                robots[to].hear(i, hello, now)
        if told and len(scripts) < 24:
            scripts.append(Script(len(scenes) - 1, tuple(told)))
            scenes.append(Kept(robots[ME]))
    return Stage(scenes, scripts)


def _overlay_refuses(overlay: Overlay, sender: int, payload: bytes) -> bool:
    try:
        overlay.hear(sender, payload, NOW)
    except ValueError:
        return True
    return False


def _overlay_goes_on(overlay: Overlay) -> None:
    for tick in range(40):
        overlay.tick(NOW + 0.1 * tick)
        overlay.status(NOW + 0.1 * tick)


def _link_stage() -> Stage:
    ours, theirs = ReliableLink(1), ReliableLink(2)
    ours.open(2, 9, 0.0)
    theirs.open(1, 9, 0.0)
    scenes, scripts = [Kept(ours)], list[Script]()
    for tick in range(12):
        now = 0.05 * tick
        for k in range(tick % 4):
            ours.send(b"%d" % k, now)
            theirs.send(b"message %d" % k * 9, now)
        told = [Told(0, packet) for packet in theirs.poll(now)]
        for packet in ours.poll(now):
            theirs.hear(packet, now)
        for one in told:
            ours.hear(one.payload, now)
        if told:
            scripts.append(Script(len(scenes) - 1, tuple(told)))
            scenes.append(Kept(ours))
    return Stage(scenes, scripts)


def _link_refuses(link: ReliableLink, sender: int, payload: bytes) -> bool:
    try:
        link.hear(payload, NOW)
    except ValueError:
        return True
    return False


def _link_goes_on(link: ReliableLink) -> None:
    link.send(b"on", NOW)
    for tick in range(40):
        link.poll(NOW + 0.1 * tick)


def receivers() -> list[Target]:
    """Return them all."""
    makers: dict[str, Callable[[int], Any]] = {
        "fuse-map-replicated": partial(MapRobot, ReplicatedEvidence),
        "fuse-map-channel": partial(MapRobot, ChannelFilter),
        "fuse-steps-replicated": partial(StepRobot, "replicated"),
        "fuse-steps-sums": partial(StepRobot, "sums"),
        **{f"fuse-tracks-{way}": partial(TrackRobot, way) for way in WAYS},
    }
    return [
        *(scripted(name, partial(_stage, make), _refuses, _go_on) for name, make in makers.items()),
        scripted("overlay", _overlay_stage, _overlay_refuses, _overlay_goes_on, frozenset({"complaints"})),
        scripted("link", _link_stage, _link_refuses, _link_goes_on),
    ]
