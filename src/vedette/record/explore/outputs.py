"""The files that an exploration leaves, beside the run record, which grows while it lasts."""

from __future__ import annotations

from vedette.maps import write_map
from vedette.record.explore.observer import ExploreReport
from vedette.record.folder import OutputFolder
from vedette.record.summary import write_figures


def write_outputs(report: ExploreReport, folder: OutputFolder, animate: bool = False) -> None:
    """Write figures, map and pictures; ``animate``: a GIF as well."""
    # who only asks for help, or runs a study, does not wait for matplotlib
    from vedette.record.explore.curves import curves_png
    from vedette.record.explore.film import explore_gif
    from vedette.record.explore.progress import progress_png

    write_figures(report.summary, report.timing, folder)
    write_map(folder / "map", report.log.scene.frame, report.classes)
    progress_png(report.log, folder / "progress.png")
    curves_png(report.log, report.summary, folder / "curves.png")
    if animate:
        explore_gif(report.log, folder / "mission.gif")
