"""How much room words take in a picture, so that they neither cover anything nor are cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path
from numpy.typing import NDArray

from vedette.record import palette

_FAMILY = "DejaVu Sans"
_SPARE = 1.04  # a renderer's letters are a little wider or narrower
_AWAY = 4.0, 9.0, 16.0, 25.0, 36.0  # of a label from its place [pt]
_TURNS = np.radians(
    (35, 145, -35, -145, 90, -90, 0, 180, 60, 120, -60, -120)
)  # of a label, in order of liking
_DOT = 2.5  # half the side of what is kept clear about a place [pt]
_INK = palette.unit(palette.INK)


def text_width(text: str, size: float = 9.0, bold: bool = False) -> float:
    """Return the width of a text [inch], its size in points."""
    font = FontProperties(family=_FAMILY, size=size, weight="bold" if bold else "normal")
    width, _, _ = text_to_path.get_text_width_height_descent(text, font, False)
    return _SPARE * float(width) / 72.0


def shortened(text: str, room: float, size: float = 9.0, bold: bool = False) -> str:
    """Return a text that fits into a room [inch]: itself, or its beginning and its end."""
    if text_width(text, size, bold) <= room:
        return text
    kept = len(text) - 1
    while kept > 1:
        short = f"{text[: kept - kept // 2]}…{text[len(text) - kept // 2 :]}"
        if text_width(short, size, bold) <= room:
            return short
        kept -= 1
    return "…"


@dataclass(frozen=True)
class Taken:
    """Rectangles of a picture that labels must leave free, ``(n, 4)``: left, bottom, right, top [pixel]."""

    boxes: NDArray[np.float64]

    @classmethod
    def about(cls, places: NDArray[np.float64], half: float) -> Taken:
        """Return squares of half a side about places ``(n, 2)`` [pixel]."""
        return cls(np.concatenate([places - half, places + half], axis=1).reshape(-1, 4))

    def free(self, box: NDArray[np.float64]) -> bool:
        """Tell whether a rectangle meets none of these."""
        apart = (self.boxes[:, :2] >= box[2:]) | (self.boxes[:, 2:] <= box[:2])
        return bool(apart.any(axis=1).all())

    def and_(self, *more: NDArray[np.float64]) -> Taken:
        """Return these and more."""
        return Taken(np.concatenate([self.boxes, *(box.reshape(-1, 4) for box in more)]))


def write_labels(
    axes: Axes,
    places: NDArray[np.float64],
    texts: Sequence[str],
    obstacles: NDArray[np.float64],
    clear: float,
    size: float = 7.0,
) -> None:
    """Write texts beside their places, each where it covers no place, no obstacle and no other text.

    A text with no room inside the axes is left out; one that is not right beside its place has a line to it.

    Args:
        axes: with their final limits.
        places: ``(n, 2)`` in data coordinates.
        texts: one each.
        obstacles: ``(m, 2)``, likewise.
        clear: half the side of what is kept clear about an obstacle [pt].
        size: of the letters [pt].
    """
    axes.apply_aspect()
    figure = axes.get_figure()
    assert figure is not None
    point = figure.dpi / 72.0  # [pixel]
    inside = axes.get_window_extent().extents + np.array((1.0, 1.0, -1.0, -1.0)) * point
    at = axes.transData.transform(places.reshape(-1, 2))
    taken = Taken.about(axes.transData.transform(obstacles.reshape(-1, 2)), clear * point)
    taken = taken.and_(Taken.about(at, _DOT * point).boxes)
    for place, text in zip(at, texts, strict=True):
        room = np.array((text_width(text, size), 1.25 * size / 72.0)) * figure.dpi
        found = _place(place, room, inside, taken, point)
        if found is None:
            continue
        box, away = found
        taken = taken.and_(box)
        x, y = axes.transData.inverted().transform((box[:2] + box[2:]) / 2.0)
        axes.text(x, y, text, fontsize=size, color=_INK, ha="center", va="center", zorder=8)
        if away > _AWAY[0]:
            ends = axes.transData.inverted().transform([place, np.clip(place, box[:2], box[2:])])
            axes.plot(*ends.T, color=_INK, lw=0.4, alpha=0.6, zorder=4.5)


def _place(
    place: NDArray[np.float64],
    room: NDArray[np.float64],
    inside: NDArray[np.float64],
    taken: Taken,
    point: float,
) -> tuple[NDArray[np.float64], float] | None:
    """Return a free rectangle for a text near its place, and how far away [pt]; None if there is none."""
    if (place < inside[:2]).any() or (place > inside[2:]).any():
        return None
    for away in _AWAY:
        for turn in _TURNS:
            towards = np.array((np.cos(turn), np.sin(turn)))
            corner = place + away * point * towards - room * (1.0 - np.sign(np.round(towards, 6))) / 2.0
            box = np.concatenate([corner, corner + room])
            if (box[:2] >= inside[:2]).all() and (box[2:] <= inside[2:]).all() and taken.free(box):
                return box, away
    return None
