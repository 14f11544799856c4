"""The live view of a search: the pdf in characters with the vehicles on it, and a table of the team."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from numpy.typing import NDArray
from rich.console import Console, Group, RenderableType
from rich.panel import Panel
from rich.progress_bar import ProgressBar
from rich.style import Style
from rich.table import Table
from rich.text import Text

from vedette.record import palette
from vedette.record.display import Display
from vedette.record.marks import badge, sign
from vedette.record.search.log import Scene, SearchSnapshot

_MAP = 24, 76  # most lines and columns of the picture
_ASPECT = 2.0  # height of a character over its width
_SHADES = " ·░▒▓█"
_POWER = 0.6  # of the shades, as in the pictures


def search_display(
    scene: Scene, quiet: bool = False, console: Console | None = None
) -> Display[SearchSnapshot]:
    """Return the live view of a search."""
    return Display(partial(screen, scene), partial(line, scene), quiet, console)


def line(scene: Scene, snapshot: SearchSnapshot) -> str:
    """Return a snapshot in one line."""
    states = "  ".join(
        f"{name} {vehicle.state}" for name, vehicle in zip(scene.vehicles, snapshot.vehicles, strict=True)
    )
    detection = f"detection {100 * snapshot.detection:5.1f} %"
    return f"{snapshot.t:7.1f} s  {detection}  entropy {snapshot.entropy:5.2f} nat  {states}"


def screen(scene: Scene, console: Console, snapshot: SearchSnapshot) -> RenderableType:
    """Return the picture of a snapshot, fitted to the console: the darker, the likelier."""
    lines = min(_MAP[0], console.height - 8 - len(scene.vehicles))
    columns = min(_MAP[1], console.width - 4)
    parts: list[RenderableType] = [_figures(snapshot), _bar(snapshot)]
    if lines >= 4 and columns >= 8:
        parts += [_picture(scene, snapshot, lines, columns), Text("")]
    parts.append(_table(scene, snapshot))
    title = f"[bold]vedette[/] {scene.name}"
    return Panel(Group(*parts), title=title, title_align="left", border_style="bright_black")


def _figures(snapshot: SearchSnapshot) -> Text:
    return Text.assemble(
        ("time ", "dim"), (f"{snapshot.t:6.1f} s", "bold"),
        ("    entropy ", "dim"), (f"{snapshot.entropy:.2f} nat", "bold"),
    )  # fmt: skip


def _bar(snapshot: SearchSnapshot) -> Table:
    grid = Table.grid(padding=(0, 1))
    bar = ProgressBar(total=1.0, completed=snapshot.detection, width=40, complete_style="green")
    grid.add_row(Text("detection", "dim"), bar, Text(f"{100 * snapshot.detection:.1f} %", "bold"))
    return grid


def _picture(scene: Scene, snapshot: SearchSnapshot, lines: int, columns: int) -> Text:
    x0, x1, y0, y1 = scene.frame.extent
    metres = max((x1 - x0) / columns, (y1 - y0) / (_ASPECT * lines))  # a character's width
    columns = max(1, math.floor((x1 - x0) / metres + 1e-9))
    lines = max(1, math.floor((y1 - y0) / (_ASPECT * metres) + 1e-9))
    shades = _shades(snapshot.mass, lines, columns)
    ground = Style(color="grey82", bgcolor="grey11")
    cells = [[(_SHADES[k], ground) for k in row] for row in shades[::-1].tolist()]

    def put(x: float, y: float, sign: str, style: Style) -> None:
        column, row = int((x - x0) / (x1 - x0) * columns), int((y1 - y) / (y1 - y0) * lines)
        if 0 <= column < columns and 0 <= row < lines:
            cells[row][column] = sign, ground + style

    for i, vehicle in enumerate(snapshot.vehicles):
        red, green, blue = palette.robot_colour(i)
        for x, y in vehicle.path[1:].tolist():
            put(x, y, "∙", Style(color=f"rgb({red},{green},{blue})", bold=True))
    for i, vehicle in enumerate(snapshot.vehicles):
        put(vehicle.x, vehicle.y, sign(i, vehicle.alive), badge(i))
    return Text("\n").join(Text.assemble(*row) for row in cells)


def _shades(mass: NDArray[np.float32], lines: int, columns: int) -> NDArray[np.int64]:
    """Return the shade (lines, columns) of each character, the lowest line first: the mean of its cells."""
    summed = np.pad(mass.astype(np.float64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    row, col = (_edges(n, parts) for n, parts in zip(mass.shape, (lines, columns), strict=True))
    total = np.diff(np.diff(summed[row][:, col], axis=0), axis=1)
    mean = total / np.maximum(np.diff(row)[:, None] * np.diff(col), 1)
    share: NDArray[np.float64] = (mean / max(float(mean.max()), 1e-300)) ** _POWER
    return np.minimum((share * len(_SHADES)).astype(np.int64), len(_SHADES) - 1)


def _edges(cells: int, parts: int) -> NDArray[np.int64]:
    edges = np.linspace(0, cells, parts + 1)
    return np.rint(edges).astype(np.int64)


def _table(scene: Scene, snapshot: SearchSnapshot) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", pad_edge=False)
    for title in ("", "vehicle", "state"):
        table.add_column(title, no_wrap=True)
    table.add_column("afterwards to (m)", no_wrap=True, justify="right")
    for i, vehicle in enumerate(snapshot.vehicles):
        goal = "" if vehicle.goal is None else f"{vehicle.goal[0]:.0f}, {vehicle.goal[1]:.0f}"
        mark = Text(f" {sign(i, vehicle.alive)} ", badge(i))
        table.add_row(mark, scene.vehicles[i], vehicle.state, goal)
    return table
