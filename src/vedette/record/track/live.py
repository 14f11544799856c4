"""The live view of tracking: vehicles and tracks over the area in characters, and a table of the team."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from rich.color import Color
from rich.console import Console, Group, RenderableType
from rich.panel import Panel
from rich.style import Style
from rich.table import Table
from rich.text import Text

from vedette.record import palette
from vedette.record.display import Display
from vedette.record.marks import badge, sign
from vedette.record.track.log import Scene, TrackSnapshot

_MAP = 24, 76  # most lines and columns of the picture
_ASPECT = 2.0  # height of a character over its width
_NAMES = "abcdefghijklmnopqrstuvwxyz"
_ROUND = 48  # points of an ellipse
_SIGMA = math.sqrt(-2.0 * math.log(0.05))  # a Gaussian in the plane lies within 2.45 sigma to 95 %

Put = Callable[[float, float, str, Style], None]


def track_display(
    scene: Scene, quiet: bool = False, console: Console | None = None
) -> Display[TrackSnapshot]:
    """Return the live view of a mission."""
    return Display(partial(screen, scene), partial(line, scene), quiet, console)


def line(scene: Scene, snapshot: TrackSnapshot) -> str:
    """Return a snapshot in one line."""
    states = "  ".join(
        f"{name} {vehicle.state}" for name, vehicle in zip(scene.vehicles, snapshot.vehicles, strict=True)
    )
    error = math.sqrt(snapshot.squared_error)
    return f"{snapshot.t:7.1f} s  entropy {snapshot.entropy:6.1f} nat  error {error:5.1f} m  {states}"


def screen(scene: Scene, console: Console, snapshot: TrackSnapshot) -> RenderableType:
    """Return the picture of a snapshot, fitted to the console: dots are 95 % ellipses, letters targets."""
    lines = min(_MAP[0], console.height - 7 - len(scene.vehicles))
    columns = min(_MAP[1], console.width - 4)
    parts: list[RenderableType] = [_figures(snapshot)]
    if lines >= 4 and columns >= 8:
        parts += [_picture(scene, snapshot, lines, columns), Text("")]
    parts.append(_table(scene, snapshot))
    title = f"[bold]vedette[/] {scene.name}"
    return Panel(Group(*parts), title=title, title_align="left", border_style="bright_black")


def _figures(snapshot: TrackSnapshot) -> Text:
    return Text.assemble(
        ("time ", "dim"), (f"{snapshot.t:6.1f} s", "bold"),
        ("    entropy ", "dim"), (f"{snapshot.entropy:.1f} nat", "bold"),
        ("    error ", "dim"), (f"{math.sqrt(snapshot.squared_error):.1f} m", "bold"),
        ("    NEES ", "dim"), (f"{snapshot.nees:.2f}", "bold"),
    )  # fmt: skip


def _picture(scene: Scene, snapshot: TrackSnapshot, lines: int, columns: int) -> Text:
    x0, y0, x1, y1 = scene.area
    metres = max((x1 - x0) / columns, (y1 - y0) / (_ASPECT * lines))  # a character's width
    columns = max(1, math.ceil((x1 - x0) / metres))
    lines = max(1, math.ceil((y1 - y0) / (_ASPECT * metres)))
    ground = Style(bgcolor="grey11")
    cells = [[(" ", ground)] * columns for _ in range(lines)]

    def put(x: float, y: float, sign: str, style: Style) -> None:
        column, row = math.floor((x - x0) / metres), math.floor((y1 - y) / (_ASPECT * metres))
        if 0 <= column < columns and 0 <= row < lines:
            cells[row][column] = sign, ground + style

    _draw_targets(snapshot, put)
    _draw_vehicles(snapshot, put)
    return Text("\n").join(Text.assemble(*row) for row in cells)


def _draw_targets(snapshot: TrackSnapshot, put: Put) -> None:
    turns = np.linspace(0.0, 2.0 * np.pi, _ROUND)
    circle = _SIGMA * np.stack([np.cos(turns), np.sin(turns)])
    seen = {target for vehicle in snapshot.vehicles for target in vehicle.seen}
    for mean, covariance in zip(snapshot.means, snapshot.covariances, strict=True):
        for x, y in (mean[:2, None] + np.linalg.cholesky(covariance[:2, :2]) @ circle).T.tolist():
            put(x, y, "·", Style(color="grey62"))
    for t, mean in enumerate(snapshot.means):
        colour = "bright_white" if t in seen else "grey62"
        put(float(mean[0]), float(mean[1]), _NAMES[t % len(_NAMES)], Style(color=colour, bold=True))


def _draw_vehicles(snapshot: TrackSnapshot, put: Put) -> None:
    for i, vehicle in enumerate(snapshot.vehicles):
        rgb = palette.robot_colour(i)
        for x, y in vehicle.path[1:].tolist():
            put(x, y, "∙", _ink(rgb))
    for i, vehicle in enumerate(snapshot.vehicles):
        put(vehicle.x, vehicle.y, sign(i, vehicle.alive), badge(i))


def _table(scene: Scene, snapshot: TrackSnapshot) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", pad_edge=False)
    for title in ("", "vehicle", "sensor", "state", "sees"):
        table.add_column(title, no_wrap=True)
    for i, vehicle in enumerate(snapshot.vehicles):
        sees = " ".join(f"{_NAMES[t % len(_NAMES)]}:{scene.targets[t]}" for t in vehicle.seen)
        mark = Text(f" {sign(i, vehicle.alive)} ", badge(i))
        table.add_row(mark, scene.vehicles[i], scene.sensors[i], vehicle.state, sees)
    return table


def _ink(rgb: palette.Rgb) -> Style:
    return Style(color=Color.from_rgb(*rgb))
