"""Pictures of curves over one time: axes one above the other, their legends between them, never on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vedette.record.canvas import DPI, tidy
from vedette.record.lettering import shortened, text_width
from vedette.record.signs import FAINT

WIDTH = 8.0  # of the picture [inch]
LEFT, RIGHT = 0.76, 0.24  # of the axes, to the picture's sides [inch]
_HEAD, _BETWEEN, _FOOT = 0.52, 0.16, 0.52  # over all, between axes, under the lowest for its words [inch]
_LINE = 0.175  # of a legend [inch]


@dataclass(frozen=True)
class Strip:
    """One of the axes."""

    height: float  # [inch]
    legend: int = 0  # lines of a legend above it


@dataclass(frozen=True)
class Strips:
    """A picture of some strips, the first on top, over a time that they share."""

    figure: Figure
    axes: tuple[Axes, ...]
    below: float  # where room under the strips begins, for more [inch from the picture's foot]

    @classmethod
    def make(cls, strips: Sequence[Strip], title: str, beside: str = "", more: float = 0.0) -> Strips:
        """Return empty axes under a title; ``beside``: said at its right; ``more``: room under all [inch]."""
        above = [_LINE * strip.legend + _BETWEEN for strip in strips]
        height = _HEAD + sum(above) + sum(strip.height for strip in strips) + _FOOT + more
        figure = Figure(figsize=(WIDTH, height), dpi=DPI)
        top, made = height - _HEAD, list[Axes]()
        for strip, gap in zip(strips, above, strict=True):
            top -= gap + strip.height
            box = LEFT / WIDTH, top / height, (WIDTH - LEFT - RIGHT) / WIDTH, strip.height / height
            axes = figure.add_axes(box, sharex=made[0] if made else None)
            tidy(axes, "y")
            axes.yaxis.set_label_coords((0.2 - LEFT) / (WIDTH - LEFT - RIGHT), 0.5)
            made.append(axes)
        for axes in made[:-1]:
            axes.tick_params(labelbottom=False)
        made[-1].set_xlabel("time [s]")
        _head(figure, height, title, beside)
        return cls(figure, tuple(made), more)


def legend_above(axes: Axes, handles: Sequence[Any], columns: int = 1, right: bool = False) -> None:
    """Explain what is drawn on axes, above them; ``handles`` have labels and are read line by line."""
    read_down = [handles[k] for c in range(columns) for k in range(c, len(handles), columns)]
    axes.legend(
        handles=read_down, loc="lower right" if right else "lower left",
        bbox_to_anchor=(1.0 if right else 0.0, 1.0), ncols=columns, frameon=False, borderpad=0.0,
        borderaxespad=0.35, labelspacing=0.35, columnspacing=1.4, handletextpad=0.6,
    )  # fmt: skip


def _head(figure: Figure, height: float, title: str, beside: str) -> None:
    room, y = WIDTH - LEFT - RIGHT, 1.0 - 0.36 / height
    if beside:
        figure.text(1.0 - RIGHT / WIDTH, y, beside, ha="right", color=FAINT)
        room -= text_width(beside) + 0.2
    figure.text(LEFT / WIDTH, y, shortened(title, room, 12, True), fontsize=12, fontweight="bold")
