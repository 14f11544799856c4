"""Robots that drift and share no frame: SLAM takes back what they said, and edges are fitted again."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import cast

import numpy as np

from tests.support.small_missions import robots, small_office
from vedette.agent.events import Sensed
from vedette.cli.exploring import closing
from vedette.missions.explore.frames.exploring import FramedExploring
from vedette.missions.explore.own_map import OwnMap
from vedette.sim.explore.run import ExploreRun, explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.framed import FramedRobots


def test_robots_that_drift_find_each_others_frames_and_map_an_office_together() -> None:
    team = [replace(spec, drift=0.002) for spec in robots(2)]
    setups = [ExploreSetup(seed=seed, frames="unknown") for seed in (7, 8, 9)]
    summaries = [explore(prepare(small_office(seed=1), team, setup)).summary for setup in setups]
    assert median(each.map_error_share for each in summaries) < 0.01  # how far maps are bent is chance
    summary = summaries[0]
    assert summary.completed
    assert summary.coverage is not None
    assert summary.coverage > 0.98
    assert summary.frames is not None
    assert summary.frames.components == (("robot-1", "robot-2"),)
    assert summary.frames.walls_m is not None
    assert summary.frames.walls_m < 0.05
    assert summary.pose_error_m is not None
    assert summary.frames.error_m is not None
    assert summary.frames.error_m <= sum(summary.pose_error_m.values()) + summary.frames.walls_m + 0.05
    said = closing(summary, Path("out"))
    off, walls, own = summary.frames.error_m, summary.frames.walls_m, max(summary.pose_error_m.values())
    assert (
        f"joined: 1+2, {off:.2f} m off at most, walls {walls:.2f} m apart, places of their own {own:.2f} m"
        in said
    )


def test_robots_with_a_slam_meet_and_what_it_puts_right_since_bends_no_join() -> None:
    team = [replace(spec, drift=0.005) for spec in robots(2)]
    simulation = prepare(small_office(seed=1), team, ExploreSetup(seed=9, frames="unknown"))
    missions = [cast(FramedExploring, mission) for mission in simulation.missions]
    for mission in missions:
        mission.matcher._due = math.inf  # nobody lays their maps on each other
    run = ExploreRun(simulation)
    while simulation.now < 90.0 and missions[0].frames.own(1) is None:
        run.step()
    simulation.stop()
    found = run.run().summary.frames
    assert found is not None
    assert [join.by for join in found.joins] == ["meeting"]
    assert found.joins[0].error_m < 0.4
    assert found.joins[0].error_deg < 4.0


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
