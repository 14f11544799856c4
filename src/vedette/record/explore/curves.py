"""``curves.png``: how coverage, entropy and distance went with time; or known area and frontiers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import EngFormatter, PercentFormatter
from numpy.typing import NDArray

from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import picture, save
from vedette.record.explore.log import ExploreLog
from vedette.record.explore.summary import ExploreSummary
from vedette.record.key import LINE, Key
from vedette.record.strips import LEFT, RIGHT, WIDTH, Strip, Strips, legend_above

_COVERAGE = palette.unit((0, 114, 178))
_ENTROPY = palette.unit((140, 90, 0))
_APART = palette.unit((213, 94, 0))
_FAINT = palette.unit((200, 203, 207))
_LOWERED = {ord(digit): chr(0x2080 + int(digit)) for digit in "0123456789"}
_DASHES = ((), (6, 2), (2, 1.5), (6, 2, 2, 2), (1, 1))  # a robot's line differs in more than its colour


def curves_png(log: ExploreLog, summary: ExploreSummary, path: Path | str) -> None:
    """Draw coverage with t50 to t99, the entropy of the map and each robot's distance against time.

    Where nobody knows how much ground there is: the area that is known, and the frontiers that are left.
    """
    team = Key.of(log.scene.vehicles, WIDTH - LEFT - RIGHT)
    with picture():
        strips = Strips.make(
            (Strip(2.4, 2), Strip(1.4), Strip(1.4)),
            f"{summary.world}: {many(summary.robots, 'robot')}, {summary.planner}",
            f"seed {summary.seed}",
            LINE * team.lines,
        )
        known, left, distance = strips.axes
        apart = _apart(strips.axes, log, summary)
        if summary.coverage is None:
            legend_above(known, [*_area(known, log, summary), *apart], 3)
            _under(left, log, np.nan_to_num(log.frontiers), "frontiers left")
        else:
            legend_above(known, [*_coverage(known, log, summary), *apart], 3)
            _under(left, log, log.entropy, "map entropy [nat]")
        lines = _distance(distance, log)
        known.set_xlim(0, max(1.0, float(log.times[-1])))
        team.write(strips.figure, LEFT, strips.below - LINE / 3, lines)
        save(strips.figure, path)


def _coverage(axes: Axes, log: ExploreLog, summary: ExploreSummary) -> list[Any]:
    """Draw coverage, mark when it passed each level, shade the area over it; return what explains it."""
    axes.fill_between(log.times, log.coverage, 1.0, step="post", color=_FAINT, alpha=0.35, lw=0)
    axes.plot(log.times, log.coverage, color=_COVERAGE, lw=2.0, drawstyle="steps-post", zorder=3)
    signs: list[Any] = []
    marks = (("50", summary.t50_s, "o"), ("90", summary.t90_s, "s"), ("95", summary.t95_s, "D"))
    for level, t, marker in (*marks, ("99", summary.t99_s, "^")):
        told = "not reached" if t is None else f"= {t:.1f} s"
        sign = Line2D(
            (), (), ls="", marker=marker, color="white", mec=_FAINT if t is None else _COVERAGE, ms=6.5,
            mew=1.0 if t is None else 1.6, label=f"t{level.translate(_LOWERED)}  {told}",
        )  # fmt: skip
        signs.append(sign)
        if t is not None:
            axes.plot((t, t), (0, int(level) / 100), color=_FAINT, lw=0.9, zorder=1)
            axes.plot(t, int(level) / 100, marker, color="white", mec=_COVERAGE, mew=1.6, ms=6.5, zorder=4)
    axes.set(ylabel="coverage", ylim=(0, 1.04), yticks=np.linspace(0, 1, 6))
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))
    area = Patch(color=_FAINT, alpha=0.5, lw=0, label=f"area above = {summary.auc_s:.1f} s")
    return [*signs, area]


def _area(axes: Axes, log: ExploreLog, summary: ExploreSummary) -> list[Any]:
    """Draw how much is known; return what explains it."""
    label = f"{summary.known_m2:.0f} m² in the end, {summary.rate_m2_s:.2f} m²/s"
    lines = axes.plot(
        log.times, log.known_m2, color=_COVERAGE, lw=2.0, drawstyle="steps-post", zorder=3, label=label
    )
    axes.set(ylabel="known [m²]", ylim=(0, 1.05 * max(1.0, float(log.known_m2.max()))))
    return lines


def _under(axes: Axes, log: ExploreLog, values: NDArray[np.float64], name: str) -> None:
    """Draw a curve with what is under it tinted."""
    axes.plot(log.times, values, color=_ENTROPY, lw=1.8)
    axes.fill_between(log.times, values, color=_ENTROPY, alpha=0.1, lw=0)
    axes.set(ylabel=name, ylim=(0, 1.05 * max(1.0, float(values.max()))))
    axes.yaxis.set_major_formatter(EngFormatter(sep=""))


def _distance(axes: Axes, log: ExploreLog) -> list[Line2D]:
    """Draw how far each robot has travelled; return the lines."""
    lines = list[Line2D]()
    for i, length in enumerate(log.path_length.T):
        colour, dashes = palette.unit(palette.robot_colour(i)), _DASHES[i % len(_DASHES)]
        lines += axes.plot(log.times, length, color=colour, lw=1.6, dashes=dashes)
    top = max(1.0, float(log.path_length.max()))
    axes.set(ylabel="travelled [m]", ylim=(0, 1.05 * top))
    return lines


def _apart(shared: Sequence[Axes], log: ExploreLog, summary: ExploreSummary) -> list[Patch]:
    """Shade the times at which the team was not together, on axes that share the time; return their sign."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], log.apart, [0]))))
    for first, end in edges.reshape(-1, 2).tolist():
        begin, over = log.times[first], log.times[min(end, len(log) - 1)]
        for axes in shared:
            axes.axvspan(begin, over, color=_APART, alpha=0.14, lw=0, zorder=0)
    label = f"team apart = {summary.apart_s:.1f} s"
    return [Patch(color=_APART, alpha=0.14, lw=0, label=label)] if len(edges) else []
