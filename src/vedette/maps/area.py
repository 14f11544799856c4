"""Where a team has leave to work: a polygon, outside of which nothing is anybody's."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.maps.frame import OCCUPIED, GridFrame
from vedette.number import many

MOST_CORNERS = 1000
MOST_METRES = 2.1e7  # from the team frame's origin, as far as UTM's coordinates reach


@dataclass(frozen=True)
class Area:
    """A polygon without holes; where its edges cross, what an odd number of them goes round is inside."""

    corners: tuple[tuple[float, float], ...]  # x, y [m], team frame, in order

    @classmethod
    def of(cls, corners: Sequence[Sequence[float]]) -> Area:
        """Return the area with these corners.

        Raises:
            InputError: they make no area.
        """
        if not 3 <= len(corners) <= MOST_CORNERS:
            raise InputError(f"area: {many(len(corners), 'corner')}; a polygon has 3 to {MOST_CORNERS}")
        points = tuple((float(x), float(y)) for x, y in corners)
        for x, y in points:
            if not (abs(x) <= MOST_METRES and abs(y) <= MOST_METRES):
                raise InputError(f"area: corner [{x:g}, {y:g}]; give metres within {MOST_METRES:g}")
        if _on_a_line(points):
            raise InputError("area: all corners are on a line; give them in order round the ground")
        return cls(points)

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Lowest x, lowest y, highest x, highest y [m]."""
        xs, ys = zip(*self.corners, strict=True)
        return min(xs), min(ys), max(xs), max(ys)

    @property
    def square_metres(self) -> float:
        """How large it is, if no edges cross [m^2]."""
        x, y = np.array(self.corners).T
        return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2.0

    def distance(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far points ``(n, 2)`` [m] are from it; 0 inside."""
        start = np.array(self.corners)
        along = np.roll(start, -1, axis=0) - start
        away = places[:, None] - start  # (n, E, 2)
        square = np.maximum((along**2).sum(axis=1), 1e-12)
        t = np.clip((away * along).sum(axis=2) / square, 0.0, 1.0)
        edges: NDArray[np.float64] = np.hypot(*(away - t[..., None] * along).transpose(2, 0, 1)).min(axis=1)
        x, y = places[:, None].transpose(2, 0, 1)
        (x0, y0), (dx, dy) = start.T, along.T
        crosses = (y0 <= y) != (y0 + dy <= y)
        left = x < x0 + (y - y0) * np.divide(dx, dy, out=np.zeros_like(dx), where=dy != 0.0)
        inside = (crosses & left).sum(axis=1) % 2 == 1
        return np.where(inside, 0.0, edges)

    def holds(self, frame: GridFrame) -> NDArray[np.bool_]:
        """Return ``(R, C)``: which cells of a grid have their centre inside, by the crossings of each row."""
        inside = np.zeros(frame.shape, np.bool_)
        y = frame.origin_y + (np.arange(frame.rows) + 0.5) * frame.resolution
        crossings: list[list[float]] = [[] for _ in range(frame.rows)]
        for (x0, y0), (x1, y1) in zip(self.corners, (*self.corners[1:], self.corners[0]), strict=True):
            if y0 == y1:
                continue
            for row in np.flatnonzero((y >= min(y0, y1)) & (y < max(y0, y1))).tolist():
                crossings[row].append(x0 + (y[row] - y0) * (x1 - x0) / (y1 - y0))
        for row, xs in enumerate(crossings):
            first = [math.ceil((x - frame.origin_x) / frame.resolution - 0.5) for x in sorted(xs)]
            for low, high in zip(first[::2], first[1::2], strict=True):
                inside[row, max(low, 0) : max(high, 0)] = True
        return inside

    def close(self, classes: NDArray[np.uint8], frame: GridFrame) -> NDArray[np.uint8]:
        """Return the ``(R, C)`` classes of a grid with walls wherever the ground is not the team's."""
        return np.where(self.holds(frame), classes, np.uint8(OCCUPIED))


def _on_a_line(points: Sequence[tuple[float, float]]) -> bool:
    """Tell whether no three of some points make a triangle, up to rounding."""
    away = np.array(points) - points[0]
    far = away[np.hypot(*away.T).argmax()]
    off = np.abs(away[:, 0] * far[1] - away[:, 1] * far[0])
    return bool(off.max() <= 1e-9 * (far @ far))
