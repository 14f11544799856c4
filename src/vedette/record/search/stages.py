"""``pdf.png``: where the target may be, at four stages of the search."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.colors import PowerNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from vedette.record import palette
from vedette.record.canvas import DPI, picture, save
from vedette.record.search.log import SearchLog
from vedette.record.search.panel import TRUTH, colours, draw, scale
from vedette.record.search.summary import SearchSummary
from vedette.record.signs import DASHES, FAINT, INK, badge, legend_line, scale_bar

_GAP, _MARGIN, _TOP, _LINE, _TITLE = 0.16, 0.2, 0.74, 0.25, 0.3  # [inch]
_LEAST = 8.0  # width of the figure, for the signs in one line [inch]
_RAMP = 1.3  # width of the colour scale [inch]


@dataclass(frozen=True)
class _Layout:
    """Sizes of the figure [inch]."""

    width: float
    height: float
    panel: tuple[float, float]
    corners: tuple[tuple[float, float], ...]  # lower-left of each panel
    per_row: int  # vehicles in a line of the legend
    legend: float  # middle of its first line


def pdf_png(log: SearchLog, summary: SearchSummary, path: Path | str) -> None:
    """Draw pdf, vehicles, ways and plans at stages of a log that is not empty; the target in the last."""
    stages = log.stages()
    layout, norm = _layout(log, len(stages)), scale(log)
    with picture():
        figure = Figure(figsize=(layout.width, layout.height), dpi=DPI)
        for (x, y), stage in zip(layout.corners, stages, strict=True):
            box = x / layout.width, y / layout.height
            size = layout.panel[0] / layout.width, layout.panel[1] / layout.height
            draw(figure.add_axes((*box, *size)), log, stage, norm, stage is stages[-1])
        _heading(figure, layout, log, summary)
        frame = log.scene.frame
        low = layout.corners[-1][1] - 0.18
        scale_bar(figure, _MARGIN, low, frame.cols * frame.resolution, layout.panel[0])
        _legend(figure, layout, log, norm)
        save(figure, path)


def _layout(log: SearchLog, count: int) -> _Layout:
    """Two panels side by side, or one above the other where the area is far wider than high."""
    frame = log.scene.frame
    aspect = frame.cols / frame.rows
    across = 1 if aspect > 3.0 else min(2, count)
    wide = 9.0 if across == 1 else 4.7
    panel = (wide, wide / aspect) if wide / aspect < 6.5 else (max(0.5, 6.5 * aspect), 6.5)
    width = max(_LEAST, across * panel[0] + (across - 1) * _GAP + 2 * _MARGIN)
    rows = -(-count // across)
    names = max(len(name) for name in log.scene.vehicles) + 7
    per_row = max(1, int((width - 2 * _MARGIN) / (0.5 + 0.075 * names)))
    below = 0.62 + _LINE * (-(-len(log.scene.vehicles) // per_row) + 1)
    step = panel[1] + _TITLE
    corners = tuple(
        (_MARGIN + (k % across) * (panel[0] + _GAP), below + (rows - 1 - k // across) * step)
        for k in range(count)
    )
    return _Layout(width, below + rows * step + _TOP - _TITLE, panel, corners, per_row, below - 0.5)


def _heading(figure: Figure, layout: _Layout, log: SearchLog, summary: SearchSummary) -> None:
    """Write over the panels whose search this is and how it ended."""
    count = len(log.scene.vehicles)
    y, left = 1 - 0.2 / layout.height, _MARGIN / layout.width
    team = f"{log.scene.name}: {count} vehicle" + ("s" if count > 1 else "")
    figure.text(left, y, team, fontsize=12, fontweight="bold", va="top")
    ended = f"{summary.outcome.value.replace('_', ' ')}"
    if summary.found_by is not None:
        ended = f"found by {summary.found_by} after {summary.found_s:.0f} s"
    figure.text(1 - left, y, f"{summary.coordination}, {ended}", ha="right", va="top", color=FAINT)


def _legend(figure: Figure, layout: _Layout, log: SearchLog, norm: PowerNorm) -> None:
    """Name the vehicles, explain the signs and the colours."""
    last, y = log.snapshots[-1], layout.legend
    badges = [badge(i, vehicle.alive) for i, vehicle in enumerate(last.vehicles)]
    labels = [
        name + ("" if vehicle.alive else " (lost)")
        for name, vehicle in zip(log.scene.vehicles, last.vehicles, strict=True)
    ]
    for first in range(0, len(badges), layout.per_row):
        some = slice(first, first + layout.per_row)
        legend_line(figure, _MARGIN, y, badges[some], labels[some])
        y -= _LINE
    signs = [
        Line2D((), (), color=FAINT, lw=1.2, label="flown"),
        Line2D((), (), color=FAINT, lw=1.4, ls=DASHES, label="planned"),
        Line2D((), (), color=(*FAINT, 0.25), lw=7, label="what that sweeps"),
        Line2D((), (), color=TRUTH, marker="*", ms=11, mec=INK, mew=0.7, lw=1.4, label="true target"),
    ]
    legend_line(figure, _MARGIN, y, signs, [str(sign.get_label()) for sign in signs])
    _ramp(figure, layout, log, norm)


def _ramp(figure: Figure, layout: _Layout, log: SearchLog, norm: PowerNorm) -> None:
    """Show the colours, as probability a hectare, right under the panels."""
    hectare = 1e4 / log.scene.frame.resolution**2
    most = float(norm.vmax or 0.0)
    x, y = layout.width - _MARGIN - _RAMP, layout.corners[-1][1] - 0.24
    axes = figure.add_axes((x / layout.width, y / layout.height, _RAMP / layout.width, 0.12 / layout.height))
    values = np.linspace(0.0, most, 200)[None]
    axes.imshow(values, cmap=colours(), norm=norm, aspect="auto", extent=(0, 1, 0, 1))
    axes.set(xticks=(), yticks=())
    axes.spines[:].set(color=palette.unit((200, 203, 207)), lw=0.5)
    axes.text(-0.04, 0.5, "probability a hectare   0", ha="right", va="center_baseline", fontsize=8)
    text = f"{100 * most * hectare:.2g} %"
    axes.text(1.0, -0.35, text, ha="right", va="top", fontsize=8)
