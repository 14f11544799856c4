"""The live view's picture: a map in half blocks and a table of robots, as rich renderables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from rich.color import Color
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.measure import Measurement
from rich.segment import Segment
from rich.style import Style
from rich.text import Text

from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.record import palette
from vedette.record.explore.log import ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.raster import Window, paint, pool
from vedette.record.explore.told import progress
from vedette.record.marks import badge, sign, together, two_colours
from vedette.record.view import Column, Size, TeamTable, arranged, explained, figure, flowing, share_bar

_MARKS = (
    *(
        ("██", Style(color=Color.from_rgb(*palette.SCREEN[kind].tolist())), meaning)
        for kind, meaning in ((FREE, "free"), (OCCUPIED, "wall"), (UNKNOWN, "unknown"))
    ),
    ("██", Style(color=Color.from_rgb(*palette.IMPACT)), "about to be seen"),
    (" × ", Style(bold=True), "lost"),
)
_GLYPHS = (("·", "", "free"), ("█", "", "wall"), ("×", "", "lost"))


def screen(
    scene: ExploreScene, console: Console, snapshot: ExploreSnapshot, beside: Sequence[Column] = ()
) -> RenderableType:
    """Return the picture of a snapshot, fitted to the console; ``beside``: more to tell of the robots."""
    figures = [figure("time", f"{snapshot.t:.1f} s"), *(figure(*each) for each in progress(snapshot))]
    if snapshot.links is not None:
        style = "bold" if len(snapshot.parts) < 2 else "bold yellow"
        figures += [Text.assemble(("team ", "dim"), (together(snapshot.parts), style))]
    if snapshot.frames is not None:
        figures.append(figure("maps", snapshot.frames.told))
    robots = snapshot.robots
    goals = ["" if robot.goal is None else f"{robot.goal[0]:.1f}, {robot.goal[1]:.1f}" for robot in robots]
    columns = [*beside, ("driven (m)", [f"{robot.driven:.1f}" for robot in robots]), ("goal (m)", goals)]
    width = console.width - 4
    bar = () if snapshot.coverage is None else (share_bar("covered", snapshot.coverage, width),)
    return arranged(
        console,
        scene,
        [flowing(figures, width), *bar],
        partial(HalfBlocks.of, console, scene, snapshot),
        lambda room: (-(-_size(scene.frame, room)[0] // 2), _size(scene.frame, room)[1]),
        TeamTable("robot", scene, robots, columns),
        explained(_MARKS if _coloured(console) else _GLYPHS, width),
    )


def _size(frame: GridFrame, room: Size) -> tuple[int, int]:
    """Return the map's rows and columns [pixel] in a room of so many lines and columns."""
    scale = min(2 * room[0] / frame.rows, room[1] / frame.cols)
    return max(1, round(frame.rows * scale)), max(1, round(frame.cols * scale))


def _coloured(console: Console) -> bool:
    return console.color_system is not None and not console.no_color


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
        rows, cols = _size(frame, room)
        whole = Window(slice(0, frame.rows), slice(0, frame.cols), frame)
        signs = dict(_signs(snapshot.robots, frame, rows, cols))
        if not _coloured(console):
            glyphs = _glyphs(_paired(_stretched(pool(snapshot.classes, rows, cols), rows, cols)[::-1]))
            return cls([_plain_line(line, i, signs) for i, line in enumerate(glyphs)])
        colours = paint(snapshot, scene.planning, whole, (rows, cols), palette.SCREEN)
        pairs = _paired(_stretched(colours, rows, cols)[::-1])
        return cls([_line(pair, i, signs) for i, pair in enumerate(pairs)])

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
            yield (row // 2, col), (sign(i, robot), badge(i))


def _stretched(pixels: NDArray[np.uint8], rows: int, cols: int) -> NDArray[np.uint8]:
    """Return pixels repeated where there are fewer of them than rows and columns."""
    row, col = (np.arange(n) * have // n for n, have in zip((rows, cols), pixels.shape, strict=False))
    stretched: NDArray[np.uint8] = pixels[row][:, col]
    return stretched


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
