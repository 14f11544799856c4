"""The files that a tracking mission leaves, beside the run record, which grows while it lasts."""

from __future__ import annotations

from vedette.record.folder import OutputFolder
from vedette.record.summary import write_figures
from vedette.record.track.observer import TrackReport


def write_outputs(report: TrackReport, folder: OutputFolder, animate: bool = False) -> None:
    """Write figures and pictures; ``animate``: a GIF as well."""
    # who only asks for help, or runs a study, does not wait for matplotlib
    from vedette.record.track.entropy import entropy_png
    from vedette.record.track.panel import track_gif
    from vedette.record.track.tracks import tracks_png

    write_figures(report.summary, report.timing, folder)
    tracks_png(report.log, folder / "tracks.png")
    logs = {report.summary.coordination: report.log, **report.others}
    entropy_png(logs, report.left_out, folder / "entropy.png")
    if animate:
        track_gif(report.log, folder / "mission.gif")
