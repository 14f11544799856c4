"""What the commands that let a team search share: options, the scenario, files, the last words."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from vedette.cli.options import OneOf, Positive, seed_option, with_options, write_figures
from vedette.missions.search.case import SearchCase, default_case, read_case
from vedette.missions.search.options import COORDINATIONS, FUSIONS
from vedette.missions.search.scenario import Heat
from vedette.negotiation import SCHEMES
from vedette.record.folder import OutputFolder
from vedette.record.search.detection import detection_png
from vedette.record.search.observer import SearchReport
from vedette.record.search.panel import search_gif
from vedette.record.search.stages import pdf_png
from vedette.record.search.summary import SearchSummary

CommandT = TypeVar("CommandT", bound=Callable[..., Any])


def searching_options(command: CommandT) -> CommandT:
    """``SCENARIO`` and what says how its vehicles search."""
    return with_options(
        command,
        click.argument("scenario_path", metavar="[SCENARIO]", required=False, type=Path),
        seed_option("the hidden target and all chance"),
        click.option(
            "--coordination",
            type=OneOf(COORDINATIONS),
            default="negotiated",
            show_default=True,
            help="What the vehicles tell each other: nothing, what they see, or also what they mean to do.",
        ),
        click.option(
            "--scheme", type=OneOf(SCHEMES), default="token", show_default=True, help="How they negotiate."
        ),
        click.option(
            "--fusion",
            type=OneOf(FUSIONS),
            default="replicated",
            show_default=True,
            help="How they share what they see.",
        ),
        click.option(
            "--max-time",
            type=Positive("s"),
            help="Search no longer than that [s].  [default: the scenario's duration]",
        ),
    )


def case_of(path: Path | None) -> SearchCase:
    """Return the search of a scenario, the one that is built in without a file.

    Raises:
        InputError: the file cannot be used.
    """
    return default_case() if path is None else read_case(path)


def inputs_of(case: SearchCase, scenario_path: Path | None, faults: str | None) -> list[Path]:
    """Return the files that the command reads; ``faults`` may be a seed, which is no file."""
    files = [] if faults is None else [Path(faults)]
    if scenario_path is not None:
        heat = [part.file for part in case.scenario.prior if isinstance(part, Heat)]
        files += [scenario_path, *(scenario_path.parent / file for file in heat)]
    return files


def write_outputs(report: SearchReport, folder: OutputFolder, animate: bool) -> None:
    """Write all files of a search but the run record, which grows while it lasts."""
    write_figures(report.summary, report.timing, folder)
    pdf_png(report.log, report.summary, folder / "pdf.png")
    detection_png(report.curves, report.summary, folder / "detection.png")
    if animate:
        search_gif(report.log, folder / "mission.gif")


def closing(summary: SearchSummary, folder: Path) -> list[str]:
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
