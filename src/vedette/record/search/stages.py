"""``pdf.png``: where the target may be, at four stages of the search."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.colors import PowerNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import picture, save
from vedette.record.key import LINE, Key, badges, with_fate
from vedette.record.panels import MARGIN, TITLE, Panels
from vedette.record.search.log import SearchLog
from vedette.record.search.panel import TRUTH, colours, draw, scale
from vedette.record.signs import DASHES, FAINT, INK, explain, scale_bar

_GAP, _TOP = 0.16, 0.74  # between panels, over them [inch]
_LEAST = 8.0  # width of the figure, for the signs in one line [inch]
_RAMP = 1.3  # width of the colour scale [inch]


def pdf_png(log: SearchLog, how: str, path: Path | str) -> None:
    """Draw pdf, vehicles, ways and plans at stages of a log that is not empty; the target in the last.

    ``how``: it ended, for the title.
    """
    stages = log.stages()
    layout, norm = _layout(log, len(stages)), scale(log)
    with picture():
        figure = layout.figure()
        for corner, stage in zip(layout.corners, stages, strict=True):
            draw(layout.add(figure, *corner, *layout.panel), log, stage, norm, stage is stages[-1])
        layout.head(figure, f"{log.scene.name}: {many(len(log.scene.vehicles), 'vehicle')}", how)
        frame = log.scene.frame
        scale_bar(figure, MARGIN, layout.lowest - 0.18, frame.cols * frame.resolution, layout.panel[0])
        _legend(figure, layout, log, norm)
        save(figure, path)


def _layout(log: SearchLog, count: int) -> Panels:
    """Two panels side by side, or one above the other where the area is far wider than high."""
    aspect = log.scene.frame.cols / log.scene.frame.rows
    across = 1 if aspect > 3.0 else min(2, count)
    wide = 9.0 if across == 1 else 4.7
    panel = (wide, wide / aspect) if wide / aspect < 6.5 else (max(0.5, 6.5 * aspect), 6.5)
    width = max(_LEAST, across * panel[0] + (across - 1) * _GAP + 2 * MARGIN)
    rows = -(-count // across)
    below = 0.62 + LINE * (_team(log, width).lines + 1)
    step = panel[1] + TITLE
    corners = tuple(
        (MARGIN + (k % across) * (panel[0] + _GAP), below + (rows - 1 - k // across) * step)
        for k in range(count)
    )
    return Panels(width, below + rows * step + _TOP - TITLE, panel, corners)


def _team(log: SearchLog, width: float) -> Key:
    return Key.of(with_fate(log.scene.vehicles, log.snapshots[-1].vehicles), width - 2 * MARGIN)


def _legend(figure: Figure, layout: Panels, log: SearchLog, norm: PowerNorm) -> None:
    """Name the vehicles, explain the signs and the colours."""
    team = _team(log, layout.width)
    y = team.write(figure, MARGIN, layout.lowest - 0.5, badges(log.snapshots[-1].vehicles))
    signs = [
        Line2D((), (), color=FAINT, lw=1.2, label="flown"),
        Line2D((), (), color=FAINT, lw=1.4, ls=DASHES, label="planned"),
        Line2D((), (), color=(*FAINT, 0.25), lw=7, label="what that sweeps"),
        Line2D((), (), color=TRUTH, marker="*", ms=11, mec=INK, mew=0.7, lw=1.4, label="true target"),
    ]
    explain(figure, MARGIN, y, signs)
    _ramp(figure, layout, log, norm)


def _ramp(figure: Figure, layout: Panels, log: SearchLog, norm: PowerNorm) -> None:
    """Show the colours, as probability a hectare, right under the panels."""
    hectare = 1e4 / log.scene.frame.resolution**2
    most = float(norm.vmax or 0.0)
    half = most * 0.5 ** (1.0 / norm.gamma)
    x, y = layout.width - MARGIN - _RAMP, layout.lowest - 0.24
    axes = layout.add(figure, x, y, _RAMP, 0.12)
    axes.imshow(np.linspace(0.0, 1.0, 200)[None], cmap=colours(), aspect="auto", extent=(0, 1, 0, 1))
    axes.set(xticks=(), yticks=())
    axes.spines[:].set(color=palette.unit((200, 203, 207)), lw=0.5)
    axes.text(-0.04, 0.5, "probability a hectare   0", ha="right", va="center_baseline", fontsize=8)
    for at, value, align in ((0.5, half, "center"), (1.0, most, "right")):
        axes.text(at, -0.35, f"{100 * value * hectare:.2g} %", ha=align, va="top", fontsize=8)
