"""Pictures of replayed logs: the map with everybody's way, and what scans see of the unknown (Fig. 3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from vedette.domains.mapping.sightings import BIN, P_OCCUPIED
from vedette.maps import FREE
from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save, tidy
from vedette.record.explore.raster import fit, known_window, pool
from vedette.record.replay.summary import Replayed
from vedette.record.sheet import Sheet

_PIXELS = 1500, 1500  # of a map at most: rows, columns
_WIDTH = 8.0  # [inch]
_LEAST_TRIED = 100  # cells, for a bin to have a share


def map_png(replayed: Replayed, path: Path | str) -> None:
    """Draw the map that the team holds, with everybody's way from its dot on."""
    window = known_window(replayed.frame, _known_or_driven(replayed))
    part = replayed.classes[window.rows, window.cols]
    colours = palette.CLASSES[pool(part, *fit(part.shape, _PIXELS))]
    seen = many(replayed.sights, "map" if replayed.maps else "scan")
    joins = "" if replayed.frames is None else replayed.frames.joined_after
    title = f"{replayed.name}: {seen}, {replayed.known_m2[-1]:.0f} m² known{joins}"
    apart = [name in replayed.unjoined for name in replayed.names]
    told = [name + ", not joined" * alone for name, alone in zip(replayed.names, apart, strict=True)]
    with picture():
        sheet = Sheet.make(colours, window.frame.extent, title, told if len(told) > 1 else ())
        ways = [_way(sheet.axes, i, *each) for i, each in enumerate(zip(replayed.ways, apart, strict=True))]
        sheet.explain(ways if len(told) > 1 else ())
        save(sheet.figure, path)


def _way(axes: Axes, robot: int, way: NDArray[np.float64], apart: bool) -> Line2D:
    """Draw a robot's way, dotted where its map is apart, and return its line."""
    colour = palette.unit(palette.robot_colour(robot))
    axes.plot(*way[:1].T, "o", color=colour, ms=5)
    return axes.plot(*way.T, color=colour, lw=1.0, ls=":" if apart else "-", alpha=0.8)[0]


def _known_or_driven(replayed: Replayed) -> NDArray[np.uint8]:
    """Return the classes with all ways free, which may lead where the map knows nothing."""
    frame, classes = replayed.frame, replayed.classes.copy()
    for way in replayed.ways:
        col, row = ((way - (frame.origin_x, frame.origin_y)) // frame.resolution).astype(np.int64).T
        inside = (row >= 0) & (row < frame.rows) & (col >= 0) & (col < frame.cols)
        classes[row[inside], col[inside]] = FREE
    return classes


def observation_png(
    buildings: Sequence[Replayed], simulated: Mapping[str, NDArray[np.int64]], path: Path | str
) -> None:
    """Draw the share of unknown cells that scans saw, against distance: a curve a building; paper, Fig. 3.

    Args:
        buildings: replayed logs, at least one.
        simulated: (ROWS, BINS) counts of simulated worlds by what to call them.
        path: of the picture.
    """
    reach = max(each.reach_m for each in buildings)
    with picture():
        figure = Figure(figsize=(_WIDTH, 6.0), dpi=DPI)
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3.2, 1))
        for i, building in enumerate(buildings):
            _curve(upper, lower, building.counts, building.name, palette.unit(palette.robot_colour(i)), "-")
        for name, counts in simulated.items():
            _curve(upper, lower, counts, name, palette.unit(palette.INK), (0, (4, 1.5)))
        fine, cell = np.linspace(0.0, reach, 600), buildings[0].frame.resolution
        told = f"independent cells of {cell:g} m, P = 0.5"
        upper.plot(
            fine, (1.0 - P_OCCUPIED) ** (fine / cell), ":", color=palette.unit(palette.FAINT), label=told
        )
        upper.set(ylabel="share of unknown cells seen", ylim=(0.0, 1.02), xlim=(0.0, reach))
        lower.set(ylabel="cells tried", xlabel="distance from the lidar [m]", yscale="log")
        lower.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        lower.yaxis.set_major_formatter(EngFormatter(sep=""))
        lower.yaxis.set_minor_formatter(NullFormatter())
        upper.set_title("What a scan sees of the unknown, by distance", loc="left", fontweight="bold")
        upper.legend(frameon=False, fontsize=8.5)
        for axes in (upper, lower):
            tidy(axes)
        figure.tight_layout()
        save(figure, path)


def _curve(
    upper: Axes,
    lower: Axes,
    counts: NDArray[np.int64],
    name: str,
    colour: tuple[float, float, float],
    dashes: str | tuple[int, tuple[float, ...]],
) -> None:
    tried, seen = counts[0], counts[1]
    enough = np.flatnonzero(tried >= _LEAST_TRIED)
    at = (enough + 0.5) * BIN
    upper.plot(at, seen[enough] / tried[enough], color=colour, ls=dashes, lw=1.6, label=name)
    lower.plot(at, tried[enough], color=colour, ls=dashes, lw=1.2)
