"""Pictures of several stages: panels, and a heading over them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vedette.record.canvas import DPI
from vedette.record.lettering import shortened, text_width
from vedette.record.signs import FAINT

GAP, MARGIN, TOP = 0.14, 0.2, 0.72  # between panels, at the sides, over the panels [inch]
TITLE = 0.3  # height of a panel's title [inch]
STACKED = 2.2  # panels of an aspect above that stand one above the other


@dataclass(frozen=True)
class Panels:
    """Sizes of a picture [inch]."""

    width: float
    height: float
    panel: tuple[float, float]
    corners: tuple[tuple[float, float], ...]  # lower-left of each panel

    @classmethod
    def in_a_row(
        cls,
        panel: tuple[float, float],
        count: int,
        stacked: bool,
        least: float,
        below: Callable[[float], float],
    ) -> Panels:
        """Lay out panels of a size side by side, or ``stacked``.

        Args:
            panel: width and height.
            count: of panels, two or more.
            stacked: one above the other.
            least: width of the picture.
            below: height under the lowest panel, of the picture's width.
        """
        across = 1 if stacked else count
        width = max(least, across * panel[0] + (across - 1) * GAP + 2 * MARGIN)
        bottom = below(width)
        if stacked:
            step = panel[1] + TITLE
            corners = tuple((MARGIN, bottom + step * (count - 1 - i)) for i in range(count))
            return cls(width, bottom + step * count + TOP - TITLE, panel, corners)
        pitch = (width - 2 * MARGIN - panel[0]) / (count - 1)
        corners = tuple((MARGIN + i * pitch, bottom) for i in range(count))
        return cls(width, bottom + panel[1] + TOP, panel, corners)

    def figure(self) -> Figure:
        """Return an empty picture."""
        return Figure(figsize=(self.width, self.height), dpi=DPI)

    def add(self, figure: Figure, x: float, y: float, width: float, height: float) -> Axes:
        """Add axes in a rectangle [inch]."""
        w, h = self.width, self.height
        return figure.add_axes((x / w, y / h, width / w, height / h))

    @property
    def lowest(self) -> float:
        """Where the lowest panel ends."""
        return min(y for _, y in self.corners)

    def head(self, figure: Figure, title: str, beside: str = "") -> None:
        """Write a title over the panels, and at the right what else there is to say."""
        left, y, room = MARGIN / self.width, 1 - 0.2 / self.height, self.width - 2 * MARGIN
        if beside:
            beside = shortened(beside, 0.6 * room)
            figure.text(1 - left, y, beside, ha="right", va="top", color=FAINT)
            room -= text_width(beside) + GAP
        figure.text(left, y, shortened(title, room, 12, True), fontsize=12, fontweight="bold", va="top")
