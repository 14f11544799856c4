"""What all pictures share: style, resolution, and files without a date in them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from vedette.record import palette
from vedette.record.files import atomic_path

DPI = 150

_STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "text.color": palette.unit(palette.INK),
    "axes.labelcolor": palette.unit(palette.INK),
    "axes.edgecolor": palette.unit((150, 153, 157)),
    "axes.linewidth": 0.7,
    "xtick.color": palette.unit(palette.FAINT),
    "ytick.color": palette.unit(palette.FAINT),
}


@contextmanager
def picture() -> Iterator[None]:
    """Draw in our style, whatever the user's matplotlib settings are; they are back afterwards."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_STYLE)
        yield


def tidy(axes: Axes, grid: Literal["both", "y"] = "both") -> None:
    """Take away what a plot does not need, and lay a faint grid under it."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis=grid, color=palette.unit(palette.GRID), lw=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(length=3)


def save(figure: Figure, path: Path | str) -> None:
    """Write a PNG atomically; the same figure gives the same bytes."""
    with atomic_path(path) as temporary:
        FigureCanvasAgg(figure).print_png(temporary, metadata={"Software": None})  # type: ignore[no-untyped-call]
