"""``mission.gif``: a tracking mission as a short film."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from vedette.record.canvas import picture
from vedette.record.files import atomic_path
from vedette.record.track.log import TrackLog
from vedette.record.track.panel import draw, window

_WIDTH, _DPI = 7.0, 100  # [inch], [1/inch]
_HIGHEST = 8.0  # [inch]
_FRAME_MS, _LAST_MS = 100, 2500
_COLOURS = 128


def track_gif(log: TrackLog, path: Path | str, frames: int = 150) -> None:
    """Write at most ``frames`` snapshots of a log that is not empty, evenly chosen, ten a second."""
    available = len(log.snapshots)
    chosen = np.unique(np.linspace(0, available - 1, min(available, frames)).round()).astype(int).tolist()
    pictures = _pictures(log, chosen)
    first = next(pictures)
    with atomic_path(path) as temporary:
        first.save(
            temporary,
            save_all=True,
            append_images=pictures,
            duration=[_FRAME_MS] * (len(chosen) - 1) + [_LAST_MS],
            loop=0,
            optimize=False,
            disposal=1,
        )


def _pictures(log: TrackLog, chosen: list[int]) -> Iterator[Image.Image]:
    box = window(log)
    height = min(_HIGHEST, max(1.0, _WIDTH * (box[3] - box[1]) / (box[2] - box[0])))
    palette: Image.Image | None = None
    with picture():
        for k in chosen:
            figure = Figure(figsize=(_WIDTH, height + 0.35), dpi=_DPI)
            axes = figure.add_axes((0.01, 0.01, 0.98, height / (height + 0.35) - 0.01))
            draw(axes, log, log.snapshots[k], box)
            canvas = FigureCanvasAgg(figure)
            canvas.draw()  # type: ignore[no-untyped-call]
            pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
            frame = Image.fromarray(pixels[..., :3].copy())
            if palette is None:
                palette = frame.quantize(_COLOURS, dither=Image.Dither.NONE)
            yield frame.quantize(palette=palette, dither=Image.Dither.NONE)
