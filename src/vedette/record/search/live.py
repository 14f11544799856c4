"""The live view of a search: the pdf in characters with the vehicles on it, and a table of the team."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray
from rich.console import Console, RenderableType
from rich.style import Style

from vedette.record.board import Board, fitted
from vedette.record.display import Display
from vedette.record.search.log import SearchScene, SearchSnapshot
from vedette.record.view import (
    Size,
    TeamTable,
    arranged,
    explained,
    figure,
    flowing,
    share_bar,
    states,
)

_SHADES = " ·░▒▓█"
_POWER = 0.6  # of the shades, as in the pictures
_GROUND = Style(color="grey82", bgcolor="grey11")
_MARKS = (
    ("░▒▓█", _GROUND, "the target is there: the brighter, the likelier"),
    ("∙∙∙", Style(bold=True), "planned"),
    (" × ", Style(bold=True), "lost"),
)


def search_display(
    scene: SearchScene, quiet: bool = False, console: Console | None = None
) -> Display[SearchSnapshot]:
    """Return the live view of a search."""
    return Display(partial(screen, scene), partial(line, scene), quiet, console)


def line(scene: SearchScene, snapshot: SearchSnapshot) -> str:
    """Return a snapshot in one line."""
    team = states(scene.vehicles, snapshot.vehicles)
    detection = f"{_detection(scene)} {100 * snapshot.detection:5.1f} %"
    left = "" if snapshot.outside is None else f"  has left {100 * snapshot.outside:5.1f} %"
    return f"{snapshot.t:7.1f} s  {detection}{left}  entropy {snapshot.entropy:5.2f} nat  {team}"


def screen(scene: SearchScene, console: Console, snapshot: SearchSnapshot) -> RenderableType:
    """Return the picture of a snapshot, fitted to the console: the brighter, the likelier."""
    figures = figure("time", f"{snapshot.t:.1f} s"), figure("entropy", f"{snapshot.entropy:.2f} nat")
    goals = [
        "" if vehicle.goal is None else f"{vehicle.goal[0]:.0f}, {vehicle.goal[1]:.0f}"
        for vehicle in snapshot.vehicles
    ]
    x0, x1, y0, y1 = scene.frame.extent
    area = x0, y0, x1, y1

    def picture(room: Size) -> RenderableType:
        drawn = Board(area, *room, _GROUND)
        shades = _shades(snapshot.mass, drawn.lines, drawn.columns)
        drawn.fill(["".join(_SHADES[k] for k in row) for row in shades[::-1].tolist()])
        drawn.put_vehicles(snapshot.vehicles)
        return drawn.text()

    width = console.width - 4
    detected = share_bar(_detection(scene), snapshot.detection, width)
    head: list[RenderableType] = [flowing(figures, width), detected]
    if snapshot.outside is not None:
        head.append(share_bar("has left", snapshot.outside, width))
    team = TeamTable("vehicle", scene, snapshot.vehicles, [("afterwards to (m)", goals)])
    return arranged(console, scene, head, picture, partial(fitted, area), team, explained(_MARKS, width))


def _detection(scene: SearchScene) -> str:
    return "true report" if scene.false_alarms else "detection"


def _shades(mass: NDArray[np.float32], lines: int, columns: int) -> NDArray[np.int64]:
    """Return the shade (lines, columns) of each character, the lowest line first: the mean of its cells."""
    summed = np.pad(mass.astype(np.float64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    row, row_end = _cells(mass.shape[0], lines)
    col, col_end = _cells(mass.shape[1], columns)
    wide = summed[:, col_end] - summed[:, col]
    mean = np.maximum(wide[row_end] - wide[row], 0.0) / ((row_end - row)[:, None] * (col_end - col))
    share: NDArray[np.float64] = (mean / max(float(mean.max()), 1e-300)) ** _POWER
    return np.minimum((share * len(_SHADES)).astype(np.int64), len(_SHADES) - 1)


def _cells(count: int, parts: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the first cell of each part and the one after its last; each part has one at least."""
    edges = np.arange(parts + 1) * count // parts
    return edges[:-1], np.maximum(edges[1:], edges[:-1] + 1)
