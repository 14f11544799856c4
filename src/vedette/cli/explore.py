"""``vedette explore``: a team of robots explores a building in simulation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from vedette.cli.exploring import EXPLORING, exploring_options, team_named, world_named
from vedette.cli.options import FILE, Output, fault_options, orders_option, output_options
from vedette.cli.running import simulate, simulate_watched
from vedette.cli.windows import beside_of, watch_options, watched
from vedette.errors import InputError
from vedette.record.explore.log import ExploreSnapshot
from vedette.run import Explore
from vedette.run.inputs import files_of
from vedette.run.saved import seed_of
from vedette.window.explore import Shower
from vedette.window.picture import Picture, picture


@click.command()
@exploring_options
@click.option(
    "--continue", "saved", type=FILE, metavar="RUN_DIR", help="Start from the map that an earlier run left."
)
@orders_option
@fault_options
@watch_options
@output_options
def explore(
    map_path: Path | None,
    resolution: float | None,
    robots: int | None,
    team: Path | None,
    starts: str | None,
    drift: float | None,
    saved: Path | None,
    orders: Path | None,
    watch: bool,
    pace: float,
    output: Output,
    **options: Any,
) -> None:
    """Let a team of robots explore MAP in simulation: every robot runs its own agent, none is in charge.

    MAP is a ROS map_server .yaml, an image together with --resolution, or the name of a generator (office,
    cave, maze, MODULE:NAME); without it, a generated office of 30 x 20 m. Exit status: 0 complete,
    1 incomplete, 2 bad input, 130 interrupted.
    """
    world, specs = world_named(map_path, resolution), team_named(team, robots, starts, drift)
    if saved is not None and world is None and (seed := seed_of(saved)) not in (None, options["seed"]):
        raise InputError(f"--continue: {saved} is of the office of seed {seed}; add --seed {seed}")
    mission = Explore(world, specs, saved=saved, orders=orders or (), **options)
    mission.inputs += files_of(None if saved is None else saved / "map.yaml", team)
    if not watch:
        simulate(EXPLORING, mission, mission.scene, output)
    hub, names = watched(mission, mission.scene.name), mission.scene.vehicles

    def drawn(snapshot: ExploreSnapshot) -> Picture:
        return picture(mission.scene, snapshot, beside_of(mission, names, output.out))

    shower = Shower[ExploreSnapshot](hub, drawn, pace)
    simulate_watched(EXPLORING, mission, mission.scene, output, hub, shower)
