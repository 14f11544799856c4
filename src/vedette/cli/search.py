"""``vedette search``: a team of vehicles looks for a hidden target in simulation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from vedette.cli.options import Output, Whole, fault_options, orders_option, output_options
from vedette.cli.running import Say, simulate, simulate_watched
from vedette.cli.searching import SEARCHING, searching_options
from vedette.cli.seeking import OF_UNKNOWN_MAPS, OF_VEHICLES, check_together, seek, seeking_options
from vedette.cli.windows import beside_of, watch_options, watched
from vedette.record.search.log import SearchSnapshot
from vedette.record.search.observer import SearchReport
from vedette.run import Search
from vedette.window.explore import Shower
from vedette.window.flights import search_picture
from vedette.window.picture import Picture

MOST_TRIALS = 1_000_000


@click.command()
@searching_options
@seeking_options
@orders_option
@fault_options
@click.option(
    "--trials",
    type=Whole(0, MOST_TRIALS),
    metavar="N",
    help="Targets drawn for the counted curve; 0: none.  [default: 1000, or 20 whole searches: see the docs]",
)
@output_options
@watch_options
@click.option("--no-compare", is_flag=True, help="Leave out the other ways of coordination.")
@click.pass_context
def search(
    context: click.Context,
    /,
    scenario_path: Path | None,
    unknown_map: bool,
    orders: Path | None,
    trials: int | None,
    output: Output,
    watch: bool,
    pace: float,
    no_compare: bool,
    **options: Any,
) -> None:
    """Let a team of vehicles look for a hidden target in simulation: every vehicle runs its own agent.

    SCENARIO is a YAML file; without it, four aircraft look for a raft adrift. With --unknown-map it is a map,
    as `vedette explore` takes them, of a building in which robots look for somebody. Exit status: 0 found,
    1 not found in time or declared where it is not, 2 bad input, 130 interrupted.
    """
    check_together(context, unknown_map)
    options["orders"] = orders or ()
    if unknown_map:
        seek(scenario_path, output=output, **{k: v for k, v in options.items() if k not in OF_VEHICLES})
    options = {name: value for name, value in options.items() if name not in OF_UNKNOWN_MAPS}
    mission = Search(scenario_path, **options)

    def beside(report: SearchReport, say: Say) -> SearchReport:
        return mission.assessed(report, not no_compare, trials, say)

    if not watch:
        simulate(SEARCHING, mission, mission.scene, output, beside)
    hub, names = watched(mission, mission.scene.name), mission.scene.vehicles

    def drawn(snapshot: SearchSnapshot) -> Picture:
        return search_picture(mission.scene, snapshot, beside_of(mission, names, output.out))

    shower = Shower[SearchSnapshot](hub, drawn, pace)
    simulate_watched(SEARCHING, mission, mission.scene, output, hub, shower, beside)
