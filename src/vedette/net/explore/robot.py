"""An exploring robot, from its file."""

from __future__ import annotations

from pathlib import Path

from vedette.maps.world import World
from vedette.missions.explore.assemble import assemble
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
    agent = assemble(
        world.frame,
        body.hull,
        config.explore or ExploreOptions(),
        config.robot - 1,
        boot,
        robots=config.robots,
        most=Most.of([body.hull]) if best is None else Most(best.range, best.speed),
        waits_for=config.robots,
    )
    return Robot(agent, body, body, ExploreTeller(agent))
