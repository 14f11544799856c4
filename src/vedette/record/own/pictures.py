"""``ways.png`` and ``curves.png`` of an own domain: where everybody went, and its figures against time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save, tidy
from vedette.record.film import flight_gif
from vedette.record.flights import FlightLog
from vedette.record.log import evenly
from vedette.record.own.observer import OwnReport, OwnScene, OwnSnapshot
from vedette.record.signs import VEHICLE, draw_vehicle

OwnLog: TypeAlias = FlightLog[OwnScene, OwnSnapshot]
_WIDTH, _ROW = 7.0, 2.2  # [inch]
_STYLES: dict[str, dict[str, Any]] = {
    "none": {"color": palette.unit((213, 94, 0)), "ls": (0, (1, 1.2)), "lw": 1.8},
    "shared": {"color": palette.unit((0, 158, 115)), "ls": (0, (6, 2)), "lw": 1.8},
    "negotiated": {"color": palette.unit((0, 114, 178)), "ls": "-", "lw": 2.2},
}


def ways_png(report: OwnReport, path: Path | str) -> None:
    """Draw where everybody went, over what is known in the end."""
    summary = report.summary
    how = f"{summary.coordination}, {summary.outcome.said}, {summary.time_s:.0f} s"
    draw_ways(report.log, report.image, how, path)


def draw_ways(log: OwnLog, image: NDArray[np.float64] | None, how: str, path: Path | str) -> None:
    """Draw where everybody went, over an image of what is known; ``how`` stands in the title."""
    x0, y0, x1, y1 = log.scene.area
    height = min(max(_WIDTH * (y1 - y0) / (x1 - x0), 2.5), 10.0)
    with picture():
        figure = Figure(figsize=(_WIDTH, height + 0.5), dpi=DPI)
        axes = figure.add_axes((0.02, 0.02, 0.96, height / (height + 0.5) - 0.04))
        _draw(axes, log, image, log.snapshots[-1])
        title = f"{log.scene.name}: {many(len(log.scene.vehicles), 'vehicle')}, {how}"
        axes.set_title(title, fontsize=10, loc="left")
        save(figure, path)


def film(log: OwnLog, image: NDArray[np.float64] | None, path: Path | str, frames: int = 150) -> None:
    """Write at most so many steps as a film, over an image of what is known in the end."""
    x0, y0, x1, y1 = log.scene.area
    stages = [log.snapshots[i] for i in evenly(len(log.snapshots), frames)]

    def draw(axes: Axes, stage: OwnSnapshot) -> None:
        _draw(axes, log, image, stage)
        told = "  ".join(f"{name} {value:.4g}" for name, value in stage.figures.items())
        axes.set_title(f"{stage.t:.0f} s   {told}", fontsize=10, loc="left", pad=5)

    flight_gif(stages, draw, (x1 - x0) / (y1 - y0), 200, path)


def curves_png(logs: Mapping[str, OwnLog], path: Path | str) -> None:
    """Draw every figure against time, for all ways of coordination."""
    names = list(next(iter(logs.values())).snapshots[0].figures)
    with picture():
        rows = max(len(names), 1)
        figure = Figure(figsize=(_WIDTH, _ROW * rows + 0.5), dpi=DPI, layout="constrained")
        for row, name in enumerate(names):
            axes = figure.add_subplot(rows, 1, row + 1)
            tidy(axes)
            for how, log in logs.items():
                values = [snapshot.figures[name] for snapshot in log.snapshots]
                axes.plot(log.times, values, label=how, **_STYLES[how])
            axes.set_ylabel(name)
            axes.set_xlim(left=0.0)
            if row == 0:
                axes.legend(frameon=False, ncols=len(logs))
            if row == rows - 1:
                axes.set_xlabel("time [s]")
        save(figure, path)


def _draw(axes: Axes, log: OwnLog, image: NDArray[np.float64] | None, snapshot: OwnSnapshot) -> None:
    x0, y0, x1, y1 = log.scene.area
    if image is not None:
        axes.imshow(image, extent=(x0, x1, y0, y1), origin="lower", cmap="Greys", aspect="equal")
    axes.set(xticks=(), yticks=(), xlim=(x0, x1), ylim=(y0, y1), aspect="equal")
    trails, disc = log.trails(snapshot.t), VEHICLE.among(len(snapshot.vehicles))
    for i, vehicle in enumerate(snapshot.vehicles):
        axes.plot(*trails[:, i].T, color=palette.unit(palette.robot_colour(i)), lw=1.3, zorder=3)
        draw_vehicle(axes, i, vehicle, disc)
