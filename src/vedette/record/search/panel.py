"""One moment of a search on a map: the pdf, vehicles, their ways, and what their plans would sweep."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, ListedColormap, PowerNorm

from vedette.record import palette
from vedette.record.film import flight_gif
from vedette.record.search.log import SearchLog, SearchSnapshot
from vedette.record.signs import INK, VEHICLE, draw_vehicle

TRUTH = palette.unit((0, 190, 200))
_ROOM = 1.5  # the darkest colour is so much above the first pdf at least: what is not searched grows likelier
_POWER, _LEAST = 0.6, 0.15  # of the colour scale: what is left after a while is faint
_FIRST = 0.45  # of the colours, at least so far up is the first pdf's most where a later one is concentrated
_COLOURS = 200  # of the film
_SWATH = 0.2  # opacity of what a plan sweeps


def colours() -> Colormap:
    """Magma from its light end, made paler there: perceptually uniform, and safe for colour-blind eyes."""
    shades = colormaps["magma_r"](np.linspace(0.0, 0.92, 256))
    shades[:, :3] += (1.0 - shades[:, :3]) * 0.75 * np.linspace(1.0, 0.0, 256)[:, None] ** 4
    return ListedColormap(shades)


def scale(log: SearchLog) -> PowerNorm:
    """Return the scale of probability a cell that all pictures of a search share.

    It holds the likeliest cell of all of them; the more that is above the first pdf, the more of the colours
    go to what is faint.
    """
    drawn = log.drawn()
    first = float(drawn[0].mass.max()) or 1.0
    most = max(_ROOM * first, *(float(snapshot.mass.max()) for snapshot in drawn))
    power = np.clip(np.log(_FIRST) / np.log(first / most), _LEAST, _POWER)
    return PowerNorm(float(power), 0.0, most, clip=True)


def draw(axes: Axes, log: SearchLog, snapshot: SearchSnapshot, norm: PowerNorm, last: bool) -> None:
    """Draw a snapshot that has its pdf, and all ways up to it; ``last``: the target too."""
    extent = log.scene.frame.extent
    axes.imshow(
        snapshot.mass, cmap=colours(), norm=norm, extent=extent, origin="lower", aspect="equal",
        interpolation="bilinear", zorder=0,
    )  # fmt: skip
    axes.set(xticks=(), yticks=(), xlim=extent[:2], ylim=extent[2:])
    title = f"{snapshot.t:.0f} s    {log.scene.detection} {100 * snapshot.detection:.0f} %"
    if snapshot.outside is not None:
        title += f", has left {100 * snapshot.outside:.0f} %"
    axes.set_title(title, fontsize=10, loc="left", pad=5)
    trails = log.trails(snapshot.t)
    for i in range(len(snapshot.vehicles)):
        colour = palette.unit(palette.robot_colour(i))
        axes.plot(*trails[:, i].T, color="white", lw=2.0, alpha=0.5, solid_joinstyle="round", zorder=2)
        axes.plot(*trails[:, i].T, color=colour, lw=1.1, alpha=0.9, solid_joinstyle="round", zorder=3)
    points = 72.0 * axes.get_window_extent().width / axes.figure.dpi / (extent[1] - extent[0])  # a metre
    for i, vehicle in enumerate(snapshot.vehicles):
        colour = palette.unit(palette.robot_colour(i))
        wide = points * log.scene.widths[i]
        axes.plot(
            *vehicle.path.T, color=colour, lw=wide, alpha=_SWATH, solid_capstyle="round",
            solid_joinstyle="round", zorder=1,
        )  # fmt: skip
    if last:
        axes.plot(*log.targets(snapshot.t).T, color=TRUTH, lw=1.4, zorder=4)
        axes.plot(*snapshot.target, "*", color=TRUTH, mec=INK, mew=0.8, ms=13, zorder=9)
    disc = VEHICLE.among(len(snapshot.vehicles))
    for i, vehicle in enumerate(snapshot.vehicles):
        draw_vehicle(axes, i, vehicle, disc)


def search_gif(log: SearchLog, path: Path | str, frames: int = 150) -> None:
    """Write at most ``frames`` snapshots of a log that is not empty as a film, evenly chosen."""
    stages, norm, frame = log.stages(frames), scale(log), log.scene.frame
    flight_gif(
        stages,
        lambda axes, stage: draw(axes, log, stage, norm, stage is stages[-1]),
        frame.cols / frame.rows,
        _COLOURS,
        path,
    )
