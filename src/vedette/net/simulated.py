"""A robot's simulated body, from its file: the one place where a process knows the simulator."""

from __future__ import annotations

import numpy as np

from vedette.maps.world import World
from vedette.net.config import AgentConfig
from vedette.net.names import robot_name
from vedette.sim.own_body import OwnBody
from vedette.sim.starts import choose_starts

MOST_BODIES = 64  # of others that a simulated robot can see


def simulated_robot(config: AgentConfig, world: World) -> OwnBody:
    """Return the disc robot that a file describes, at its start in a world.

    Raises:
        InputError: the start cannot be.
    """
    robot = config.robot - 1
    spec = config.body.spec(robot_name(robot))
    start = choose_starts(world, [spec], np.random.default_rng(0))[0]
    rng = np.random.default_rng([config.body.seed, robot])
    return OwnBody.put(world, spec, start, robot, max(MOST_BODIES, robot + 1), rng)
