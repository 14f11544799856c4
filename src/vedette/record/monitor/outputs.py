"""The files that monitoring leaves, beside the run record, which grows while it lasts."""

from __future__ import annotations

from vedette.record.folder import OutputFolder
from vedette.record.monitor.curves import curves_png
from vedette.record.monitor.observer import MonitorReport
from vedette.record.monitor.panels import field_png, monitor_gif
from vedette.record.summary import write_figures


def write_outputs(report: MonitorReport, folder: OutputFolder, animate: bool = False) -> None:
    """Write figures and pictures; ``animate``: a GIF as well."""
    write_figures(report.summary, report.timing, folder)
    field_png(report, folder / "field.png")
    logs = {report.summary.coordination: report.log, **report.others}
    curves_png(logs, report.summary.seed, folder / "curves.png")
    if animate:
        monitor_gif(report.log, folder / "mission.gif")
