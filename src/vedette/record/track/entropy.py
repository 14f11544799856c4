"""``entropy.png``: what was known of the targets against time, by way of coordination, and how honestly."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import picture, save
from vedette.record.lettering import shortened
from vedette.record.strips import LEFT, RIGHT, WIDTH, Strip, Strips, legend_above
from vedette.record.track.log import TrackLog
from vedette.record.track.summary import dimensions, nees_band

_FAINT = palette.unit(palette.FAINT)
_BAND = palette.unit((225, 227, 230))
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
    scene = next(iter(logs.values())).scene
    team = f"{many(len(scene.vehicles), 'vehicle')}, {many(len(scene.targets), 'target')}"
    with picture():
        strips = Strips.make((Strip(3.1, len(logs) + len(left_out)), Strip(1.6, 1)), f"{scene.name}: {team}")
        above, below = strips.axes
        _entropy(above, logs, left_out)
        _nees(below, logs, dimensions(scene))
        above.set_xlim(0.0, max(float(log.times[-1]) for log in logs.values()) or 1.0)
        save(strips.figure, path)


def _entropy(axes: Axes, logs: Mapping[str, TrackLog], left_out: Mapping[str, str]) -> None:
    handles = []
    for name in (name for name in _STYLES if name in logs):
        entropy = logs[name].curve(lambda snapshot: snapshot.entropy)
        label = f"{_MEANING[name]}  (mean {entropy.mean():.1f} nat)"
        handles += axes.plot(logs[name].times, entropy, label=label, **_STYLES[name])
    for name, why in left_out.items():
        text = shortened(f"{name}: not there ({why})", WIDTH - LEFT - RIGHT - 0.4)
        handles.append(Line2D((), (), ls="", label=text))
    legend_above(axes, handles)
    curves = np.concatenate([log.curve(lambda snapshot: snapshot.entropy) for log in logs.values()])
    low, high = float(curves.min()), float(curves.max())
    room = 0.05 * max(1.0, high - low)
    axes.set(ylabel="entropy of all targets [nat]", ylim=(low - room, high + room))


def _nees(axes: Axes, logs: Mapping[str, TrackLog], numbers: int) -> None:
    """Draw the NEES a dimension, and where it should be nineteen times in twenty."""
    low, high = nees_band(numbers)
    axes.axhspan(low, high, color=_BAND, alpha=0.7, lw=0, zorder=0)
    axes.axhline(1.0, color=_FAINT, lw=0.8, zorder=1)
    top = high
    for name in (name for name in _STYLES if name in logs):
        nees = logs[name].curve(lambda snapshot: snapshot.nees)
        axes.plot(logs[name].times, nees, **(_STYLES[name] | {"lw": 1.0}))
        top = max(top, float(np.quantile(nees, 0.98)))
    axes.set(ylabel="NEES a dimension", ylim=(0.0, 1.15 * min(top, 6.0)))
    legend_above(axes, [Patch(color=_BAND, alpha=0.7, lw=0, label="95 % band of a consistent filter")])
