"""What live views of vehicles share: an area in characters with vehicles on it."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rich.color import Color
from rich.style import Style
from rich.text import Text

from vedette.record import palette
from vedette.record.log import VehicleSample
from vedette.record.marks import badge, sign
from vedette.record.view import Size

Box = tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y [m]

_ASPECT = 2.0  # height of a character over its width


def fitted(area: Box, room: Size) -> Size:
    """Return the lines and columns that an area has in a room of so many."""
    width, height = area[2] - area[0], area[3] - area[1]
    metres = max(width / room[1], height / (_ASPECT * room[0]))  # a character's width
    return max(1, math.floor(height / (_ASPECT * metres) + 1e-9)), max(1, math.floor(width / metres + 1e-9))


class Board:
    """An area as lines of characters, north up."""

    def __init__(self, area: Box, lines: int, columns: int, ground: Style) -> None:
        """Fit the area into so many lines and columns."""
        self._x0, self._y0, self._x1, self._y1 = area
        self.lines, self.columns = fitted(area, (lines, columns))
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
            self.put(vehicle.x, vehicle.y, sign(i, vehicle), badge(i))

    def text(self) -> Text:
        """Return the lines."""
        return Text("\n").join(Text.assemble(*row) for row in self._cells)
