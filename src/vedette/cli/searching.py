"""What the commands that let a team search share: options, the last words."""

from __future__ import annotations

from pathlib import Path

from vedette.cli.running import Kind
from vedette.cli.vehicles import vehicle_options
from vedette.missions.search.options import COORDINATIONS, FUSIONS
from vedette.number import many
from vedette.record.search.live import search_display
from vedette.record.search.mcap import SearchMcapWriter
from vedette.record.search.outputs import write_outputs
from vedette.record.search.summary import SearchSummary
from vedette.run.mission import RECORD

searching_options = vehicle_options(
    "the hidden target and all chance",
    COORDINATIONS,
    FUSIONS,
    decide="What the vehicles tell each other: nothing, what they see, or also what they mean to do.",
)


def closing(summary: SearchSummary, folder: Path) -> list[str]:
    """Say in a few lines how it went and where the pictures are."""
    if summary.found_s is None:
        how = f"{summary.outcome.said} after {summary.time_s:.0f} s"
    else:
        how = f"found after {summary.found_s:.0f} s by {summary.found_by}, {summary.error_m:.0f} m off"
    then = f"by then {100 * summary.detection_then:.0f} %"
    lines = [f"{how}; probability of detection {then}", *_counted(summary)]
    what = "to detection"
    if summary.declare is not None:
        what = "to some true report"
        end = "" if summary.detection is None else f", {100 * summary.detection:.0f} % in the end"
        lines[0] = how
        lines.append(f"some true report, predicted: {then}{end}; with false alarms not yet a finding")
    if summary.outside_then is not None:
        left = "by then the target has left the area undetected with a probability of"
        end = f"{summary.duration_s:.0f} s, nobody reporting"
        later = "" if summary.outside is None else f", of {100 * summary.outside:.0f} % by {end}"
        lines.append(f"{left} {100 * summary.outside_then:.0f} %{later}")
    if summary.comparison:
        means = (f"{name} {quality.mean_time_s:.0f} s" for name, quality in summary.comparison.items())
        lines.append(f"mean time {what}, cut at {summary.duration_s:.0f} s: {', '.join(means)}")
    return [*lines, f"pictures: {folder / 'pdf.png'}, {folder / 'detection.png'}; all else beside them"]


def _counted(summary: SearchSummary) -> list[str]:
    """Say what was counted, where that is another thing than what is predicted, or disagrees with it."""
    counted, rule = summary.counted, summary.declare
    if counted is None:
        return []
    if rule is not None:
        sure = f"a posterior of {100 * rule.probability:g} % within {rule.radius_m:g} m"
        return [
            f"declared found, counted over {counted.trials} searches: {100 * counted.found:.0f} % "
            f"({100 * counted.found_low:.0f} to {100 * counted.found_high:.0f} %); declared where it is not: "
            f"{counted.mistaken}; never declared: {counted.missed}; declared at {sure}"
        ]
    if counted.off is not None and counted.off > counted.band:
        return [
            f"counted over {many(counted.trials, 'target')} detection is off the predicted by up to "
            f"{counted.off:.3f}, more than the 95 % band of {counted.band:.3f}: smaller cells predict better"
        ]
    return []


LEAVES = (RECORD, "summary.json", "timing.json", "pdf.png", "detection.png")
SEARCHING = Kind(search_display, SearchMcapWriter, write_outputs, closing, LEAVES)
