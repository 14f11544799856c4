"""``vedette track``: a team of vehicles follows moving and static targets in simulation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from vedette.cli.options import Output, fault_options, output_options
from vedette.cli.running import simulate
from vedette.cli.tracking import TRACKING, tracking_options
from vedette.run import Track


@click.command()
@tracking_options
@fault_options
@output_options
@click.option("--no-compare", is_flag=True, help="Leave out the other ways of coordination.")
def track(scenario_path: Path | None, output: Output, no_compare: bool, **options: Any) -> None:
    """Let a team of vehicles follow the targets of SCENARIO in simulation: every vehicle runs its own agent.

    SCENARIO is a YAML file; without it, four vehicles follow six targets over 800 x 600 m for two minutes.
    Afterwards the same is done with every other way of coordination, to compare. Exit status: 0 complete,
    1 incomplete, 2 bad input, 130 interrupted.
    """
    mission = Track(scenario_path, **options)
    beside = (lambda report, say: report) if no_compare else mission.compared
    simulate(TRACKING, mission, mission.scene, output, beside)
