"""``mission.gif``: a mission as a short film, ten pictures a second."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from vedette.record.canvas import picture
from vedette.record.files import atomic_path
from vedette.record.flights import SnapshotT

_FRAME_MS = 100
_LAST_MS = 2500  # the last frame stays
_WIDTH, _DPI = 7.0, 100  # [inch], [1/inch]
_HIGHEST, _TITLE = 8.0, 0.35  # [inch]


def write_gif(frames: Iterator[Image.Image], count: int, path: Path | str) -> None:
    """Write so many pictures, at least one."""
    first = next(frames)
    with atomic_path(path) as temporary:
        first.save(
            temporary,
            save_all=True,
            append_images=frames,
            duration=[_FRAME_MS] * (count - 1) + [_LAST_MS],
            loop=0,
            optimize=False,
            disposal=1,
        )


def flight_gif(
    stages: Sequence[SnapshotT],
    draw: Callable[[Axes, SnapshotT], None],
    aspect: float,
    colours: int,
    path: Path | str,
) -> None:
    """Write a film of snapshots, at least one.

    Args:
        stages: the snapshots.
        draw: draws one of them, with a title.
        aspect: of the area, width over height.
        colours: of the film.
        path: where to.
    """
    write_gif(_drawn(stages, draw, min(_HIGHEST, max(1.0, _WIDTH / aspect)), colours), len(stages), path)


def _drawn(
    stages: Sequence[SnapshotT], draw: Callable[[Axes, SnapshotT], None], height: float, colours: int
) -> Iterator[Image.Image]:
    palette: Image.Image | None = None
    with picture():
        for stage in stages:
            figure = Figure(figsize=(_WIDTH, height + _TITLE), dpi=_DPI)
            draw(figure.add_axes((0.01, 0.01, 0.98, height / (height + _TITLE) - 0.01)), stage)
            canvas = FigureCanvasAgg(figure)
            canvas.draw()  # type: ignore[no-untyped-call]
            pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
            frame = Image.fromarray(pixels[..., :3].copy())
            if palette is None:
                palette = frame.quantize(colours, dither=Image.Dither.NONE)
            yield frame.quantize(palette=palette, dither=Image.Dither.NONE)
