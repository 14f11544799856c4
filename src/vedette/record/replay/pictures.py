"""Pictures of replayed logs: the map with everybody's way, and what scans see of the unknown (Fig. 3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vedette.domains.mapping.sightings import BIN, P_OCCUPIED
from vedette.maps import FREE
from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save, tidy
from vedette.record.explore.raster import fit, known_window, pool
from vedette.record.replay.summary import Replayed
from vedette.record.signs import scale_bar

_PIXELS = 1500, 1500  # of a map at most: rows, columns
_WIDTH, _TITLE, _FOOT = 8.0, 0.35, 0.3  # [inch]
_LEAST_TRIED = 100  # cells, for a bin to have a share


def map_png(replayed: Replayed, path: Path | str) -> None:
    """Draw the map that the team holds, with everybody's way from its dot on."""
    window = known_window(replayed.frame, _known_or_driven(replayed))
    part = replayed.classes[window.rows, window.cols]
    colours = palette.CLASSES[pool(part, *fit(part.shape, _PIXELS))]
    x0, x1, y0, y1 = window.frame.extent
    inches = min(max(_WIDTH * (y1 - y0) / (x1 - x0), 2.0), 12.0)  # of the map's height
    with picture():
        figure = Figure(figsize=(_WIDTH, inches + _TITLE + _FOOT), dpi=DPI)
        whole = inches + _TITLE + _FOOT
        axes = figure.add_axes((0.01, _FOOT / whole, 0.98, inches / whole))
        axes.imshow(colours, origin="lower", extent=(x0, x1, y0, y1), interpolation="antialiased")
        axes.set(xticks=(), yticks=())
        for i, (name, way) in enumerate(zip(replayed.names, replayed.ways, strict=True)):
            colour = palette.unit(palette.robot_colour(i))
            apart = name in replayed.unjoined
            told = f"{name}, not joined" if apart else name
            axes.plot(*way.T, color=colour, lw=1.0, ls=":" if apart else "-", alpha=0.8, label=told)
            axes.plot(*way[:1].T, "o", color=colour, ms=5)
        seen = many(replayed.sights, "map" if replayed.maps else "scan")
        joins = "" if replayed.frames is None else replayed.frames.joined_after
        title = f"{replayed.name}: {seen}, {replayed.known_m2[-1]:.0f} m² known{joins}"
        axes.set_title(title, loc="left", fontsize=11, fontweight="bold")
        if len(replayed.names) > 1:
            axes.legend(loc="best", fontsize=8, framealpha=0.9)
        shown = 0.98 * min(_WIDTH, inches * (x1 - x0) / (y1 - y0))
        scale_bar(figure, 0.01 * _WIDTH, _FOOT / 2, x1 - x0, shown)
        save(figure, path)


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
        simulated: (4, BINS) counts of simulated worlds by what to call them.
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
