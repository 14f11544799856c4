"""``scale.png``: what is flat and what grows, a row a domain."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, ScalarFormatter, StrMethodFormatter

from bench.scale.series import FIXED, STRIP, Row
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save, tidy

_COLOURS = {"chain": 0, "star": 1, "balanced": 2, "random": 3, "chain, strip": 4}
_Figure = Callable[[Row], float | None]
_PANELS: tuple[tuple[str, bool, _Figure, _Figure], ...] = (  # title, area is fixed, solid, dashed
    ("fixed area:\nCPU a platform and sweep [ms]", True, lambda row: row.cpu_mean, lambda _: None),
    ("fixed area:\nbytes a platform and sweep", True, lambda row: row.bytes_mean, lambda _: None),
    (
        "constant density:\nmedian link [bytes]",
        False,
        lambda row: row.edge_median if row.clipped else None,
        lambda row: row.whole_median,
    ),
    (
        "constant density:\nbytes a platform and sweep",
        False,
        lambda row: row.bytes_mean if row.clipped else None,
        lambda row: None if row.clipped else row.bytes_mean,
    ),
)


def scale_png(rows: Sequence[Row], path: Path) -> None:
    """Draw small multiples over team size, both axes logarithmic; dashed: messages with nothing left out."""
    domains = list(dict.fromkeys(row.domain for row in rows))
    with picture():
        figure = Figure(figsize=(3.0 * len(_PANELS), 2.5 * len(domains) + 0.8), dpi=DPI)
        grid = figure.subplots(len(domains), len(_PANELS), sharex=True, squeeze=False)
        for line, domain in zip(grid, domains, strict=True):
            own = [row for row in rows if row.domain == domain]
            for axes, (title, fixed, *figures) in zip(line, _PANELS, strict=True):
                shown = [row for row in own if (row.area == FIXED) == fixed]
                for figure_of, style in zip(figures, ("-", "--"), strict=True):
                    _lines(axes, shown, figure_of, style)
                _tidy(axes)
                if domain == domains[0]:
                    axes.set_title(title, fontsize=9)
                if domain == domains[-1]:
                    axes.set_xlabel("platforms")
            line[0].set_ylabel(domain, fontweight="bold")
        handles = [
            grid[0][-1].plot((), (), color=palette.unit(palette.robot_colour(i)), label=name)[0]
            for name, i in _COLOURS.items()
        ]
        handles += grid[0][-1].plot((), (), "--", color="grey", label="whole messages")
        figure.legend(handles=handles, loc="lower center", ncols=len(handles), frameon=False)
        figure.tight_layout(rect=(0.0, 0.05, 1.0, 1.0))
        save(figure, path)


def _lines(axes: Axes, rows: Sequence[Row], of: _Figure, style: str) -> None:
    lines: dict[str, list[tuple[int, float]]] = {}
    for row in rows:
        value = of(row)
        if value is not None:
            name = "chain, strip" if row.area == STRIP else row.tree
            lines.setdefault(name, []).append((row.n, value))
    for name, points in lines.items():
        colour = palette.unit(palette.robot_colour(_COLOURS[name]))
        axes.plot(*zip(*points, strict=True), style, color=colour, lw=1.4)


def _tidy(axes: Axes) -> None:
    axes.set_xscale("log", base=2)
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    if high < 10.0 * low:  # a flat line looks flat
        middle = math.sqrt(low * high)
        axes.set_ylim(middle / math.sqrt(10.0), middle * math.sqrt(10.0))
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.minorticks_off()
    tidy(axes)
