"""``detection.png``: the probability that the target has been detected, or found, against time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter

from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import picture, save
from vedette.record.search.curves import Curves
from vedette.record.search.summary import SearchSummary
from vedette.record.signs import INK
from vedette.record.strips import Strip, Strips, legend_above

_STYLES: dict[str, dict[str, Any]] = {  # a line differs in more than its colour
    "none": {"color": palette.unit((213, 94, 0)), "ls": (0, (1, 1.2)), "lw": 1.7, "zorder": 3},
    "shared": {"color": palette.unit((0, 158, 115)), "ls": (0, (6, 2)), "lw": 1.7, "zorder": 4},
    "negotiated": {"color": palette.unit((0, 114, 178)), "ls": "-", "lw": 2.2, "zorder": 5},
}
_WRONG = palette.unit((204, 121, 167))
_EDGE = palette.unit((150, 153, 157))
_MEANING = {
    "none": "none: nobody tells anybody anything",
    "shared": "shared: one belief, everybody plans alone",
    "negotiated": "negotiated",
}
_TOP = 1.04  # of the axes


def detection_png(curves: Curves, summary: SearchSummary, path: Path | str) -> None:
    """Draw the predicted curves by coordination, what was counted, the bound and Koopman's ideal.

    With false alarms a true report is not yet a finding: what was declared comes first, by a name of its own.
    """
    alarms = summary.declare is not None
    title = f"{summary.scenario}: {many(summary.vehicles, 'vehicle')}"
    with picture():
        strips = Strips.make((Strip(3.9, _lines(curves, summary)),), title, f"seed {summary.seed}")
        (axes,) = strips.axes
        handles = _declared(axes, curves, summary)
        handles += _ideal(axes, curves, "bound of true reports" if alarms else "bound: no team can do better")
        handles += _outside(axes, curves)
        if not alarms:
            handles += _counted(axes, curves, summary)
        for name in (name for name in _STYLES if name in curves.detection):
            mean = summary.comparison[name].mean_time_s
            label = f"{_MEANING[name]}  (mean {mean:.0f} s)"
            if alarms:
                label = f"some true report, predicted: {name}  (mean {mean:.0f} s)"
            handles += axes.plot(curves.times, curves.detection[name], label=label, **_STYLES[name])
        if summary.found_s is not None:
            label = f"found, {summary.found_s:.0f} s"
            handles.append(
                axes.axvline(summary.found_s, color=INK, lw=0.8, ls=(0, (2, 2)), zorder=1, label=label)
            )
        what = "probability of being found, or reported" if alarms else "probability of detection"
        axes.set(ylabel=what, ylim=(0.0, _TOP), yticks=np.linspace(0.0, 1.0, 6))
        axes.set_xlim(0.0, float(curves.times[-1]) or 1.0)
        axes.yaxis.set_major_formatter(PercentFormatter(1.0))
        legend_above(axes, handles)
        save(strips.figure, path)


def _lines(curves: Curves, summary: SearchSummary) -> int:
    """Return how many lines the legend has."""
    counted = summary.counted is not None and curves.counted is not None
    declared = counted and summary.declare is not None and curves.mistaken is not None
    told = (curves.outside is not None) + (summary.found_s is not None)
    return 2 + len(curves.detection) + told + (3 if declared else counted and summary.declare is None)


def _ideal(axes: Axes, curves: Curves, meaning: str) -> list[Artist]:
    """Shade what nobody can reach, and draw Koopman's ideal searcher."""
    shade = palette.unit((225, 227, 230))
    axes.fill_between(curves.times, curves.bound, _TOP, color=shade, alpha=0.6, lw=0, zorder=0)
    bound = axes.plot(curves.times, curves.bound, color=_EDGE, lw=1.2, zorder=2, label=meaning)
    koopman = axes.plot(
        curves.times, curves.koopman, color=_EDGE, lw=1.1, ls=(0, (5, 1.5, 1, 1.5)), zorder=2,
        label="Koopman: swept area spread ideally, looks at random",
    )  # fmt: skip
    return [*bound, *koopman]


def _outside(axes: Axes, curves: Curves) -> list[Artist]:
    """Hatch what has left the area undetected: nothing that is done later finds it."""
    if curves.outside is None:
        return []
    hatched = axes.fill_between(
        curves.times, 1.0 - curves.outside, 1.0, facecolor="none", edgecolor=_EDGE, hatch="////", lw=0,
        zorder=1, label="has left the area undetected",
    )  # fmt: skip
    return [hatched]


def _counted(axes: Axes, curves: Curves, summary: SearchSummary) -> list[Artist]:
    """Draw the share of targets drawn that had been detected, as its 95 % band."""
    counted, share = summary.counted, curves.counted
    if counted is None or share is None:
        return []
    low, high = (np.clip(share + way * counted.band, 0.0, 1.0) for way in (-1.0, 1.0))
    band = axes.fill_between(
        curves.times, low, high, color=_STYLES[summary.coordination]["color"], alpha=0.16, lw=0, zorder=1,
        label=f"{summary.coordination}, counted over {many(counted.trials, 'target')}, 95 % band",
    )  # fmt: skip
    return [band]


def _declared(axes: Axes, curves: Curves, summary: SearchSummary) -> list[Artist]:
    """Draw what was declared in searches of their own, rightly and wrongly, and by which rule."""
    counted, rule, found, mistaken = summary.counted, summary.declare, curves.counted, curves.mistaken
    if counted is None or rule is None or found is None or mistaken is None:
        return []
    low, high = (np.clip(found + way * counted.band, 0.0, 1.0) for way in (-1.0, 1.0))
    axes.fill_between(curves.times, low, high, color=INK, alpha=0.12, lw=0, zorder=1)
    rightly = axes.plot(
        curves.times, found, color=INK, lw=2.4, zorder=7,
        label=f"declared found: {100 * counted.found:.0f} % of {counted.trials} searches, 95 % band",
    )  # fmt: skip
    wrongly = axes.plot(
        curves.times, mistaken, color=_WRONG, lw=1.8, ls=(0, (3, 1.5)), zorder=6,
        label=f"declared where it is not: {counted.mistaken}; never declared: {counted.missed}",
    )  # fmt: skip
    text = f"declared at a posterior of {100 * rule.probability:g} % within {rule.radius_m:g} m"
    return [*rightly, *wrongly, Line2D((), (), ls="", label=text)]
