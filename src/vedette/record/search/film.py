"""``mission.gif``: a search as a short film."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from vedette.record.canvas import picture
from vedette.record.files import atomic_path
from vedette.record.search.log import SearchLog
from vedette.record.search.panel import draw, scale

_WIDTH, _DPI = 7.0, 100  # [inch], [1/inch]
_HIGHEST = 8.0  # [inch]
_FRAME_MS, _LAST_MS = 100, 2500
_COLOURS = 200


def search_gif(log: SearchLog, path: Path | str, frames: int = 150) -> None:
    """Write at most ``frames`` snapshots of a log that is not empty, evenly chosen, ten a second."""
    pictures = _pictures(log, frames)
    first, *rest = pictures
    with atomic_path(path) as temporary:
        first.save(
            temporary,
            save_all=True,
            append_images=rest,
            duration=[_FRAME_MS] * len(rest) + [_LAST_MS],
            loop=0,
            optimize=False,
            disposal=1,
        )


def _pictures(log: SearchLog, frames: int) -> Iterator[Image.Image]:
    stages, norm, frame = log.stages(frames), scale(log), log.scene.frame
    height = min(_HIGHEST, max(1.0, _WIDTH * frame.rows / frame.cols))
    palette: Image.Image | None = None
    with picture():
        for stage in stages:
            figure = Figure(figsize=(_WIDTH, height + 0.35), dpi=_DPI)
            axes = figure.add_axes((0.01, 0.01, 0.98, height / (height + 0.35) - 0.01))
            draw(axes, log, stage, norm, stage is stages[-1])
            canvas = FigureCanvasAgg(figure)
            canvas.draw()  # type: ignore[no-untyped-call]
            pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
            image = Image.fromarray(pixels[..., :3].copy())
            if palette is None:
                palette = image.quantize(_COLOURS, dither=Image.Dither.NONE)
            yield image.quantize(palette=palette, dither=Image.Dither.NONE)
