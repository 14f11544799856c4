"""The files that a search leaves, beside the run record, which grows while it lasts."""

from __future__ import annotations

from vedette.record.folder import OutputFolder
from vedette.record.search.observer import SearchReport
from vedette.record.search.summary import ended_how
from vedette.record.summary import write_figures


def write_outputs(report: SearchReport, folder: OutputFolder, animate: bool = False) -> None:
    """Write figures and pictures; ``animate``: a GIF as well."""
    # who only asks for help, or runs a study, does not wait for matplotlib
    from vedette.record.search.detection import detection_png
    from vedette.record.search.panel import search_gif
    from vedette.record.search.stages import pdf_png

    write_figures(report.summary, report.timing, folder)
    pdf_png(report.log, ended_how(vars(report.summary)), folder / "pdf.png")
    detection_png(report.curves, report.summary, folder / "detection.png")
    if animate:
        search_gif(report.log, folder / "mission.gif")
