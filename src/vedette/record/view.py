"""How a live view is arranged: figures, a picture as large as can be, the team, what the signs mean."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rich.console import Console, Group, RenderableType
from rich.panel import Panel
from rich.progress_bar import ProgressBar
from rich.style import Style
from rich.table import Table
from rich.text import Text

from vedette.record.log import MissionScene, VehicleSample
from vedette.record.marks import badge, sign

HINT = "Ctrl-C saves and stops"
_FRAME = 4, 2  # columns and lines that the frame takes
_LEAST = 4, 8  # lines and columns of a picture worth showing
_SCARCE = 10  # lines for picture and team; where there are fewer, signs are not explained
_GAP = 3  # between two tables, and between picture and table
_PAD = 2  # between columns of a table

Size = tuple[int, int]  # lines, columns
Column = tuple[str, Sequence[str]]  # title, a value for each of the team


def flowing(parts: Sequence[Text], width: int) -> Text:
    """Return parts one after the other, none of them broken, on as many lines of a width as they need."""
    lines = [Text()]
    for part in parts:
        room = width - lines[-1].cell_len - (_GAP if lines[-1] else 0)
        if lines[-1] and part.cell_len > room:
            lines.append(Text())
        lines[-1].append(" " * _GAP if lines[-1] else "").append_text(part)
    return Text("\n").join(lines)


def figure(name: str, value: str) -> Text:
    """Return a figure after its name."""
    return Text.assemble((f"{name} ", "dim"), (value, "bold"))


def share_bar(name: str, share: float, width: int) -> Table:
    """Return a share as a bar and in per cent, after its name."""
    grid = Table.grid(padding=(0, 1))
    room = max(4, min(40, width - len(name) - 10))
    bar = ProgressBar(total=1.0, completed=share, width=room, complete_style="green")
    grid.add_row(Text(name, "dim"), bar, Text(f"{100 * share:.1f} %", "bold", no_wrap=True))
    return grid


def explained(marks: Sequence[tuple[str, Style | str, str]], width: int) -> Text:
    """Return what signs mean, each sign in its style, and how to stop."""
    parts = [Text.assemble((mark, style), f" {meaning}") for mark, style, meaning in marks]
    for part in parts:
        part.stylize("dim", 1 if part.plain else 0)
    return flowing([*parts, Text(HINT, "dim")], width)


def states(names: Sequence[str], vehicles: Sequence[VehicleSample]) -> str:
    """Return what everybody does, in a line; of many, how many do what."""
    if len(vehicles) <= 8:
        return "  ".join(f"{name} {each.state}" for name, each in zip(names, vehicles, strict=True))
    return "  ".join(f"{count} {state}" for state, count in Counter(each.state for each in vehicles).items())


@dataclass(frozen=True)
class Block:
    """Something of a known size."""

    shown: RenderableType
    lines: int
    columns: int
    poorer: int  # the more, the more had to be left out


@dataclass(frozen=True)
class TeamTable:
    """The team as a table that fits where it is put: what matters least goes first."""

    what: str  # they are
    scene: MissionScene
    vehicles: Sequence[VehicleSample]
    columns: Sequence[Column]  # after sign, name and state; the more important first

    def fitted(self, lines: int, width: int) -> Block:
        """Return the team in so many lines and columns at most; its states counted if it does not fit."""
        longest = max(map(len, (self.what, *self.scene.vehicles)))
        every = len(self.columns)
        forms = ((every, 16), (1, 16), (1, 8), (0, 16), (0, 8), (1, 0), (0, 0))
        for poorer, (shown, least) in enumerate(forms):
            table = self._table(lines, width, self.columns[:shown], min(least, longest), longest)
            if table is not None:
                return Block(*table, poorer)
        counted = Text(states(self.scene.vehicles, self.vehicles), no_wrap=True, overflow="ellipsis")
        return Block(counted, 1, width, len(forms))

    def _table(
        self, lines: int, width: int, columns: Sequence[Column], least: int, longest: int
    ) -> tuple[Table, int, int] | None:
        """Return tables side by side, names at least so wide, and their lines and columns; None: no room."""
        count = len(self.vehicles)
        if lines < 2:
            return None
        across = -(-count // (lines - 1))
        told = [("state", [each.state for each in self.vehicles]), *columns]
        widths = [max(map(len, (title, *values))) for title, values in told]
        others = 3 + sum(_PAD + each for each in widths) + (_PAD if least else 0)
        name = min(longest, (width + _GAP) // across - _GAP - others)
        if name < least:
            return None
        rows = -(-count // across)
        tables = Table.grid(padding=(0, _GAP, 0, 0))
        parts = [
            self._part(range(first, min(first + rows, count)), told, widths, name if least else 0)
            for first in range(0, count, rows)
        ]
        tables.add_row(*parts)
        each = others + (name if least else 0)
        return tables, rows + 1, len(parts) * (each + _GAP) - _GAP

    def _part(self, rows: range, told: Sequence[Column], widths: Sequence[int], name: int) -> Table:
        """Return a table of some of the team."""
        table = Table(box=None, padding=(0, _PAD, 0, 0), header_style="dim", pad_edge=False)
        table.add_column("", width=3, no_wrap=True)
        if name:
            table.add_column(self.what, width=name, no_wrap=True)
        for (title, _), width in zip(told, widths, strict=True):
            metres = title.endswith("(m)")
            table.add_column(title, width=width, no_wrap=True, justify="right" if metres else "left")
        for i in rows:
            mark = Text(f" {sign(i, self.vehicles[i])} ", badge(i))
            names = [_within(self.scene.vehicles[i], name)] if name else []
            table.add_row(mark, *names, *(values[i] for _, values in told))
        return table


def arranged(
    console: Console,
    scene: MissionScene,
    head: Sequence[RenderableType],
    picture: Callable[[Size], RenderableType],
    fit: Callable[[Size], Size],
    team: TeamTable,
    foot: Text,
) -> RenderableType:
    """Return a live view that fits the console.

    The team goes below the picture or beside it, whichever shows more of the team, and if that is the same,
    leaves the picture more room; without room for a picture there is none.

    Args:
        console: that it is for.
        scene: gives the title.
        head: what stands over all.
        picture: draws in a room of so many lines and columns.
        fit: the size that the picture then has.
        team: everybody.
        foot: what the signs mean.
    """
    width = console.width - _FRAME[0]
    above = sum(_lines_of(console, part, width) for part in head)
    left = console.height - _FRAME[1] - above - 1  # the cursor's line
    if left - _lines_of(console, foot, width) < _SCARCE:
        foot = Text(HINT, "dim", no_wrap=True)
    left -= _lines_of(console, foot, width)
    below = team.fitted(max(2, left // 2), width)
    beside = team.fitted(left, 3 * width // 5)
    rooms = (left - below.lines - 1, width), (left, width - beside.columns - _GAP)
    sizes = [fit(room) if room[0] >= _LEAST[0] and room[1] >= _LEAST[1] else (0, 0) for room in rooms]
    areas = [lines * columns for lines, columns in sizes]
    if areas[1] and (not areas[0] or (beside.poorer, -areas[1]) < (below.poorer, -areas[0])):
        body = Table.grid(padding=(0, _GAP, 0, 0))
        body.add_row(picture(rooms[1]), beside.shown)
        return _framed(scene, *head, body, foot)
    if areas[0]:
        return _framed(scene, *head, picture(rooms[0]), Text(""), below.shown, foot)
    whole = team.fitted(max(2, console.height - _FRAME[1] - above - 2), width)
    return _framed(scene, *head, whole.shown, Text(HINT, "dim", no_wrap=True))


def _framed(scene: MissionScene, *parts: RenderableType) -> RenderableType:
    title = Text.assemble(("vedette", "bold"), f" {scene.name}")
    return Panel(Group(*parts), title=title, title_align="left", border_style="bright_black")


def _lines_of(console: Console, part: RenderableType, width: int) -> int:
    return len(console.render_lines(part, console.options.update(width=max(1, width), height=None)))


def _within(text: str, room: int) -> str:
    """Return a text of so many characters at most: its beginning and its end."""
    if len(text) <= room:
        return text
    end = (room - 1) // 2
    return f"{text[: room - 1 - end]}…{text[len(text) - end :]}"
