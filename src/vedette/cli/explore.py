"""``vedette explore``: a team of robots explores a building in simulation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from vedette.cli.exploring import EXPLORING, exploring_options, team_named, world_named
from vedette.cli.options import Output, fault_options, output_options
from vedette.cli.running import simulate
from vedette.run import Explore
from vedette.run.inputs import files_of


@click.command()
@exploring_options
@fault_options
@output_options
def explore(
    map_path: Path | None,
    resolution: float | None,
    robots: int | None,
    team: Path | None,
    starts: str | None,
    output: Output,
    **options: Any,
) -> None:
    """Let a team of robots explore MAP in simulation: every robot runs its own agent, none is in charge.

    MAP is a ROS map_server .yaml, or an image together with --resolution; without it, a generated office of
    30 x 20 m. Exit status: 0 complete, 1 incomplete, 2 bad input, 130 interrupted.
    """
    world, specs = world_named(map_path, resolution), team_named(team, robots, starts)
    mission = Explore(world, specs, **options)
    mission.inputs += files_of(None, team)
    simulate(EXPLORING, mission, mission.scene, output)
