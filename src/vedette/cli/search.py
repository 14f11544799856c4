"""``vedette search``: a team of vehicles looks for a hidden target in simulation."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import click

from vedette.cli.options import (
    OneOf,
    Positive,
    end,
    ending_on_ctrl_c,
    fault_options,
    output_options,
    parse_faults,
    parse_kills,
    seed_option,
    write_figures,
)
from vedette.missions.search.case import SearchCase, default_case, read_case
from vedette.missions.search.options import COORDINATIONS, FUSIONS
from vedette.missions.search.scenario import Heat
from vedette.negotiation import SCHEMES
from vedette.record.folder import OutputFolder
from vedette.record.search.detection import detection_png
from vedette.record.search.live import search_display
from vedette.record.search.log import SearchScene
from vedette.record.search.mcap import SearchMcapWriter
from vedette.record.search.observer import SearchReport
from vedette.record.search.panel import search_gif
from vedette.record.search.stages import pdf_png
from vedette.record.search.summary import SearchSummary
from vedette.sim.radio import Radio
from vedette.sim.search.run import search as run_search
from vedette.sim.search.simulation import SearchSetup, SearchSimulation
from vedette.sim.search.trials import Running, assessed

MOST_TRIALS = 1_000_000


@click.command()
@click.argument("scenario_path", metavar="[SCENARIO]", required=False, type=Path)
@seed_option("the hidden target and all chance")
@click.option(
    "--coordination",
    type=OneOf(COORDINATIONS),
    default="negotiated",
    show_default=True,
    help="What the vehicles tell each other: nothing, what they see, or what they mean to do as well.",
)
@click.option("--scheme", type=OneOf(SCHEMES), default="token", show_default=True, help="How they negotiate.")
@click.option(
    "--fusion",
    type=OneOf(FUSIONS),
    default="replicated",
    show_default=True,
    help="How they share what they see.",
)
@click.option(
    "--max-time",
    type=Positive("s"),
    help="Search no longer than that [s].  [default: the scenario's duration]",
)
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
    case = default_case() if scenario_path is None else read_case(scenario_path)
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
    made = OutputFolder.make(out, force, case.name, _inputs(case, scenario_path, faults))
    with made as folder, ending_on_ctrl_c(running.stop):
        report = _run(simulation, folder, running, trials, not no_compare, quiet=as_json)
        _write(report, folder, animate)
        closed = _closing(report.summary, folder.path)
    end(report.summary, closed, as_json)


def _inputs(case: SearchCase, scenario_path: Path | None, faults: str | None) -> list[Path]:
    """Return the files that the command reads; ``faults`` may be a seed, which is no file."""
    files = [] if faults is None else [Path(faults)]
    if scenario_path is not None:
        heat = [part.file for part in case.scenario.prior if isinstance(part, Heat)]
        files += [scenario_path, *(scenario_path.parent / file for file in heat)]
    return files


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


def _write(report: SearchReport, folder: OutputFolder, animate: bool) -> None:
    write_figures(report.summary, report.timing, folder)
    pdf_png(report.log, report.summary, folder / "pdf.png")
    detection_png(report.curves, report.summary, folder / "detection.png")
    if animate:
        search_gif(report.log, folder / "mission.gif")


def _closing(summary: SearchSummary, folder: Path) -> list[str]:
    """Say in a few lines how it went and where the pictures are."""
    if summary.found_s is None:
        how = f"{summary.outcome.said} after {summary.time_s:.0f} s"
    else:
        how = f"found after {summary.found_s:.0f} s by {summary.found_by}, {summary.error_m:.0f} m off"
    lines = [
        f"{how}; probability of detection by then {100 * summary.detection_then:.0f} %",
        f"pictures: {folder / 'pdf.png'}, {folder / 'detection.png'}; all else beside them",
    ]
    if summary.comparison:
        means = (f"{name} {quality.mean_time_s:.0f} s" for name, quality in summary.comparison.items())
        lines.insert(1, f"mean time to detection, cut at {summary.duration_s:.0f} s: {', '.join(means)}")
    return lines
