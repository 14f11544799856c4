"""``vedette track``: a team of vehicles follows moving and static targets in simulation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from vedette.cli.options import Output, fault_options, orders_option, output_options
from vedette.cli.running import simulate, simulate_watched
from vedette.cli.tracking import TRACKING, tracking_options
from vedette.cli.windows import beside_of, watch_options, watched
from vedette.record.track.log import TrackSnapshot
from vedette.run import Track
from vedette.window.explore import Shower
from vedette.window.flights import track_picture
from vedette.window.picture import Picture


@click.command()
@tracking_options
@orders_option
@fault_options
@output_options
@watch_options
@click.option("--no-compare", is_flag=True, help="Leave out the other ways of coordination.")
def track(
    scenario_path: Path | None,
    orders: Path | None,
    output: Output,
    watch: bool,
    pace: float,
    no_compare: bool,
    **options: Any,
) -> None:
    """Let a team of vehicles follow the targets of SCENARIO in simulation: every vehicle runs its own agent.

    SCENARIO is a YAML file; without it, four vehicles follow six targets over 800 x 600 m for two minutes.
    Afterwards the same is done with every other way of coordination, to compare. Exit status: 0 complete,
    1 incomplete, 2 bad input, 130 interrupted.
    """
    mission = Track(scenario_path, orders=orders or (), **options)
    beside = (lambda report, say: report) if no_compare else mission.compared
    if not watch:
        simulate(TRACKING, mission, mission.scene, output, beside)
    hub, names = watched(mission, mission.scene.name), mission.scene.vehicles

    def drawn(snapshot: TrackSnapshot) -> Picture:
        return track_picture(mission.scene, snapshot, beside_of(mission, names, output.out))

    shower = Shower[TrackSnapshot](hub, drawn, pace)
    simulate_watched(TRACKING, mission, mission.scene, output, hub, shower, beside)
