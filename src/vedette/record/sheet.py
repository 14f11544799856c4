"""One map on a sheet: its title over it, under it a scale and what its signs mean; nothing covers it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vedette.record.canvas import DPI
from vedette.record.key import LINE, Key
from vedette.record.lettering import shortened
from vedette.record.signs import scale_bar

_WIDTH, _MARGIN, _TITLE, _SCALE = 8.0, 0.08, 0.35, 0.3  # [inch]
_LOW, _HIGH = 2.0, 12.0  # the map is no lower and no higher [inch]
_INSIDE = _WIDTH - 2 * _MARGIN
_SIZE = 11  # of the title [pt]


@dataclass(frozen=True)
class Sheet:
    """A map, and room for its key."""

    figure: Figure
    axes: Axes  # of the map [m]
    key: Key

    @classmethod
    def make(
        cls,
        colours: NDArray[np.uint8],
        extent: tuple[float, float, float, float],
        title: str,
        labels: Sequence[str],
    ) -> Sheet:
        """Lay a map on a sheet.

        Args:
            colours: of its pixels, (rows, cols, 3), row 0 the lowest y.
            extent: x from, x to, y from, y to [m].
            title: shortened where it is too long.
            labels: of what the key explains.
        """
        x0, x1, y0, y1 = extent
        key = Key.of(labels, _INSIDE)
        height, foot = min(max(_INSIDE * (y1 - y0) / (x1 - x0), _LOW), _HIGH), _SCALE + LINE * key.lines
        whole = foot + height + _TITLE
        figure = Figure(figsize=(_WIDTH, whole), dpi=DPI)
        axes = figure.add_axes((_MARGIN / _WIDTH, foot / whole, _INSIDE / _WIDTH, height / whole))
        axes.imshow(colours, origin="lower", extent=extent, interpolation="antialiased")
        axes.set(xticks=(), yticks=())
        shown = min(_INSIDE, height * (x1 - x0) / (y1 - y0))  # of the map's width [inch]
        axes.set_title(shortened(title, shown, _SIZE, True), loc="left", fontsize=_SIZE, fontweight="bold")
        scale_bar(figure, _MARGIN, foot - _SCALE / 2, x1 - x0, shown)
        return cls(figure, axes, key)

    def explain(self, signs: Sequence[Any]) -> None:
        """Write the key: what matplotlib explains in a legend, one for each label."""
        self.key.write(self.figure, _MARGIN, LINE * (self.key.lines - 0.5), signs)
