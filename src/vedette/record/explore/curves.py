"""``curves.png``: how coverage, entropy and distance went with time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, PercentFormatter

from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save, tidy
from vedette.record.explore.log import ExploreLog
from vedette.record.explore.summary import ExploreSummary

_SIZE = 8.0, 6.6  # [inch]
_COVERAGE = palette.unit((0, 114, 178))
_ENTROPY = palette.unit((140, 90, 0))
_APART = palette.unit((213, 94, 0))
_FAINT = palette.unit((200, 203, 207))
_DASHES = ((), (6, 2), (2, 1.5), (6, 2, 2, 2), (1, 1))  # a robot's line differs in more than its colour


def curves_png(log: ExploreLog, summary: ExploreSummary, path: Path | str) -> None:
    """Draw coverage with t50 to t99, the entropy of the map and each robot's distance against time."""
    with picture():
        figure = Figure(figsize=_SIZE, dpi=DPI)
        grid = figure.add_gridspec(
            3, 1, height_ratios=(1.7, 1, 1), hspace=0.14, left=0.095, right=0.98, top=0.925, bottom=0.075
        )
        coverage = figure.add_subplot(grid[0])
        entropy, distance = (figure.add_subplot(grid[i], sharex=coverage) for i in (1, 2))
        _apart((coverage, entropy, distance), log, summary)
        _coverage(coverage, log, summary)
        entropy.plot(log.times, log.entropy, color=_ENTROPY, lw=1.8)
        entropy.fill_between(log.times, log.entropy, color=_ENTROPY, alpha=0.1, lw=0)
        entropy.set(ylabel="map entropy [nat]", ylim=(0, 1.05 * max(1.0, float(log.entropy.max()))))
        entropy.yaxis.set_major_formatter(EngFormatter(sep=""))
        _distance(distance, log)
        for axes in (coverage, entropy, distance):
            tidy(axes, "y")
            axes.tick_params(labelbottom=axes is distance)
        coverage.set_xlim(0, max(1.0, float(log.times[-1])))
        team = many(summary.robots, "robot")
        figure.text(
            0.095, 0.955, f"{summary.world}: {team}, {summary.planner}", fontsize=12, fontweight="bold"
        )
        figure.text(0.98, 0.955, f"seed {summary.seed}", ha="right", color=palette.unit(palette.FAINT))
        figure.align_ylabels()
        save(figure, path)


def _coverage(axes: Axes, log: ExploreLog, summary: ExploreSummary) -> None:
    """Draw coverage, mark when it passed each level, shade the area over it."""
    axes.fill_between(log.times, log.coverage, 1.0, step="post", color=_FAINT, alpha=0.35, lw=0)
    axes.plot(log.times, log.coverage, color=_COVERAGE, lw=2.0, drawstyle="steps-post", zorder=3)
    marks = (("50", summary.t50_s, "o"), ("90", summary.t90_s, "s"), ("95", summary.t95_s, "D"))
    for level, t, marker in (*marks, ("99", summary.t99_s, "^")):
        if t is None:
            axes.plot(
                (), (), marker, color="white", mec=_FAINT, ms=6.5, label=f"$t_{{{level}}}$  not reached"
            )
            continue
        axes.plot((t, t), (0, int(level) / 100), color=_FAINT, lw=0.9, zorder=1)
        axes.plot(
            t, int(level) / 100, marker, color="white", mec=_COVERAGE, mew=1.6, ms=6.5, ls="", zorder=4,
            label=f"$t_{{{level}}}$ = {t:.1f} s",
        )  # fmt: skip
    axes.fill_between((), (), color=_FAINT, alpha=0.5, lw=0, label=f"area above = {summary.auc_s:.1f} s")
    axes.legend(
        loc="lower right" if log.coverage[-1] > 0.55 else "upper left",  # where the curve is not
        framealpha=0.9,
        edgecolor="none",
        labelspacing=0.55,
    )
    axes.set(ylabel="coverage", ylim=(0, 1.04), yticks=np.linspace(0, 1, 6))
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))


def _distance(axes: Axes, log: ExploreLog) -> None:
    """Draw how far each robot has travelled."""
    for i, (name, length) in enumerate(zip(log.scene.vehicles, log.path_length.T, strict=True)):
        colour = palette.unit(palette.robot_colour(i))
        axes.plot(log.times, length, color=colour, lw=1.6, dashes=_DASHES[i % len(_DASHES)], label=name)
    top = max(1.0, float(log.path_length.max()))
    axes.set(ylabel="travelled [m]", xlabel="time [s]", ylim=(0, 1.05 * top))
    axes.legend(
        loc="upper left", frameon=False, ncols=2 if len(log.scene.vehicles) > 3 else 1, labelspacing=0.3
    )


def _apart(shared: Sequence[Axes], log: ExploreLog, summary: ExploreSummary) -> None:
    """Shade the times at which the team was not together, on axes that share the time; label them once."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], log.apart, [0]))))
    label = f"team apart = {summary.apart_s:.1f} s"
    for first, end in edges.reshape(-1, 2).tolist():
        begin, over = log.times[first], log.times[min(end, len(log) - 1)]
        for axes in shared:
            axes.axvspan(begin, over, color=_APART, alpha=0.14, lw=0, zorder=0, label=label)
            label = "_"
