"""Who moves before a lidar gets into nobody's map, whoever it is: against the truth of who stood where."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from tests.support.small_missions import robots, two_rooms
from vedette.agent.events import Pose, Scan
from vedette.kernels.lidar import cast_rays
from vedette.maps import GridFrame
from vedette.maps.lattice import Lattice
from vedette.maps.world import World
from vedette.missions.explore.evidence import OwnEvidence
from vedette.missions.explore.passers_by import STILL, PassersBy
from vedette.sim.explore.run import prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.team import PlatformSpec

Floats = NDArray[np.float64]
SPEC = PlatformSpec()
BEAMS = np.radians(np.arange(-180.0, 180.0))
PERIOD = 0.2  # between scans [s]


def hall() -> World:
    """Twelve metres by eight, with a wall of three metres in it."""
    solid = np.pad(np.zeros((78, 118), np.bool_), 1, constant_values=True)
    solid[1:31, 58:60] = True
    return World(GridFrame(0.1, *solid.shape), solid, "hall")


class Watching:
    """A robot that scans the hall, with bodies in it, whose places nobody tells it."""

    def __init__(self, *, careful: bool) -> None:
        self.world = hall()
        lattice = Lattice(self.world.frame)
        self.own = OwnEvidence(lattice, SPEC, PassersBy(lattice.frame, SPEC.radius) if careful else None)
        self.rng, self.now = np.random.default_rng(0), 0.0

    def scan(self, x: float, y: float, *discs: tuple[float, float, float]) -> None:
        seen = cast_rays(self.world.solid, 0.1, x, y, BEAMS, SPEC.range, np.array(discs).reshape(-1, 3))
        scan = Scan(BEAMS, np.maximum(seen + self.rng.normal(0.0, SPEC.range_noise, len(BEAMS)), 0.0))
        self.own.add(scan, Pose(x, y, 0.0), [], self.now)
        self.now += PERIOD

    def occupied(self) -> NDArray[np.bool_]:
        """Occupied cells that are no wall, nor beside one."""
        odds = self.own.log_odds.window()
        marked: NDArray[np.bool_] = (odds > 0) & ~ndimage.binary_dilation(
            self.world.solid, np.ones((3, 3), np.bool_)
        )
        return marked


def walkers(seed: int, steps: int) -> Floats:
    """Three people who walk straight on at 0.5 to 1.4 m/s and turn where a wall is: ``(steps, 3, 2)``."""
    rng, solid = np.random.default_rng(seed), ndimage.binary_dilation(hall().solid, iterations=5)
    at, turn = rng.uniform((2.0, 4.5), (10.0, 7.0), (3, 2)), rng.uniform(0.0, 2.0 * np.pi, 3)
    speed, ways = rng.uniform(0.5, 1.4, 3), []
    for _ in range(steps):
        for k in range(3):
            ahead = at[k] + speed[k] * PERIOD * np.array((np.cos(turn[k]), np.sin(turn[k])))
            if solid[int(ahead[1] / 0.1), int(ahead[0] / 0.1)]:
                turn[k] = rng.uniform(0.0, 2.0 * np.pi)
            else:
                at[k] = ahead
        ways.append(at.copy())
    return np.array(ways)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_people_who_walk_are_not_mapped(seed: int) -> None:
    marks = {}
    for careful in (True, False):
        robot, most = Watching(careful=careful), 0
        for k, people in enumerate(walkers(seed, 150)):
            robot.scan(1.0 + 0.05 * k, 5.0, *((x, y, 0.25) for x, y in people.tolist()))
            most = max(most, int(robot.occupied().sum()))
        marks[careful] = most
    assert marks[True] <= 4
    assert marks[False] >= 3 * marks[True] + 8


def test_a_pallet_that_stays_is_mapped_once_it_has_stood_still() -> None:
    robot = Watching(careful=True)
    pallet = (6.0, 6.0, 0.3)
    while robot.now < STILL:
        robot.scan(3.0, 5.0, pallet)
        assert not robot.occupied().any()
    for _ in range(4):
        robot.scan(3.0, 5.0, pallet)
    row, col = np.nonzero(robot.occupied())
    assert len(row) >= 4
    off = np.abs(np.hypot((col + 0.5) * 0.1 - 6.0, (row + 0.5) * 0.1 - 6.0) - 0.3)
    assert off.max() < 0.15


def test_who_has_stood_still_is_taken_back_by_the_first_look_behind() -> None:
    robot = Watching(careful=True)
    while robot.now < STILL + 3.0:
        robot.scan(3.0, 5.0, (6.0, 6.0, 0.3))
    assert robot.occupied().sum() >= 4
    robot.scan(3.0, 5.0)
    assert not robot.occupied().any()


def test_walls_are_mapped_at_once_and_as_they_were() -> None:
    careful, plain = Watching(careful=True), Watching(careful=False)
    for x in np.arange(1.0, 5.0, 0.1):
        for robot in (careful, plain):
            robot.scan(float(x), 5.0)
    walls = plain.own.log_odds.window() > 0
    mapped = careful.own.log_odds.window() > 0
    assert np.count_nonzero(walls & ~mapped) <= 0.01 * np.count_nonzero(walls)
    assert not (mapped & ~walls).any()


def test_they_are_told_as_discs_while_they_are_seen_moving() -> None:
    robot = Watching(careful=True)
    assert robot.own.passers_by is not None
    for k in range(10):
        robot.scan(3.0, 5.0, (5.0 + 0.1 * k, 6.0, 0.2))
    (x, y, radius), *others = robot.own.passers_by.discs(robot.now)
    assert not others
    assert np.hypot(x - 5.9, y - 6.0) < 0.15
    assert radius == SPEC.radius
    assert robot.own.passers_by.discs(robot.now + 5.0) == []


class Apart(ExploreSetup):
    """Nobody tells anybody anything."""

    @property
    def apart(self) -> bool:
        return True


def test_robots_that_know_nothing_of_each_other_meet_in_a_corridor_and_map_no_robot() -> None:
    world = two_rooms(1.4, 0.1)
    (left, right), middle = (1.0, world.frame.cols * 0.1 - 1.0), world.frame.rows * 0.05
    team = robots(2)
    starts = [PlatformSpec(each.name, start=(x, middle)) for each, x in zip(team, (left, right), strict=True)]
    simulation = prepare(world, starts, Apart(seed=3, max_time=120.0))
    for mission in simulation.missions:
        mission.own.passers_by = PassersBy(mission.frame, mission.spec.radius)
    wide = ndimage.binary_dilation(world.solid, np.ones((3, 3), np.bool_))
    nearest, most = np.inf, [0, 0]

    def look() -> None:
        nonlocal nearest
        places = simulation.robots.bodies.poses[:, :2]
        nearest = min(nearest, float(np.hypot(*(places[0] - places[1]))))
        for i, mission in enumerate(simulation.missions):
            odds = mission.own.log_odds.window()
            moving = np.hypot(*simulation.robots.bodies.velocities[1 - i]) > 0.0
            if moving:
                most[i] = max(most[i], int(((odds > 0) & ~wide).sum()))

    simulation.run(look, 0.5)
    assert nearest < 1.0
    assert simulation.robots.bodies.collisions.sum() == 0
    for mission in simulation.missions:
        known = mission.own.log_odds.window() != 0
        assert np.count_nonzero(known & ~world.solid) >= 0.99 * np.count_nonzero(~world.solid)
    assert max(most) <= 3
