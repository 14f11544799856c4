"""``tracks.png``: the mission in three stages."""

from __future__ import annotations

from pathlib import Path

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import picture, save
from vedette.record.panels import LINE, MARGIN, STACKED, Panels, name_team, per_row
from vedette.record.signs import DASHES, explain, scale_bar
from vedette.record.track.log import TrackLog, TrackScene
from vedette.record.track.panel import INK, KNOWN, TRUTH, Box, draw, window

_STAGES = 0.1, 0.5, 1.0  # shares of the time: while targets are being found, and two while they are kept
_LEAST = 8.2  # width of the figure, for the signs in one line [inch]


def tracks_png(log: TrackLog, path: Path | str) -> None:
    """Draw vehicles, views, plans, true and estimated targets at three stages of a log that is not empty."""
    box, scene, last = window(log), log.scene, log.snapshots[-1]
    layout = _layout(box, scene)
    with picture():
        figure = layout.figure()
        for corner, stage in zip(layout.corners, log.stages(_STAGES), strict=True):
            draw(layout.add(figure, *corner, *layout.panel), log, stage, box)
        counts = f"{many(len(scene.vehicles), 'vehicle')}, {many(len(scene.targets), 'target')}"
        layout.head(figure, f"{scene.name}: {counts}", f"tracks as {scene.vehicles[last.holder]} holds them")
        scale_bar(figure, MARGIN, layout.lowest - 0.16, box[2] - box[0], layout.panel[0])
        labels = [
            f"{name} ({sensor}{'' if vehicle.alive else ', lost'})"
            for name, sensor, vehicle in zip(scene.vehicles, scene.sensors, last.vehicles, strict=True)
        ]
        row = _vehicles_a_row(layout.width, scene)
        y = name_team(figure, layout.lowest - 0.46, labels, last.vehicles, row)
        explain(figure, MARGIN, y, _signs())
        save(figure, path)


def _layout(box: Box, scene: TrackScene) -> Panels:
    """Fit the panels: side by side, or one above the other where the area is far wider than high."""
    aspect = (box[2] - box[0]) / (box[3] - box[1])
    stacked = aspect > STACKED
    width = 9.0 if stacked else max(1.5, min(4.2, 6.0 * aspect))
    panel = width, min(9.0, max(0.5, width / aspect))
    team = len(scene.vehicles)

    def below(width: float) -> float:
        return 0.5 + LINE * (-(-team // _vehicles_a_row(width, scene)) + 1)

    return Panels.in_a_row(panel, len(_STAGES), stacked, _LEAST, below)


def _vehicles_a_row(width: float, scene: TrackScene) -> int:
    names = (f"{name} ({sensor})" for name, sensor in zip(scene.vehicles, scene.sensors, strict=True))
    return per_row(width, max(map(len, names)))


def _signs() -> list[Line2D | Patch]:
    grey = palette.unit(palette.FAINT)
    return [
        Line2D((), (), color=grey, lw=1.4, label="flown, the last 20 s"),
        Line2D((), (), color=(*grey, 0.4), lw=0.9, label="before"),
        Line2D((), (), color=grey, lw=1.4, ls=DASHES, label="planned"),
        Patch(fc=(*grey, 0.12), ec=(*grey, 0.5), lw=0.6, label="view"),
        Line2D((), (), color=TRUTH, lw=0.9, marker="x", ms=5, mew=1.2, label="true target"),
        Line2D((), (), ls="", marker="o", ms=8, mfc=(*KNOWN, 0.28), mec=INK, mew=0.9, label="estimate, 95 %"),
    ]
