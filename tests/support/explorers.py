"""Robots in the building of ``mapping_scenes``: their missions, their team mates, and what they scan."""

from __future__ import annotations

import numpy as np

from tests.support.mapping_scenes import BEAMS, FRAME, RESOLUTION, SPEC, building
from vedette.agent.events import Pose, Scan
from vedette.agent.mates import Mate
from vedette.domains.mapping.planners import planner
from vedette.domains.mapping.sightings import BINS, ROWS
from vedette.fusion import ReplicatedEvidence
from vedette.kernels.lidar import cast_rays
from vedette.maps.lattice import Lattice
from vedette.missions.explore.exploring import Exploring

HERE = Pose(-0.53, 7.12, 0.0)


def explorer(robot: int = 0) -> Exploring:
    """A robot's mission of which nothing is seen yet."""
    fusion = ReplicatedEvidence(robot, 1 + robot, FRAME.shape, ROWS * BINS)
    return Exploring(Lattice(FRAME), SPEC, planner("tours"), fusion)


def mate_at(x: float, y: float, radius: float = 0.2, heard: float = 0.0) -> Mate:
    """A team mate that stands still."""
    return Mate(1, x, y, 0.0, (), 0.0, radius, 0.5, heard)


def scan_from(pose: Pose, rng: np.random.Generator, mates: tuple[Mate, ...] = ()) -> Scan:
    """Scan the building as the simulator does: walls, discs, noise on what came back."""
    discs = np.array([(m.x - FRAME.origin_x, m.y - FRAME.origin_y, m.radius) for m in mates]).reshape(-1, 3)
    x, y = pose.x - FRAME.origin_x, pose.y - FRAME.origin_y
    ranges = cast_rays(building(), RESOLUTION, x, y, BEAMS, SPEC.range, discs)
    return Scan(BEAMS, ranges + rng.normal(0.0, 0.01, ranges.shape))


def exchange(one: Exploring, other: Exploring) -> None:
    """Let two robots, 0 and 1, tell each other all they have seen."""
    one.fusion.set_neighbours([1])
    other.fusion.set_neighbours([0])
    for step in range(6):
        for sender, receiver, name in ((one, other, 0), (other, one, 1)):
            payload = sender.fusion.outgoing(1 - name, float(step))
            if payload is not None:
                receiver.fusion.receive(name, payload, float(step))
