"""What the reproduction's pictures share, beside the style of all pictures."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, ScalarFormatter, StrMethodFormatter

from vedette.record import palette
from vedette.record.canvas import tidy


def colour(index: int) -> tuple[float, float, float]:
    """Return the colour of a line or robot."""
    return palette.unit(palette.robot_colour(index))


def label_axes(axes: Axes, title: str = "", xlabel: str = "", ylabel: str = "") -> None:
    """Tidy a plot, and label it."""
    tidy(axes)
    axes.set_title(title, fontsize=9.5, loc="left", fontweight="bold")
    axes.set(xlabel=xlabel, ylabel=ylabel)


def over_team_size(axes: Axes, sizes: tuple[int, ...]) -> None:
    """Make the x axis one of team sizes, in doublings."""
    axes.set_xscale("log", base=2)
    axes.set_xticks(sizes)
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.minorticks_off()
    axes.set_xlabel("platforms")


def log_scale(axes: Axes) -> None:
    """Make the y axis logarithmic, with plain numbers at 1, 2 and 5 of each decade."""
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 1000.0 * low else (1.0,)))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.minorticks_off()
