"""``curves.png``: error and entropy against time and against the way, for all ways of coordination."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save, tidy
from vedette.record.lettering import shortened
from vedette.record.monitor.log import MonitorLog
from vedette.record.signs import FAINT, INK

_STYLES: dict[str, dict[str, Any]] = {  # a line differs in more than its colour
    "random": {"color": palette.unit((150, 153, 157)), "ls": (0, (1, 1.2)), "lw": 1.5, "zorder": 2},
    "lawnmower": {"color": INK, "ls": (0, (5, 1.5, 1, 1.5)), "lw": 1.5, "zorder": 3},
    "none": {"color": palette.unit((213, 94, 0)), "ls": (0, (1, 1.2)), "lw": 1.8, "zorder": 4},
    "shared": {"color": palette.unit((0, 158, 115)), "ls": (0, (6, 2)), "lw": 1.8, "zorder": 5},
    "optimum": {"color": palette.unit((204, 121, 167)), "ls": (0, (3, 1)), "lw": 1.8, "zorder": 6},
    "negotiated": {"color": palette.unit((0, 114, 178)), "ls": "-", "lw": 2.2, "zorder": 7},
}
_MEANING = {
    "random": "random places",
    "lawnmower": "lawn-mower, a strip each",
    "none": "none: nobody tells anybody anything",
    "shared": "shared: one belief, everybody plans alone",
    "optimum": "optimum of each round",
    "negotiated": "negotiated",
}
_SIZE = 9.6, 6.2  # [inch]


def curves_png(logs: Mapping[str, MonitorLog], seed: int, path: Path | str) -> None:
    """Draw all curves that there are, by coordination."""
    with picture():
        figure = Figure(figsize=_SIZE, dpi=DPI)
        grid = figure.add_gridspec(
            2, 2, left=0.085, right=0.98, top=0.80, bottom=0.085, hspace=0.16, wspace=0.16
        )
        for row, (of, label) in enumerate((("rmse", "error (rms)"), ("entropy", "entropy [nat]"))):
            for column in range(2):
                axes = figure.add_subplot(grid[row, column])
                _draw(axes, logs, of, column)
                if column == 0:
                    axes.set_ylabel(label)
                if row == 1:
                    axes.set_xlabel("way of a vehicle, in the mean [m]" if column else "time [s]")
                else:
                    axes.tick_params(labelbottom=False)
        _head(figure, seed, logs)
        save(figure, path)


def _draw(axes: Axes, logs: Mapping[str, MonitorLog], of: str, column: int) -> None:
    """Draw a figure of all logs against time (0) or way (1)."""
    tidy(axes)
    for name in (name for name in _STYLES if name in logs):
        curve = logs[name].against(of)
        axes.plot(curve[column], curve[2], label=_MEANING[name], **_STYLES[name])
    axes.set_xlim(left=0.0)
    if of == "rmse":
        axes.set_ylim(bottom=0.0)


def _head(figure: Figure, seed: int, logs: Mapping[str, MonitorLog]) -> None:
    scene = next(iter(logs.values())).scene
    title = shortened(f"{scene.name}: {many(len(scene.vehicles), 'vehicle')}", _SIZE[0] - 2.0, 12, True)
    figure.text(0.085, 0.955, title, fontsize=12, fontweight="bold")
    figure.text(0.98, 0.955, f"seed {seed}", ha="right", color=FAINT)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    order = sorted(range(len(labels)), key=lambda k: list(_MEANING.values()).index(labels[k]), reverse=True)
    figure.legend(
        [handles[k] for k in order], [labels[k] for k in order], loc="upper left",
        bbox_to_anchor=(0.075, 0.94), ncols=2, frameon=False, columnspacing=1.6, handlelength=3.2,
    )  # fmt: skip
