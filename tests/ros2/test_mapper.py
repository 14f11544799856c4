"""The map that a simulated robot's SLAM makes: no wall that a beam only came near to is free in it."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.small_missions import TWO_ROOMS, drawn, small_office
from vedette.kernels.lidar import cast_rays
from vedette.maps.world import World
from vedette.ros2_robots.building import Building
from vedette.ros2_robots.mapper import Mapper

REACH, NOISE = 8.0, 0.01  # [m]
ANGLES = np.linspace(-np.pi, np.pi, 360)


def mapped(world: World, seed: int) -> np.ndarray[tuple[int, ...], np.dtype[np.int8]]:
    """The occupancy after a robot has stood, and looked a dozen times, in six places."""
    rng, frame = np.random.default_rng(seed), world.frame
    mapper = Mapper(Building(world.solid, frame.resolution, frame.origin_x, frame.origin_y))
    free = frame.centres(np.flatnonzero(~world.solid))
    for x, y in free[rng.integers(len(free), size=6)].tolist():
        yaw = float(rng.uniform(-np.pi, np.pi))
        true = cast_rays(world.solid, frame.resolution, x, y, yaw + ANGLES, REACH, np.zeros((0, 3)))
        for _ in range(12):
            noisy = true + rng.normal(0.0, NOISE, len(true))
            told = {"ranges": np.where(np.isfinite(true), noisy, REACH), "range_max": REACH}
            mapper.look(x, y, yaw, {**told, "angle_min": ANGLES[0], "angle_increment": ANGLES[1] - ANGLES[0]})
    return mapper.occupancy


@pytest.mark.parametrize("world", [drawn(TWO_ROOMS), small_office()], ids=["two rooms", "office"])
@pytest.mark.parametrize("seed", range(4))
def test_no_wall_is_free_and_hardly_anything_free_is_a_wall(world: World, seed: int) -> None:
    told = mapped(world, seed)
    assert not (world.solid & (told == 0)).any()
    assert np.count_nonzero(~world.solid & (told > 0)) <= 0.002 * np.count_nonzero(told >= 0)
    assert np.count_nonzero(told == 0) > 1000
