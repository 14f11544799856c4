"""``vedette explore``: a team of robots explores a building in simulation."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import click

from vedette.cli.exploring import closing, exploring_options, inputs_of, team_of, world_of, write_outputs
from vedette.cli.options import (
    end,
    ending_on_ctrl_c,
    fault_options,
    output_options,
    parse_faults,
    parse_kills,
)
from vedette.record.explore.live import ExploreDisplay
from vedette.record.explore.log import ExploreScene
from vedette.record.explore.mcap import ExploreMcapWriter
from vedette.record.explore.observer import ExploreReport
from vedette.record.folder import OutputFolder
from vedette.sim.explore.run import explore as run_mission
from vedette.sim.explore.run import prepare
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.radio import Radio


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
    seed: int,
    planner: str,
    scheme: str,
    fusion: str,
    max_time: float,
    return_home: bool,
    radio: Radio | None,
    faults: str | None,
    link_delay: float,
    link_loss: float,
    kills: tuple[str, ...],
    out: Path | None,
    force: bool,
    as_json: bool,
    animate: bool,
) -> None:
    """Let a team of robots explore MAP in simulation: every robot runs its own agent, none is in charge.

    MAP is a ROS map_server .yaml, or an image together with --resolution; without it, a generated office of
    30 x 20 m. Exit status: 0 complete, 1 incomplete, 2 bad input, 130 interrupted.
    """
    world = world_of(map_path, resolution, seed)
    specs = team_of(team, robots, starts)
    setup = ExploreSetup(
        planner=planner,
        scheme=scheme,
        fusion=fusion,
        seed=seed,
        max_time=max_time,
        link_delay=link_delay,
        link_loss=link_loss,
        kills=parse_kills(kills, len(specs)),
        radio=radio,
        faults=parse_faults(faults, len(specs)),
        faults_from=faults,
        return_home=return_home,
    )
    # Everything that can be wrong with the input is found before the folder is made.
    prepared = prepare(world, specs, setup)
    made = OutputFolder.make(out, force, world.name, inputs_of(map_path, team, faults))
    with made as folder, ending_on_ctrl_c(prepared.stop):
        report = _run(prepared, folder, quiet=as_json)
        write_outputs(report, world, folder, animate)
        closed = closing(report.summary, folder.path)
    end(report.summary, closed, as_json)


def _run(prepared: ExploreSimulation, folder: OutputFolder, quiet: bool) -> ExploreReport:
    """Run the mission, shown live unless ``quiet`` and recorded in the folder."""
    scene = ExploreScene.of(prepared.world, [spec.name for spec in prepared.specs])
    with ExitStack() as sinks:
        live = sinks.enter_context(ExploreDisplay(scene, quiet))
        mcap = sinks.enter_context(ExploreMcapWriter(lambda: folder / "run.mcap", scene))
        return run_mission(prepared, (live, mcap, folder))
