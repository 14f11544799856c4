"""What names the team in a picture, under it: signs with names, in columns of one width."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

from vedette.record.lettering import shortened, text_width
from vedette.record.log import VehicleSample
from vedette.record.signs import badge, legend_line

LINE = 0.25  # height of a line [inch]
_SIGN, _GAP = 0.34, 0.2  # width of a sign, and between columns [inch]


@dataclass(frozen=True)
class Key:
    """Names that fit into a picture's width."""

    labels: tuple[str, ...]
    columns: int
    pitch: float  # from column to column [inch]

    @classmethod
    def of(cls, labels: Sequence[str], width: float) -> Key:
        """Lay out names, shortened where one alone is too long, in a width [inch]."""
        fitting = tuple(shortened(label, width - _SIGN) for label in labels)
        pitch = _SIGN + _GAP + max(map(text_width, fitting), default=0.0)
        return cls(fitting, max(1, int((width + _GAP) / pitch)), pitch)

    @property
    def lines(self) -> int:
        """Number of lines."""
        return -(-len(self.labels) // self.columns)

    def write(self, figure: Figure, x: float, y: float, signs: Sequence[Any]) -> float:
        """Write the names after their signs, from ``y`` down [inch]; return where the next line goes.

        A sign is what matplotlib explains in a legend, or a letter.
        """
        for k, (sign, label) in enumerate(zip(signs, self.labels, strict=True)):
            row, column = divmod(k, self.columns)
            left, middle = x + column * self.pitch, y - row * LINE
            if isinstance(sign, str):
                _write(figure, left + _SIGN / 2, middle, sign, "center")
                _write(figure, left + _SIGN, middle, label, "left")
            else:
                legend_line(figure, left, middle, [sign], [label])
        return y - self.lines * LINE


def _write(figure: Figure, x: float, y: float, text: str, align: str) -> None:
    width, height = figure.get_size_inches()
    figure.text(x / width, y / height, text, ha=align, va="center_baseline")


def badges(vehicles: Sequence[VehicleSample]) -> list[Any]:
    """Return the vehicles' signs in a key."""
    return [badge(i, vehicle) for i, vehicle in enumerate(vehicles)]


def with_fate(names: Sequence[str], vehicles: Sequence[VehicleSample]) -> list[str]:
    """Return the vehicles' names, and what became of those that are gone."""
    return [
        name + (f" ({each.fate})" if each.fate else "") for name, each in zip(names, vehicles, strict=True)
    ]
