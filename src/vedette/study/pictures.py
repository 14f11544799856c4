"""The pictures of a study: curves against time, figures with intervals, and the trade-off between two."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter

from vedette.record import palette
from vedette.record.canvas import DPI, picture, save, tidy
from vedette.study.compare import mean
from vedette.study.curves import CurvesOf, averaged, lowest, time_axis
from vedette.study.facets import Facet, overview, panels, planners
from vedette.study.intervals import Interval
from vedette.study.metrics import AUC, TIMES, TOTAL, Metric
from vedette.study.rows import Row

_BOUND = palette.unit((150, 153, 157))
_DASHES = ((), (6, 2), (2, 1.5), (6, 2, 2, 2), (1, 1), (4, 1, 1, 1, 1, 1))
_MARKERS = "osD^vPX*<>"
_PANEL = 3.3, 2.5  # [inch]
_HEAD, _FOOT = 0.75, 0.25  # [inch] above and below the panels
_BOUND_LABEL = "no team can be below"
DrawPanel = Callable[[Axes, Facet], None]


def curves_png(rows: Sequence[Row], curves: CurvesOf, path: Path) -> None:
    """Draw the unknown share against time: each planner's mean, and the 95 % interval of the mean."""
    names = planners(rows)

    def panel(axes: Axes, facet: Facet) -> None:
        inside = facet.of(rows)
        groups = [[row for row in inside if row["planner"] == name] for name in names]
        times = time_axis(inside, curves, groups)
        best = lowest(inside, curves, times)
        if best is not None:
            axes.fill_between(times, best, color=_BOUND, alpha=0.18, lw=0)
            axes.plot(times, best, color=_BOUND, lw=1.0)
        for i, group in enumerate(groups):
            each = averaged(group, curves, times)
            if each is not None:
                axes.fill_between(times, each.low, each.high, color=_colour(i), alpha=0.18, lw=0)
                axes.plot(times, each.mean, color=_colour(i), lw=1.6, dashes=_DASHES[i % len(_DASHES)])
        axes.set(xlim=(0, times[-1]), ylim=(0, 1))
        axes.yaxis.set_major_formatter(PercentFormatter(1.0))

    handles = [
        Line2D((), (), color=_colour(i), lw=1.8, dashes=_DASHES[i % len(_DASHES)]) for i in range(len(names))
    ]
    bound = Line2D((), (), color=_BOUND, lw=1.0)
    _panels(rows, path, panel, [*handles, bound], [*names, _BOUND_LABEL], "time [s]", "unknown share")


def tradeoff_png(rows: Sequence[Row], path: Path) -> None:
    """Draw mean completion against mean area under the unknown share: information or completion first."""
    names = planners(rows)

    def panel(axes: Axes, facet: Facet) -> None:
        inside = facet.of(rows)
        for i, name in enumerate(names):
            x, y = mean(inside, name, AUC), mean(inside, name, TOTAL)
            if x.reached and y.reached:
                axes.errorbar(
                    x.interval.value, y.interval.value, _bars(y.interval), _bars(x.interval),
                    fmt=_MARKERS[i % len(_MARKERS)], color=_colour(i), mec="white", mew=0.7,
                    ms=9 - 4 * i / len(names), elinewidth=1.1,
                )  # fmt: skip
        axes.margins(0.15)

    handles = [_marker(i) for i in range(len(names))]
    _panels(rows, path, panel, handles, names, "AUC [s]", "completion [s]")


def metrics_png(rows: Sequence[Row], path: Path) -> None:
    """Draw the mean times of each planner with their 95 % intervals, and what no team can be below."""
    names, groups = planners(rows), overview(rows)
    columns = 3
    lines = math.ceil(len(TIMES) / columns)
    height = 0.5 + (0.24 + 0.085 * len(names)) * len(groups)
    size = (3.5 * columns + 1.2, height * lines + _HEAD + _FOOT)
    with picture():
        figure = Figure(figsize=size, dpi=DPI, layout="constrained")
        grid = figure.subplots(lines, columns, sharey=True, squeeze=False)
        for axes, metric in zip(grid.flat, TIMES, strict=False):
            _metric_panel(axes, rows, groups, names, metric)
        handles = [
            *(_marker(i) for i in range(len(names))),
            Line2D((), (), color=_BOUND, marker="|", ls="", ms=11),
        ]
        _legend(figure, handles, [*names, _BOUND_LABEL])
        save(figure, path)


def _metric_panel(
    axes: Axes, rows: Sequence[Row], groups: Sequence[Facet], names: Sequence[str], metric: Metric
) -> None:
    offsets = np.linspace(-0.3, 0.3, len(names)) if len(names) > 1 else np.zeros(1)
    for place, facet in enumerate(groups):
        inside = facet.of(rows)
        for i, name in enumerate(names):
            each = mean(inside, name, metric)
            y = place + offsets[i]
            if math.isfinite(each.bound):
                axes.plot((each.bound, each.bound), (place - 0.4, place + 0.4), color=_BOUND, lw=1.0)
            if each.reached:
                full = each.reached == each.runs
                axes.errorbar(
                    each.interval.value, y, xerr=_bars(each.interval), fmt=_MARKERS[i % len(_MARKERS)],
                    color=_colour(i), mfc=_colour(i) if full else "white", ms=4.6, elinewidth=1.1,
                )  # fmt: skip
    axes.set_yticks(range(len(groups)), [str(facet) for facet in groups])
    axes.set(xlabel=metric.label, ylim=(len(groups) - 0.4, -0.6))
    axes.set_xlim(left=0)
    for place in range(1, len(groups)):
        axes.axhline(place - 0.5, color=palette.unit(palette.GRID), lw=0.8)
    tidy(axes)


def _panels(
    rows: Sequence[Row],
    path: Path,
    draw: DrawPanel,
    handles: Sequence[Line2D],
    labels: Sequence[str],
    xlabel: str,
    ylabel: str,
) -> None:
    """Draw a grid of panels, those without runs left out, under one legend."""
    grid = panels(rows)
    down, across = len(grid), len(grid[0])
    width, height = _PANEL
    with picture():
        size = (max(width * across, 5.5), height * down + _HEAD + _FOOT)
        figure = Figure(figsize=size, dpi=DPI, layout="constrained")
        all_axes = figure.subplots(down, across, squeeze=False)
        for line, facets in zip(all_axes, grid, strict=True):
            for axes, facet in zip(line, facets, strict=True):
                if not facet.of(rows):
                    axes.axis("off")
                    continue
                draw(axes, facet)
                axes.set_title(str(facet), fontsize=9, loc="left", fontweight="bold")
                axes.set(xlabel=xlabel, ylabel=ylabel)
                tidy(axes)
        _legend(figure, handles, labels)
        save(figure, path)


def _legend(figure: Figure, handles: Sequence[Line2D], labels: Sequence[str]) -> None:
    columns = max(1, int(figure.get_size_inches()[0] / 1.6))
    figure.legend(handles, labels, loc="outside upper left", ncols=min(columns, len(labels)), frameon=False)


def _marker(i: int) -> Line2D:
    return Line2D((), (), color=_colour(i), marker=_MARKERS[i % len(_MARKERS)], ls="", ms=6, mec="white")


def _bars(interval: Interval) -> list[list[float]] | None:
    """Return the bar to either side of a value, none if it has no interval."""
    if not math.isfinite(interval.low):
        return None
    return [[max(interval.value - interval.low, 0.0)], [max(interval.high - interval.value, 0.0)]]


def _colour(i: int) -> tuple[float, float, float]:
    return palette.unit(palette.robot_colour(i))
