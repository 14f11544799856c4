"""Robots that drift and share no frame: SLAM takes back what they said, and edges are fitted again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.support.small_missions import robots, small_office
from vedette.agent.events import Sensed
from vedette.missions.explore.own_map import OwnMap
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.framed import FramedRobots


def test_robots_that_drift_find_each_others_frames_and_map_an_office_together() -> None:
    team = [replace(spec, drift=0.002) for spec in robots(2)]
    summary = explore(prepare(small_office(seed=1), team, ExploreSetup(seed=7, frames="unknown"))).summary
    assert summary.completed
    assert summary.coverage is not None
    assert summary.coverage > 0.98
    assert summary.map_error_share < 0.01
    assert summary.frames is not None
    assert summary.frames.components == (("robot-1", "robot-2"),)


def test_the_map_that_a_slam_tells_lies_in_the_robots_own_frame() -> None:
    team = [replace(spec, drift=1e-6) for spec in robots(1)]
    world = small_office(seed=1)
    simulation = prepare(world, team, ExploreSetup(seed=7, frames="unknown"))
    assert isinstance(simulation.robots, FramedRobots)
    told: list[OwnMap] = []
    while not told:
        simulation.step()
        told = [each.data for each in simulation.sensed[0] if isinstance(each, Sensed)]
    (own,), there = told, simulation.robots.frames[0]
    row, col = np.nonzero(own.classes == 2)
    cos, sin = np.cos(own.heading), np.sin(own.heading)
    along, up = own.resolution * (col + 0.5), own.resolution * (row + 0.5)
    walls = there.places(np.column_stack((own.x + cos * along - sin * up, own.y + sin * along + cos * up)))
    at = [world.frame.flat(x, y) for x, y in walls.tolist() if world.frame.contains(x, y)]
    assert len(at) > 20
    assert np.mean(world.solid.flat[at]) > 0.9
