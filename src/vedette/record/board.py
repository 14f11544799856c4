"""What live views share: an area in characters with vehicles on it, figures, and a table of the team."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.color import Color
from rich.console import Console, Group, RenderableType
from rich.panel import Panel
from rich.progress_bar import ProgressBar
from rich.style import Style
from rich.table import Table
from rich.text import Text

from vedette.record import palette
from vedette.record.log import MissionScene, VehicleSample
from vedette.record.marks import badge, sign

Box = tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y [m]

_MAP = 24, 76  # most lines and columns of the picture
_ASPECT = 2.0  # height of a character over its width
_AROUND = 6  # lines of the frame and of the table's head


class Board:
    """An area as lines of characters, north up."""

    def __init__(self, area: Box, lines: int, columns: int, ground: Style) -> None:
        """Fit the area into so many lines and columns."""
        self._x0, self._y0, self._x1, self._y1 = area
        width, height = self._x1 - self._x0, self._y1 - self._y0
        metres = max(width / columns, height / (_ASPECT * lines))  # a character's width
        self.columns = max(1, math.floor(width / metres + 1e-9))
        self.lines = max(1, math.floor(height / (_ASPECT * metres) + 1e-9))
        self._ground = ground
        self._cells = [[(" ", ground)] * self.columns for _ in range(self.lines)]

    def fill(self, rows: Sequence[str]) -> None:
        """Put characters everywhere, the highest line first."""
        self._cells = [[(character, self._ground) for character in row] for row in rows]

    def put(self, x: float, y: float, character: str, style: Style) -> None:
        """Put a character at a place [m], if that is in the area."""
        column = math.floor((x - self._x0) / (self._x1 - self._x0) * self.columns)
        row = math.floor((self._y1 - y) / (self._y1 - self._y0) * self.lines)
        if 0 <= column < self.columns and 0 <= row < self.lines:
            self._cells[row][column] = character, self._ground + style

    def put_vehicles(self, vehicles: Sequence[VehicleSample]) -> None:
        """Put everybody's plan, and over the plans everybody."""
        for i, vehicle in enumerate(vehicles):
            ink = Style(color=Color.from_rgb(*palette.robot_colour(i)), bold=True)
            for x, y in vehicle.path[1:].tolist():
                self.put(x, y, "∙", ink)
        for i, vehicle in enumerate(vehicles):
            self.put(vehicle.x, vehicle.y, sign(i, vehicle.alive), badge(i))

    def text(self) -> Text:
        """Return the lines."""
        return Text("\n").join(Text.assemble(*row) for row in self._cells)


def board(
    console: Console, scene: MissionScene, area: Box, ground: Style, head: Sequence[RenderableType]
) -> Board | None:
    """Return an empty board that leaves room for the head and the table; None if there is none."""
    lines = min(_MAP[0], console.height - _AROUND - len(head) - len(scene.vehicles))
    columns = min(_MAP[1], console.width - 4)
    return Board(area, lines, columns, ground) if lines >= 4 and columns >= 8 else None


def framed(scene: MissionScene, *parts: RenderableType) -> RenderableType:
    """Return the parts of a live view one below the other, in a frame."""
    title = f"[bold]vedette[/] {scene.name}"
    return Panel(Group(*parts), title=title, title_align="left", border_style="bright_black")


def team_table(
    what: str,
    scene: MissionScene,
    vehicles: Sequence[VehicleSample],
    columns: Sequence[tuple[str, Sequence[str]]],
) -> Table:
    """Return a table with a line for each of ``what`` there are: sign, name, state, and the given columns."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", pad_edge=False)
    for title in ("", what, "state", *(title for title, _ in columns)):
        table.add_column(title, no_wrap=True, justify="right" if title.endswith("(m)") else "left")
    for i, vehicle in enumerate(vehicles):
        mark = Text(f" {sign(i, vehicle.alive)} ", badge(i))
        table.add_row(mark, scene.vehicles[i], vehicle.state, *(column[i] for _, column in columns))
    return table


def states(scene: MissionScene, vehicles: Sequence[VehicleSample]) -> str:
    """Return what everybody does, in a line."""
    return "  ".join(f"{name} {each.state}" for name, each in zip(scene.vehicles, vehicles, strict=True))


def figures_line(*pairs: tuple[str, str]) -> Text:
    """Return figures in a line, each after its name."""
    line = Text()
    for k, (name, value) in enumerate(pairs):
        line.append(f"{'' if k == 0 else '    '}{name} ", "dim").append(value, "bold")
    return line


def share_bar(name: str, share: float) -> Table:
    """Return a share as a bar and in per cent, after its name."""
    grid = Table.grid(padding=(0, 1))
    bar = ProgressBar(total=1.0, completed=share, width=40, complete_style="green")
    grid.add_row(Text(name, "dim"), bar, Text(f"{100 * share:.1f} %", "bold"))
    return grid
