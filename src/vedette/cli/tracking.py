"""What the commands that let a team track share: options, the scenario, files, the last words."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from vedette.cli.options import OneOf, Positive, seed_option, with_options, write_figures
from vedette.domains.tracking.objective import OBJECTIVES
from vedette.fusion.gaussian import WAYS
from vedette.missions.track.options import COORDINATIONS
from vedette.missions.track.scenario import TrackScenario, default_scenario, read_scenario
from vedette.negotiation import SCHEMES
from vedette.record.folder import OutputFolder
from vedette.record.track.entropy import entropy_png
from vedette.record.track.observer import TrackReport
from vedette.record.track.panel import track_gif
from vedette.record.track.summary import TrackSummary
from vedette.record.track.tracks import tracks_png

CommandT = TypeVar("CommandT", bound=Callable[..., Any])


def tracking_options(command: CommandT) -> CommandT:
    """``SCENARIO`` and what says how its vehicles track."""
    return with_options(
        command,
        click.argument("scenario_path", metavar="[SCENARIO]", required=False, type=Path),
        seed_option("the targets' true ways and all chance"),
        click.option(
            "--coordination",
            type=OneOf(COORDINATIONS),
            default="negotiated",
            show_default=True,
            help="How the vehicles decide.",
        ),
        click.option(
            "--scheme", type=OneOf(SCHEMES), default="token", show_default=True, help="How they negotiate."
        ),
        click.option(
            "--fusion",
            type=OneOf(WAYS),
            default="replicated",
            show_default=True,
            help="How they share what they see.",
        ),
        click.option(
            "--objective",
            type=OneOf(list(OBJECTIVES)),
            help="What they gain.  [default: the scenario's, else trajectory]",
        ),
        click.option(
            "--continuous",
            is_flag=True,
            help="Improve the best course's turn rates by the objective's gradient.",
        ),
        click.option(
            "--max-time",
            type=Positive("s"),
            help="Simulated time limit [s].  [default: the scenario's duration]",
        ),
    )


def scenario_of(path: Path | None) -> tuple[TrackScenario, str]:
    """Return a scenario and its name, the one that is built in without a file.

    Raises:
        InputError: the file cannot be used.
    """
    return (default_scenario(), "track") if path is None else (read_scenario(path), path.stem)


def inputs_of(scenario_path: Path | None, faults: str | None) -> list[Path]:
    """Return the files that the command reads; ``faults`` may be a seed, which is no file."""
    return [Path(file) for file in (scenario_path, faults) if file is not None]


def write_outputs(report: TrackReport, folder: OutputFolder, animate: bool) -> None:
    """Write all files of a mission but the run record, which grows while it lasts."""
    write_figures(report.summary, report.timing, folder)
    tracks_png(report.log, folder / "tracks.png")
    logs = {report.summary.coordination: report.log, **report.others}
    entropy_png(logs, report.left_out, folder / "entropy.png")
    if animate:
        track_gif(report.log, folder / "mission.gif")


def closing(summary: TrackSummary, folder: Path) -> list[str]:
    """Say in a few lines how it went and where the pictures are."""
    lines = [
        f"{summary.outcome.said}: {summary.vehicles} vehicles followed {summary.targets} targets for "
        f"{summary.time_s:.0f} s; entropy {summary.entropy_mean_nat:.1f} nat on average, "
        f"position error {summary.position_rmse_m:.1f} m (rms), NEES {summary.nees:.2f}",
        f"pictures: {folder / 'tracks.png'}, {folder / 'entropy.png'}; all else beside them",
    ]
    if summary.comparison:
        each = (f"{name} {quality.entropy_mean_nat:.1f}" for name, quality in summary.comparison.items())
        lines.insert(1, f"mean entropy [nat]: {', '.join(each)}")
    return lines
