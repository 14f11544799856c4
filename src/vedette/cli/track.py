"""``vedette track``: a team of vehicles follows moving and static targets in simulation."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import click

from vedette.cli.options import (
    end,
    ending_on_ctrl_c,
    fault_options,
    output_options,
    parse_faults,
    parse_kills,
)
from vedette.cli.tracking import closing, inputs_of, scenario_of, tracking_options, write_outputs
from vedette.record.folder import OutputFolder
from vedette.record.track.live import track_display
from vedette.record.track.log import TrackScene
from vedette.record.track.mcap import TrackMcapWriter
from vedette.record.track.observer import TrackReport
from vedette.sim.radio import Radio
from vedette.sim.track.run import compared
from vedette.sim.track.run import track as run_mission
from vedette.sim.track.simulation import TrackSetup, TrackSimulation


@click.command()
@tracking_options
@fault_options
@output_options
@click.option("--no-compare", is_flag=True, help="Leave out the other ways of coordination.")
def track(
    scenario_path: Path | None,
    seed: int,
    coordination: str,
    scheme: str,
    fusion: str,
    objective: str | None,
    continuous: bool,
    max_time: float | None,
    radio: Radio | None,
    faults: str | None,
    link_delay: float,
    link_loss: float,
    kills: tuple[str, ...],
    out: Path | None,
    force: bool,
    as_json: bool,
    animate: bool,
    no_compare: bool,
) -> None:
    """Let a team of vehicles follow the targets of SCENARIO in simulation: every vehicle runs its own agent.

    SCENARIO is a YAML file; without it, four vehicles follow six targets over 800 x 600 m for two minutes.
    Afterwards the same is done with every other way of coordination, to compare. Exit status: 0 complete,
    1 incomplete, 2 bad input, 130 interrupted.
    """
    scenario, name = scenario_of(scenario_path)
    setup = TrackSetup(
        scheme=scheme,
        seed=seed,
        max_time=scenario.duration + 1.0 if max_time is None else max_time,
        link_delay=link_delay,
        link_loss=link_loss,
        kills=parse_kills(kills, len(scenario.vehicles)),
        radio=radio,
        faults=parse_faults(faults, len(scenario.vehicles), clocks=False),
        faults_from=faults,
        coordination=coordination,
        fusion=fusion,
        objective=objective,
        continuous=continuous,
    )
    # Everything that can be wrong with the input is found before the folder is made.
    prepared = TrackSimulation(scenario, setup)
    with OutputFolder.make(out, force, name, inputs_of(scenario_path, faults)) as folder:
        running = _Running(name, folder, quiet=as_json)
        with ending_on_ctrl_c(running.stop):
            report = running.live(prepared)
            if not no_compare:
                report = compared(report, scenario, setup, running.beside)
            write_outputs(report, folder, animate)
        closed = closing(report.summary, folder.path)
    end(report.summary, closed, as_json)


@dataclass
class _Running:
    """Runs missions one after another, whichever is on when Ctrl-C comes."""

    name: str
    folder: OutputFolder
    quiet: bool
    stopped: bool = field(default=False, init=False)
    _now: TrackSimulation | None = field(default=None, init=False)

    def stop(self) -> None:
        """End the mission that is on, and those to come before they begin."""
        self.stopped = True
        if self._now is not None:
            self._now.stop()

    def live(self, simulation: TrackSimulation) -> TrackReport:
        """Run a mission, shown live unless quiet and recorded in the folder."""
        self._begin(simulation)
        scene = TrackScene.of(simulation.scenario, self.name)
        with ExitStack() as sinks:
            live = sinks.enter_context(track_display(scene, self.quiet))
            mcap = sinks.enter_context(TrackMcapWriter(lambda: self.folder / "run.mcap", scene))
            return run_mission(simulation, self.name, (live, mcap, self.folder))

    def beside(self, simulation: TrackSimulation, coordination: str) -> TrackReport:
        """Run a mission to compare with; say which, unless quiet."""
        self._begin(simulation)
        if not self.quiet:
            click.echo(f"to compare: {coordination}")
        return run_mission(simulation, self.name)

    def _begin(self, simulation: TrackSimulation) -> None:
        self._now = simulation
        if self.stopped:
            simulation.stop()
