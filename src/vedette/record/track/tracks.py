"""``tracks.png``: the mission in three stages."""

from __future__ import annotations

from pathlib import Path

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import picture, save
from vedette.record.key import LINE, Key, badges
from vedette.record.panels import MARGIN, STACKED, Panels
from vedette.record.signs import DASHES, explain, scale_bar
from vedette.record.track.letters import letter
from vedette.record.track.log import TrackLog, TrackScene
from vedette.record.track.panel import INK, KNOWN, TRUTH, Box, draw, labels_of, window

_STAGES = 0.1, 0.5, 1.0  # shares of the time: while targets are being found, and two while they are kept
_LEAST = 8.2  # width of the figure, for the signs in one line [inch]


def tracks_png(log: TrackLog, path: Path | str) -> None:
    """Draw vehicles, views, plans, true and estimated targets at three stages of a log that is not empty."""
    box, scene, last = window(log), log.scene, log.snapshots[-1]
    layout = _layout(box, log)
    with picture():
        figure = layout.figure()
        for corner, stage in zip(layout.corners, log.stages(_STAGES), strict=True):
            draw(layout.add(figure, *corner, *layout.panel), log, stage, box)
        counts = f"{many(len(scene.vehicles), 'vehicle')}, {many(len(scene.targets), 'target')}"
        layout.head(figure, f"{scene.name}: {counts}", f"tracks as {scene.vehicles[last.holder]} holds them")
        scale_bar(figure, MARGIN, layout.lowest - 0.16, box[2] - box[0], layout.panel[0])
        vehicles, targets = _team(log, layout.width), _targets(scene, layout.width)
        y = vehicles.write(figure, MARGIN, layout.lowest - 0.46, badges(last.vehicles))
        y = targets.write(figure, MARGIN, y, [letter(t) for t in range(len(targets.labels))])
        explain(figure, MARGIN, y, _signs())
        save(figure, path)


def _layout(box: Box, log: TrackLog) -> Panels:
    """Fit the panels: side by side, or one above the other where the area is far wider than high."""
    aspect = (box[2] - box[0]) / (box[3] - box[1])
    stacked = aspect > STACKED
    width = 9.0 if stacked else max(1.5, min(4.2, 6.0 * aspect))
    panel = width, min(9.0, max(0.5, width / aspect))

    def below(width: float) -> float:
        return 0.5 + LINE * (_team(log, width).lines + _targets(log.scene, width).lines + 1)

    return Panels.in_a_row(panel, len(_STAGES), stacked, _LEAST, below)


def _team(log: TrackLog, width: float) -> Key:
    """Name the vehicles, their sensors, and what became of them."""
    scene, last = log.scene, log.snapshots[-1]
    labels = [
        f"{name} ({sensor}{f', {vehicle.fate}' if vehicle.fate else ''})"
        for name, sensor, vehicle in zip(scene.vehicles, scene.sensors, last.vehicles, strict=True)
    ]
    return Key.of(labels, width - 2 * MARGIN)


def _targets(scene: TrackScene, width: float) -> Key:
    """Name the targets that the panels call by letters."""
    by_letter = labels_of(scene) not in ([], scene.targets)
    return Key.of(scene.targets if by_letter else (), width - 2 * MARGIN)


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
