"""An exploring robot, from its file."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np

from vedette.maps.world import World
from vedette.missions.explore.assemble import assemble, terms_of
from vedette.missions.explore.options import ExploreOptions
from vedette.net.config import AgentConfig
from vedette.net.explore.content import ExploreTeller
from vedette.net.robot import Robot
from vedette.net.simulated import simulated_robot
from vedette.team import Most


def explorer(config: AgentConfig, folder: Path, boot: int, speed: float) -> Robot:
    """Return the robot; ``folder``: what paths in its file are relative to.

    Raises:
        InputError: the map or the start cannot be used.
    """
    assert config.body.map is not None
    world = World.from_map(folder / config.body.map, config.body.resolution)
    body, best = simulated_robot(config, world), config.best
    options = config.explore or ExploreOptions()
    agent = assemble(
        world.frame,
        body.hull,
        options,
        config.robot - 1,
        boot,
        robots=config.robots,
        most=Most.of([body.hull]) if best is None else Most(best.range, best.speed),
        waits_for=config.robots,
    )
    terms = {**terms_of(world.frame, options), "map.content": _fingerprint(world)}
    return Robot(agent, body, body, ExploreTeller(agent), terms)


def _fingerprint(world: World) -> str:
    """Return a number for the world that a body is simulated in: its mates' bodies have to be in the same."""
    return hashlib.blake2b(np.packbits(world.solid).tobytes(), digest_size=4).hexdigest()
