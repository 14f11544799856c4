"""``vedette search``: a team of vehicles looks for a hidden target in simulation."""

from __future__ import annotations

from contextlib import ExitStack
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
from vedette.cli.searching import case_of, closing, inputs_of, searching_options, write_outputs
from vedette.record.folder import OutputFolder
from vedette.record.search.live import search_display
from vedette.record.search.log import SearchScene
from vedette.record.search.mcap import SearchMcapWriter
from vedette.record.search.observer import SearchReport
from vedette.sim.radio import Radio
from vedette.sim.search.run import search as run_search
from vedette.sim.search.simulation import SearchSetup, SearchSimulation
from vedette.sim.search.trials import Running, assessed

MOST_TRIALS = 1_000_000


@click.command()
@searching_options
@fault_options
@click.option(
    "--trials",
    type=click.IntRange(0, MOST_TRIALS),
    metavar="N",
    help="Targets drawn for the counted curve; 0: none.  [default: 1000, or 20 whole searches: see the docs]",
)
@output_options
@click.option("--no-compare", is_flag=True, help="Leave out the other ways of coordination.")
def search(
    scenario_path: Path | None,
    seed: int,
    coordination: str,
    scheme: str,
    fusion: str,
    max_time: float | None,
    radio: Radio | None,
    faults: str | None,
    link_delay: float,
    link_loss: float,
    kills: tuple[str, ...],
    trials: int | None,
    out: Path | None,
    force: bool,
    as_json: bool,
    animate: bool,
    no_compare: bool,
) -> None:
    """Let a team of vehicles look for a hidden target in simulation: every vehicle runs its own agent.

    SCENARIO is a YAML file; without it, four aircraft look for a raft adrift. Exit status: 0 found, 1 not
    found in time or declared where it is not, 2 bad input, 130 interrupted.
    """
    case = case_of(scenario_path)
    longest = case.scenario.duration
    setup = SearchSetup(
        coordination=coordination,
        scheme=scheme,
        fusion=fusion,
        seed=seed,
        max_time=longest if max_time is None else min(max_time, longest),
        link_delay=link_delay,
        link_loss=link_loss,
        kills=parse_kills(kills, len(case.names)),
        radio=radio,
        faults=parse_faults(faults, len(case.names), clocks=False),
        faults_from=faults,
    )
    # Everything that can be wrong with the input is found before the folder is made.
    simulation = SearchSimulation(case, setup)
    running = Running()
    made = OutputFolder.make(out, force, case.name, inputs_of(case, scenario_path, faults))
    with made as folder, ending_on_ctrl_c(running.stop):
        report = _run(simulation, folder, running, trials, not no_compare, quiet=as_json)
        write_outputs(report, folder, animate)
        closed = closing(report.summary, folder.path)
    end(report.summary, closed, as_json)


def _run(
    simulation: SearchSimulation,
    folder: OutputFolder,
    running: Running,
    trials: int | None,
    compare: bool,
    quiet: bool,
) -> SearchReport:
    """Run the search, shown live unless ``quiet`` and recorded in the folder; then what goes beside it."""
    scene = SearchScene.of(simulation.case, simulation.setup.max_time)
    running.current = simulation
    with ExitStack() as sinks:
        live = sinks.enter_context(search_display(scene, quiet))
        mcap = sinks.enter_context(SearchMcapWriter(lambda: folder / "run.mcap", scene))
        report = run_search(simulation, (live, mcap, folder))
    running.say = live.say
    return assessed(report, simulation, running, trials, compare)
