"""How the simulated robots steer: round corners and beside each other without touching anything."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from vedette.ros2_robots.steering import CLOSE, Room, steer, within

STEP, SPEED, TURN, RADIUS = 0.05, 0.5, 1.5, 0.2


def beside_a_corner(at: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far the rim is from a wall that fills x < 1, y < 1."""
    return np.hypot(*np.maximum(at - 1.0, 0.0).T) - RADIUS


def driven(path: NDArray[np.float64], yaw: float, room: Room, time: float) -> NDArray[np.float64]:
    """Where a robot has been that follows a path."""
    x, y = path[0].tolist()
    been = [(x, y)]
    for _ in range(round(time / STEP)):
        speed, turn = steer((x, y, yaw), path, SPEED, TURN, room)
        assert 0.0 <= speed <= SPEED
        assert abs(turn) <= TURN
        yaw = within(yaw + turn * STEP)
        x, y = x + speed * cos(yaw) * STEP, y + speed * sin(yaw) * STEP
        been.append((x, y))
    return np.array(been)


def test_a_robot_cuts_no_corner_of_a_way_that_leaves_little_room() -> None:
    side = np.arange(0.05, 1.25, 0.1)
    path = np.vstack((np.column_stack((side, np.full_like(side, 1.25))), (1.25, 1.25)))
    path = np.vstack((path, np.column_stack((np.full_like(side, 1.25), side[::-1]))))
    been = driven(path, 0.0, beside_a_corner, 12.0)
    assert beside_a_corner(been).min() >= 0.5 * CLOSE
    assert np.hypot(*(been[-1] - path[-1])) < 0.1


def test_a_robot_stops_before_what_stands_in_its_way_and_goes_on_when_it_has_gone() -> None:
    path = np.column_stack((np.arange(0.0, 3.0, 0.1), np.zeros(30)))

    def taken(at: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.hypot(at[:, 0] - 2.0, at[:, 1]) - 2.0 * RADIUS

    been = driven(path, 0.0, taken, 10.0)
    assert 0.5 * CLOSE <= taken(been).min() < 0.2
    free = driven(path, 0.0, lambda at: np.full(len(at), 1.0), 10.0)
    assert np.hypot(*(free[-1] - path[-1])) < 0.1
