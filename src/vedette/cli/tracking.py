"""What the commands that let a team track share: options, the last words."""

from __future__ import annotations

from pathlib import Path

import click

from vedette.cli.options import Named
from vedette.cli.running import Kind
from vedette.cli.vehicles import vehicle_options
from vedette.domains.tracking.objective import OBJECTIVE
from vedette.fusion.gaussian import WAYS
from vedette.missions.track.options import COORDINATIONS
from vedette.number import many
from vedette.record.track.live import track_display
from vedette.record.track.mcap import TrackMcapWriter
from vedette.record.track.outputs import write_outputs
from vedette.record.track.summary import TrackSummary
from vedette.run.mission import RECORD

tracking_options = vehicle_options(
    "the targets' true ways and all chance",
    COORDINATIONS,
    WAYS,
    click.option(
        "--objective",
        type=Named(OBJECTIVE),
        help="What they gain.  [default: the scenario's, else trajectory]",
    ),
    click.option(
        "--continuous", is_flag=True, help="Improve the best course's turn rates by the objective's gradient."
    ),
)


def closing(summary: TrackSummary, folder: Path) -> list[str]:
    """Say in a few lines how it went and where the pictures are."""
    lines = [
        f"{summary.outcome.said}: {many(summary.vehicles, 'vehicle')} followed "
        f"{many(summary.targets, 'target')} for "
        f"{summary.time_s:.0f} s; entropy {summary.entropy_mean_nat:.1f} nat on average, "
        f"position error {summary.position_rmse_m:.1f} m (rms), NEES {summary.nees:.2f}",
        f"pictures: {folder / 'tracks.png'}, {folder / 'entropy.png'}; all else beside them",
    ]
    lines[1:1] = _doubts(summary)
    if summary.comparison:
        each = (f"{name} {quality.entropy_mean_nat:.1f}" for name, quality in summary.comparison.items())
        lines.insert(1, f"mean entropy [nat]: {', '.join(each)}")
    return lines


def _doubts(summary: TrackSummary) -> list[str]:
    """Say what makes figures doubtful: tracks not as right as they are sure, targets or looks left out."""
    low, high = summary.nees_band
    band = f"NEES {summary.nees:.2f}, where {low:.2f} to {high:.2f} is consistent"
    said = {
        "overconfident": f"the tracks are surer than they are right: {band}",
        "cautious": f"the tracks are less sure than they are right: {band}",
    }
    lines = [said[summary.consistency]] if summary.consistency in said else []
    if unseen := [name for name, share in summary.in_view.items() if share == 0.0]:
        lines.append(f"never seen by anybody: {', '.join(unseen[:10])}{', ...' if unseen[10:] else ''}")
    if summary.skipped:
        lines.append(f"looks left out, as their numbers were beyond all bounds: {summary.skipped}")
    return lines


LEAVES = (RECORD, "summary.json", "timing.json", "tracks.png", "entropy.png")
TRACKING = Kind(track_display, TrackMcapWriter, write_outputs, closing, LEAVES)
