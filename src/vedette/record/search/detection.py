"""``detection.png``: the probability that the target has been detected, or found, against time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save, tidy
from vedette.record.search.curves import Curves
from vedette.record.search.summary import SearchSummary
from vedette.record.signs import FAINT, INK

_SIZE = 8.0, 5.2  # [inch]
_STYLES: dict[str, dict[str, Any]] = {  # a line differs in more than its colour
    "none": {"color": palette.unit((213, 94, 0)), "ls": (0, (1, 1.2)), "lw": 1.7, "zorder": 3},
    "shared": {"color": palette.unit((0, 158, 115)), "ls": (0, (6, 2)), "lw": 1.7, "zorder": 4},
    "negotiated": {"color": palette.unit((0, 114, 178)), "ls": "-", "lw": 2.2, "zorder": 5},
}
_WRONG = palette.unit((204, 121, 167))
_MEANING = {
    "none": "none: nobody tells anybody anything",
    "shared": "shared: one belief, everybody plans alone",
    "negotiated": "negotiated",
}


def detection_png(curves: Curves, summary: SearchSummary, path: Path | str) -> None:
    """Draw the predicted curves by coordination, what was counted, the bound and Koopman's ideal.

    With false alarms a true report is not yet a finding: what was declared comes first, by a name of its own.
    """
    with picture():
        figure = Figure(figsize=_SIZE, dpi=DPI)
        axes = figure.add_axes((0.085, 0.105, 0.895, 0.79))
        alarms = summary.declare is not None
        if alarms:
            _declared(axes, curves, summary)
        _ideal(axes, curves, "bound of true reports" if alarms else "bound: no team can do better")
        _outside(axes, curves)
        if not alarms:
            _counted(axes, curves, summary)
        for name in (name for name in _STYLES if name in curves.detection):
            mean = summary.comparison[name].mean_time_s
            label = f"{_MEANING[name]}  (mean {mean:.0f} s)"
            if alarms:
                label = f"some true report, predicted: {name}  (mean {mean:.0f} s)"
            axes.plot(curves.times, curves.detection[name], label=label, **_STYLES[name])
        if summary.found_s is not None:
            axes.axvline(summary.found_s, color=INK, lw=0.8, ls=(0, (2, 2)), zorder=1)
            axes.annotate(
                f"found, {summary.found_s:.0f} s", (summary.found_s, 1.0), (4, -3),
                xycoords=("data", "axes fraction"), textcoords="offset points", va="top", fontsize=8,
                color=FAINT,
            )  # fmt: skip
        what = "probability of being found, or reported" if alarms else "probability of detection"
        axes.set(xlabel="time [s]", ylabel=what, ylim=(0.0, 1.08))
        axes.set(xlim=(0.0, float(curves.times[-1]) or 1.0), yticks=np.linspace(0.0, 1.0, 6))
        axes.yaxis.set_major_formatter(PercentFormatter(1.0))
        tidy(axes, "y")
        axes.legend(loc="lower right", framealpha=0.9, edgecolor="none", labelspacing=0.45)
        figure.text(
            0.085,
            0.935,
            f"{summary.scenario}: {many(summary.vehicles, 'vehicle')}",
            fontsize=12,
            fontweight="bold",
        )
        figure.text(0.98, 0.935, f"seed {summary.seed}", ha="right", color=FAINT)
        save(figure, path)


def _ideal(axes: Axes, curves: Curves, meaning: str) -> None:
    """Shade what nobody can reach, and draw Koopman's ideal searcher."""
    edge = palette.unit((150, 153, 157))
    axes.fill_between(
        curves.times, curves.bound, 1.08, color=palette.unit((225, 227, 230)), alpha=0.6, lw=0, zorder=0
    )
    axes.plot(curves.times, curves.bound, color=edge, lw=1.2, zorder=2, label=meaning)
    axes.plot(
        curves.times, curves.koopman, color=edge, lw=1.1, ls=(0, (5, 1.5, 1, 1.5)), zorder=2,
        label="Koopman: swept area spread ideally, looks at random",
    )  # fmt: skip


def _outside(axes: Axes, curves: Curves) -> None:
    """Hatch what has left the area undetected: nothing that is done later finds it."""
    if curves.outside is not None:
        grey = palette.unit((150, 153, 157))
        axes.fill_between(
            curves.times, 1.0 - curves.outside, 1.0, facecolor="none", edgecolor=grey, hatch="////", lw=0,
            zorder=1, label="has left the area undetected",
        )  # fmt: skip


def _counted(axes: Axes, curves: Curves, summary: SearchSummary) -> None:
    counted, share = summary.counted, curves.counted
    if counted is None or share is None:
        return
    colour = _STYLES[summary.coordination]["color"]
    low, high = (np.clip(share + way * counted.band, 0.0, 1.0) for way in (-1.0, 1.0))
    axes.fill_between(
        curves.times, low, high, color=colour, alpha=0.16, lw=0, zorder=1,
        label=f"{summary.coordination}, counted over {many(counted.trials, 'target')}, 95 % band",
    )  # fmt: skip


def _declared(axes: Axes, curves: Curves, summary: SearchSummary) -> None:
    """Draw what was declared in searches of their own, rightly and wrongly, and by which rule."""
    counted, rule, found, mistaken = summary.counted, summary.declare, curves.counted, curves.mistaken
    if counted is None or rule is None or found is None or mistaken is None:
        return
    low, high = (np.clip(found + way * counted.band, 0.0, 1.0) for way in (-1.0, 1.0))
    axes.fill_between(curves.times, low, high, color=INK, alpha=0.12, lw=0, zorder=1)
    axes.plot(
        curves.times, found, color=INK, lw=2.4, zorder=7,
        label=f"declared found: {100 * counted.found:.0f} % of {counted.trials} searches, 95 % band",
    )  # fmt: skip
    axes.plot(
        curves.times, mistaken, color=_WRONG, lw=1.8, ls=(0, (3, 1.5)), zorder=6,
        label=f"declared where it is not: {counted.mistaken}; never declared: {counted.missed}",
    )  # fmt: skip
    axes.set_title(
        f"declared at a posterior of {100 * rule.probability:g} % within {rule.radius_m:g} m", loc="left",
        fontsize=9, color=FAINT, pad=4,
    )  # fmt: skip
