"""``tracks.png``: the mission in three stages."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from vedette.record import palette
from vedette.record.canvas import DPI, picture, save
from vedette.record.signs import DASHES, badge, legend_line, scale_bar
from vedette.record.track.log import TrackLog
from vedette.record.track.panel import INK, KNOWN, TRUTH, Box, draw, window

_GAP, _MARGIN, _TOP, _LINE = 0.14, 0.2, 0.72, 0.25  # [inch]
_STAGES = 0.1, 0.5, 1.0  # shares of the time: while targets are being found, and two while they are kept
_LEAST = 8.2  # width of the figure, for the signs in one line [inch]


@dataclass(frozen=True)
class _Layout:
    """Sizes of the figure [inch]."""

    width: float
    height: float
    panel: tuple[float, float]
    corners: tuple[tuple[float, float], ...]  # lower-left of each panel
    per_row: int  # vehicles in a line of the legend


def tracks_png(log: TrackLog, path: Path | str) -> None:
    """Draw vehicles, views, plans, true and estimated targets at three stages of a log that is not empty."""
    box = window(log)
    layout = _layout(box, log)
    with picture():
        figure = Figure(figsize=(layout.width, layout.height), dpi=DPI)
        for (x, y), stage in zip(layout.corners, log.stages(_STAGES), strict=True):
            axes = figure.add_axes(_part(layout, x, y, *layout.panel))
            draw(axes, log, stage, box)
        _heading(figure, layout, log)
        lowest = min(corner[1] for corner in layout.corners)
        scale_bar(figure, layout.corners[0][0], lowest - 0.16, box[2] - box[0], layout.panel[0])
        _legend(figure, layout, log)
        save(figure, path)


def _layout(box: Box, log: TrackLog) -> _Layout:
    """Fit the panels: side by side, or one above the other where the area is far wider than high."""
    aspect = (box[2] - box[0]) / (box[3] - box[1])
    stacked = aspect > 2.2
    panel_width = 9.0 if stacked else max(1.5, min(4.2, 6.0 * aspect))
    panel = panel_width, min(9.0, max(0.5, panel_width / aspect))
    count = len(_STAGES)
    across = 1 if stacked else count
    width = max(_LEAST, across * panel_width + (across - 1) * _GAP + 2 * _MARGIN)
    names = [f"{n} ({s})" for n, s in zip(log.scene.vehicles, log.scene.sensors, strict=True)]
    per_row = max(1, int((width - 2 * _MARGIN) / (0.5 + 0.075 * max(map(len, names)))))
    bottom = 0.5 + _LINE * (-(-len(names) // per_row) + 1)
    step = panel[1] + 0.3
    if stacked:
        corners = tuple((_MARGIN, bottom + step * (count - 1 - i)) for i in range(count))
        return _Layout(width, bottom + step * count + _TOP - 0.3, panel, corners, per_row)
    pitch = (width - 2 * _MARGIN - panel_width) / (count - 1)
    corners = tuple((_MARGIN + i * pitch, bottom) for i in range(count))
    return _Layout(width, bottom + panel[1] + _TOP, panel, corners, per_row)


def _heading(figure: Figure, layout: _Layout, log: TrackLog) -> None:
    """Write over the panels whose tracks these are."""
    scene, last = log.scene, log.snapshots[-1]
    counts = f"{len(scene.vehicles)} vehicles, {len(scene.targets)} targets"
    y = 1 - 0.2 / layout.height
    figure.text(
        _MARGIN / layout.width, y, f"{scene.name}: {counts}", fontsize=12, fontweight="bold", va="top"
    )
    held = f"tracks as {scene.vehicles[last.holder]} holds them"
    figure.text(1 - _MARGIN / layout.width, y, held, ha="right", va="top", color=palette.unit(palette.FAINT))


def _legend(figure: Figure, layout: _Layout, log: TrackLog) -> None:
    """Name the vehicles with their sensors, and explain the signs."""
    last, scene = log.snapshots[-1], log.scene
    badges = [badge(i, vehicle.alive) for i, vehicle in enumerate(last.vehicles)]
    labels = [
        f"{name} ({sensor}{'' if vehicle.alive else ', lost'})"
        for name, sensor, vehicle in zip(scene.vehicles, scene.sensors, last.vehicles, strict=True)
    ]
    y = min(corner[1] for corner in layout.corners) - 0.46
    for first in range(0, len(badges), layout.per_row):
        some = slice(first, first + layout.per_row)
        legend_line(figure, _MARGIN, y, badges[some], labels[some])
        y -= _LINE
    signs = _signs()
    legend_line(figure, _MARGIN, y, signs, [str(sign.get_label()) for sign in signs])


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


def _part(
    layout: _Layout, x: float, y: float, width: float, height: float
) -> tuple[float, float, float, float]:
    """Return a rectangle [inch] in figure fractions."""
    return x / layout.width, y / layout.height, width / layout.width, height / layout.height
