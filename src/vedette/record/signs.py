"""Signs that pictures of missions share: vehicles, badges and lines of a legend, scale bars."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.path import Path
from matplotlib.textpath import TextPath
from matplotlib.transforms import ScaledTranslation

from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.record import palette
from vedette.record.links import Link
from vedette.record.log import VehicleSample

INK = palette.unit(palette.INK)
FAINT = palette.unit(palette.FAINT)
DASHES = (0, (3, 1.6))
_TREE: Any = {"color": INK, "lw": 1.2}
_OTHER: Any = {"color": INK, "lw": 0.9, "alpha": 0.3}
_ROUND = (0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 50_000, 100_000)


class Disc(NamedTuple):
    """Sizes of a vehicle's sign [pt]."""

    size: float
    nose: float
    ahead: float  # of the disc's middle: the nose
    font: float

    def among(self, team: int) -> Disc:
        """Return the sizes in a team of so many: smaller ones where many would cover each other."""
        scale = min(1.0, (8 / team) ** 0.25)
        return Disc(*(scale * size for size in self))


VEHICLE, ROBOT = Disc(10, 6.5, 6.6, 6.5), Disc(11, 7, 7.2, 7)


def draw_vehicle(axes: Axes, index: int, vehicle: VehicleSample, disc: Disc = VEHICLE) -> None:
    """Draw a numbered disc with a nose, and the plan ahead of it; another sign if it is gone."""
    if vehicle.alive:
        axes.plot(*vehicle.path.T, color="white", lw=2.4, alpha=0.8, zorder=5)
        colour = palette.unit(palette.robot_colour(index))
        axes.plot(*vehicle.path.T, color=colour, lw=1.4, ls=DASHES, zorder=5)
    draw_disc(axes, index, vehicle, disc)


def draw_disc(axes: Axes, index: int, vehicle: VehicleSample, disc: Disc) -> None:
    """Draw a numbered disc with a nose that points where the vehicle looks.

    A cross if it is lost, a ring if it has left.
    """
    rgb = palette.robot_colour(index)
    colour, at = palette.unit(rgb), (vehicle.x, vehicle.y)
    if vehicle.left:
        axes.plot(*at, "o", color="white", mec=colour, mew=1.6, ms=0.8 * disc.size, zorder=6)
        return
    if not vehicle.alive:
        axes.plot(*at, "X", color=colour, mec="white", mew=0.8, ms=disc.size, zorder=6)
        return
    ahead = np.array((math.cos(vehicle.heading), math.sin(vehicle.heading))) * disc.ahead / 72
    nose = axes.transData + ScaledTranslation(ahead[0], ahead[1], axes.figure.dpi_scale_trans)
    turned = (3, 0, math.degrees(vehicle.heading) - 90)
    axes.plot(*at, marker=turned, ms=disc.nose, color=colour, mec="white", mew=0.7, zorder=6, transform=nose)
    axes.plot(*at, "o", color=colour, mec="white", mew=0.9, ms=disc.size, zorder=7)
    axes.annotate(
        str(index + 1), at, (0, -0.3), textcoords="offset points", ha="center", va="center",
        fontsize=disc.font, fontweight="bold", color=palette.unit(palette.text_on(rgb)), zorder=8,
    )  # fmt: skip


def draw_links(axes: Axes, robots: Sequence[VehicleSample], links: Sequence[Link]) -> None:
    """Draw lines between robots, under their discs: on the tree solid, other links faint."""
    for link in sorted(links, key=lambda link: link.on_tree):
        x, y = zip(*((robots[i].x, robots[i].y) for i in (link.a, link.b)), strict=True)
        if link.on_tree:
            axes.plot(x, y, color="white", lw=2.8, alpha=0.8, zorder=5.2)  # to be seen on walls
        axes.plot(x, y, zorder=5.4, **(_TREE if link.on_tree else _OTHER))


def link_signs() -> list[Line2D]:
    """Return the signs of links in a legend, with their labels."""
    return [
        Line2D((), (), label="link on the team's tree", **_TREE),
        Line2D((), (), label="other link", **_OTHER),
    ]


def map_signs() -> list[Line2D | Patch]:
    """Return the signs of ways, goals and classes of cells in a legend, with their labels."""
    classes = ((FREE, "free"), (OCCUPIED, "wall"), (UNKNOWN, "unknown"))
    return [
        Line2D((), (), color=FAINT, lw=1.3, label="travelled"),
        Line2D((), (), color=FAINT, lw=1.4, ls=DASHES, label="planned"),
        Line2D((), (), ls="", marker="s", color="white", mec=FAINT, mew=1.6, ms=6, label="goal"),
        *(Patch(fc=tuple(palette.CLASSES[c] / 255), ec=FAINT, lw=0.6, label=name) for c, name in classes),
    ]


def badge(index: int, vehicle: VehicleSample | None = None) -> tuple[Line2D, ...]:
    """Return a vehicle's sign in a legend; None: it takes part."""
    rgb = palette.robot_colour(index)
    if vehicle is not None and vehicle.left:
        return (Line2D((), (), ls="", marker="o", ms=8, color="white", mec=palette.unit(rgb), mew=1.6),)
    alive = vehicle is None or vehicle.alive
    disc = Line2D((), (), ls="", marker="o" if alive else "X", ms=10, mec="white", color=palette.unit(rgb))
    if not alive:
        return (disc,)
    ink = palette.unit(palette.text_on(rgb))
    return disc, Line2D((), (), ls="", marker=_digits(index + 1), ms=4.5, mew=0.1, color=ink)


def _digits(number: int) -> Path:
    """Return a number's outline about the origin."""
    text = TextPath((0.0, 0.0), str(number), prop=FontProperties(family="DejaVu Sans", weight="bold"))
    middle = text.get_extents().get_points().mean(axis=0)
    return Path(text.vertices - middle, text.codes)


def legend_line(figure: Figure, x: float, y: float, handles: Sequence[Any], labels: Sequence[str]) -> None:
    """Write a line of a legend that begins at ``x``, its middle at ``y`` [inch]."""
    width, height = figure.get_size_inches()
    figure.legend(
        handles, labels, loc="center left", bbox_to_anchor=(x / width, y / height), ncols=len(labels),
        frameon=False, borderpad=0, borderaxespad=0, columnspacing=1.5, handletextpad=0.6,
        handler_map={tuple: HandlerTuple(1, 0)},
    )  # fmt: skip


def explain(figure: Figure, x: float, y: float, signs: Sequence[Line2D | Patch]) -> None:
    """Write a line of a legend from signs that have labels."""
    legend_line(figure, x, y, signs, [str(sign.get_label()) for sign in signs])


def scale_bar(figure: Figure, x: float, y: float, metres: float, inches: float) -> None:
    """Draw a bar of a round length at ``x``, ``y`` [inch], for a map of ``metres`` in ``inches``."""
    width, height = figure.get_size_inches()
    bar = max((b for b in _ROUND if b <= metres / 4), default=_ROUND[0])
    axes = figure.add_axes((x / width, (y - 0.05) / height, bar * inches / metres / width, 0.1 / height))
    axes.axis("off")
    axes.plot((0, 0, 0, 1, 1, 1), (0, 1, 0.5, 0.5, 0, 1), color=INK, lw=1.1, clip_on=False)
    axes.set(xlim=(0, 1), ylim=(0, 1))
    axes.annotate(f"{bar:g} m", (1, 0.5), (5, 0), textcoords="offset points", va="center", fontsize=8)
