"""The live view's picture: a map in half blocks and a table of robots, as rich renderables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.measure import Measurement
from rich.segment import Segment
from rich.style import Style
from rich.table import Table
from rich.text import Text

from vedette.maps import FREE, OCCUPIED, GridFrame
from vedette.record import palette
from vedette.record.board import figures_line, framed, share_bar, team_table
from vedette.record.explore.log import ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.raster import Window, fit, paint, pool
from vedette.record.marks import badge, sign, together, two_colours

_MAP = 24, 70  # most lines and columns of the map
_TABLE = 50  # columns of the table beside the map


def screen(
    console: Console, scene: ExploreScene, snapshot: ExploreSnapshot, travelled: Sequence[float]
) -> RenderableType:
    """Return the picture of a snapshot, fitted to the console; ``travelled`` by robot [m].

    The table of robots goes below the map or beside it, whichever leaves the map more room.
    """
    known = 100 * snapshot.known_fraction
    figures = figures_line(
        ("time", f"{snapshot.t:6.1f} s"),
        ("known", f"{known:5.1f} %"),
        ("entropy", f"{snapshot.entropy:,.0f} nat"),
    )
    head: list[RenderableType] = [figures, share_bar("covered", snapshot.coverage)]
    if snapshot.links is not None:
        head.append(_team(snapshot))
    below = console.height - 6 - len(head) - len(snapshot.robots), console.width - 4
    left = console.height - 4 - len(head), console.width - 4 - _TABLE
    rooms = [(min(_MAP[0], lines), min(_MAP[1], columns)) for lines, columns in (below, left)]
    sizes = [_size(scene.frame, room) if min(room) >= 4 else (0, 0) for room in rooms]
    table = _robots(scene, snapshot.robots, travelled)
    if sizes[1][0] and sizes[1] >= sizes[0]:
        body = Table.grid(padding=(0, 3))
        body.add_row(HalfBlocks.of(console, scene, snapshot, sizes[1]), table)
        return framed(scene, *head, body)
    if sizes[0][0]:
        return framed(scene, *head, HalfBlocks.of(console, scene, snapshot, sizes[0]), Text(""), table)
    return framed(scene, *head, table)


def _size(frame: GridFrame, room: tuple[int, int]) -> tuple[int, int]:
    """Return the map's rows and columns [pixel] in a room of so many lines and columns."""
    return fit(frame.shape, (2 * room[0], room[1]))


def _team(snapshot: ExploreSnapshot) -> Text:
    style = "bold" if len(snapshot.parts) < 2 else "bold yellow"
    return Text.assemble(
        ("team    ", "dim"), (together(snapshot.parts), style), no_wrap=True, overflow="ellipsis"
    )


def _robots(scene: ExploreScene, robots: Sequence[RobotSample], travelled: Sequence[float]) -> Table:
    goals = ["" if robot.goal is None else f"{robot.goal[0]:.1f}, {robot.goal[1]:.1f}" for robot in robots]
    driven = [f"{metres:.1f}" for metres in travelled]
    return team_table("robot", scene, robots, [("goal (m)", goals), ("driven (m)", driven)])


class HalfBlocks:
    """A map of two pixels a character: the upper half in the ink, the lower in the ground colour."""

    def __init__(self, lines: list[list[Segment]]) -> None:
        """Hold lines of equal width, top first."""
        self._lines = lines
        self._width = sum(len(segment.text) for segment in lines[0])

    @classmethod
    def of(
        cls,
        console: Console,
        scene: ExploreScene,
        snapshot: ExploreSnapshot,
        room: tuple[int, int],
    ) -> HalfBlocks:
        """Draw a snapshot in at most ``room`` lines and columns; without colours as walls alone."""
        frame = scene.frame
        rows, cols = fit(frame.shape, (2 * room[0], room[1]))
        whole = Window(slice(0, frame.rows), slice(0, frame.cols), frame)
        signs = dict(_signs(snapshot.robots, frame, rows, cols))
        if console.color_system is None or console.no_color:
            glyphs = _glyphs(_paired(pool(snapshot.classes, rows, cols)[::-1]))
            return cls([_plain_line(line, i, signs) for i, line in enumerate(glyphs)])
        colours = paint(snapshot, scene.planning, whole, (rows, cols), palette.SCREEN)[::-1]
        return cls([_line(pair, i, signs) for i, pair in enumerate(_paired(colours))])

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        """Tell rich that the map neither shrinks nor grows."""
        return Measurement(self._width, self._width)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the lines."""
        for line in self._lines:
            yield from line
            yield Segment.line()


def _signs(
    robots: Sequence[RobotSample], frame: GridFrame, rows: int, cols: int
) -> Iterator[tuple[tuple[int, int], tuple[str, Style]]]:
    """Yield the (line, column) of each robot on the map with its sign and style."""
    x_min, x_max, y_min, y_max = frame.extent
    for i, robot in enumerate(robots):
        row = int((y_max - robot.y) / (y_max - y_min) * rows)
        col = int((robot.x - x_min) / (x_max - x_min) * cols)
        if 0 <= row < rows and 0 <= col < cols:
            yield (row // 2, col), (sign(i, robot.alive), badge(i))


def _paired(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return ``(lines, 2, cols, ...)``: upper and lower pixels; an odd last row is doubled."""
    if len(pixels) % 2:
        pixels = np.concatenate((pixels, pixels[-1:]))
    return pixels.reshape(len(pixels) // 2, 2, *pixels.shape[1:])


def _line(
    pair: NDArray[np.uint8], line: int, signs: dict[tuple[int, int], tuple[str, Style]]
) -> list[Segment]:
    """Return one line of the map, neighbours of the same colours joined."""
    both = np.concatenate((pair[0], pair[1]), axis=1)  # (cols, 6)
    changes = np.flatnonzero((both[1:] != both[:-1]).any(axis=1)) + 1
    own = [col for (row, col) in signs if row == line]
    edges = sorted({0, len(both), *changes.tolist(), *own, *(col + 1 for col in own)})
    segments = []
    for first, end in pairwise(edges):
        if (line, first) in signs:
            segments.append(Segment(*signs[line, first]))
        else:
            ink = both[first].tolist()
            segments.append(Segment("▀" * (end - first), two_colours(tuple(ink[:3]), tuple(ink[3:]))))
    return segments


def _glyphs(pairs: NDArray[np.uint8]) -> list[str]:
    """Return lines of block characters for walls and dots for free space."""
    upper, lower = pairs[:, 0], pairs[:, 1]
    glyphs = np.where((upper == FREE) | (lower == FREE), "·", " ")
    glyphs[lower == OCCUPIED] = "▄"
    glyphs[upper == OCCUPIED] = "▀"
    glyphs[(upper == OCCUPIED) & (lower == OCCUPIED)] = "█"
    return ["".join(line) for line in glyphs]


def _plain_line(glyphs: str, line: int, signs: dict[tuple[int, int], tuple[str, Style]]) -> list[Segment]:
    return [Segment("".join(signs[line, i][0] if (line, i) in signs else g for i, g in enumerate(glyphs)))]
