"""``entropy.png``: what was known of the targets against time, by way of coordination, and how honestly."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save, tidy
from vedette.record.track.log import TrackLog
from vedette.record.track.summary import dimensions, nees_band

_SIZE = 8.0, 6.0  # [inch]
_FAINT = palette.unit(palette.FAINT)
_STYLES: dict[str, dict[str, Any]] = {  # a line differs in more than its colour
    "none": {"color": palette.unit((213, 94, 0)), "ls": (0, (1, 1.2)), "lw": 1.6, "zorder": 2},
    "shared": {"color": palette.unit((0, 158, 115)), "ls": (0, (6, 2)), "lw": 1.6, "zorder": 3},
    "negotiated": {"color": palette.unit((0, 114, 178)), "ls": "-", "lw": 2.2, "zorder": 4},
    "optimum": {"color": palette.unit((40, 42, 46)), "ls": (0, (4, 1.5, 1, 1.5)), "lw": 1.1, "zorder": 5},
}
_MEANING = {
    "none": "none: nobody tells anybody anything",
    "shared": "shared: one belief, everybody plans alone",
    "negotiated": "negotiated",
    "optimum": "optimum: every joint choice tried, each round",
}


def entropy_png(logs: Mapping[str, TrackLog], left_out: Mapping[str, str], path: Path | str) -> None:
    """Draw the entropy of the targets and the NEES of each log, by coordination; at least one.

    ``left_out`` says why other ways are not there.
    """
    some = next(iter(logs.values()))
    with picture():
        figure = Figure(figsize=_SIZE, dpi=DPI)
        grid = figure.add_gridspec(
            2, 1, height_ratios=(2, 1), hspace=0.1, left=0.095, right=0.98, top=0.915, bottom=0.085
        )
        above = figure.add_subplot(grid[0])
        below = figure.add_subplot(grid[1], sharex=above)
        _entropy(above, logs, left_out)
        _nees(below, logs, dimensions(some.scene))
        for axes in (above, below):
            tidy(axes, "y")
            axes.tick_params(labelbottom=axes is below)
        above.set_xlim(0.0, max(float(log.times[-1]) for log in logs.values()) or 1.0)
        scene = some.scene
        counts = f"{many(len(scene.vehicles), 'vehicle')}, {many(len(scene.targets), 'target')}"
        figure.text(0.095, 0.945, f"{scene.name}: {counts}", fontsize=12, fontweight="bold")
        figure.align_ylabels()
        save(figure, path)


def _entropy(axes: Axes, logs: Mapping[str, TrackLog], left_out: Mapping[str, str]) -> None:
    handles = []
    for name in (name for name in _STYLES if name in logs):
        entropy = logs[name].curve(lambda snapshot: snapshot.entropy)
        label = f"{_MEANING[name]}  (mean {entropy.mean():.1f} nat)"
        handles += axes.plot(logs[name].times, entropy, label=label, **_STYLES[name])
    for name, why in left_out.items():
        text = f"{name}: not there ({why})"
        handles.append(Line2D((), (), ls="", label=text if len(text) < 80 else f"{text[:78]}…)"))
    axes.legend(handles=handles, loc="upper right", framealpha=0.9, edgecolor="none", labelspacing=0.4)
    curves = np.concatenate([log.curve(lambda snapshot: snapshot.entropy) for log in logs.values()])
    low, high = float(curves.min()), float(curves.max())
    room = max(1.0, high - low)
    axes.set(ylabel="entropy of all targets [nat]", ylim=(low - 0.05 * room, high + 0.3 * room))


def _nees(axes: Axes, logs: Mapping[str, TrackLog], numbers: int) -> None:
    """Draw the NEES a dimension, and where it should be nineteen times in twenty."""
    low, high = nees_band(numbers)
    axes.axhspan(low, high, color=palette.unit((225, 227, 230)), alpha=0.7, lw=0, zorder=0)
    axes.axhline(1.0, color=_FAINT, lw=0.8, zorder=1)
    top = high
    for name in (name for name in _STYLES if name in logs):
        nees = logs[name].curve(lambda snapshot: snapshot.nees)
        axes.plot(logs[name].times, nees, **(_STYLES[name] | {"lw": 1.0}))
        top = max(top, float(np.quantile(nees, 0.98)))
    text = "95 % band of a consistent filter"
    axes.annotate(text, (0.99, low), (0, -3), xycoords=("axes fraction", "data"),
                  textcoords="offset points", ha="right", va="top", fontsize=8, color=_FAINT)  # fmt: skip
    axes.set(ylabel="NEES a dimension", xlabel="time [s]", ylim=(0.0, 1.15 * min(top, 6.0)))
