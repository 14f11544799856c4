"""What a map says of walls and free ground, made ready to be laid on another's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from vedette.kernels.align import CLEAR, ELSE, NOWHERE, SAME
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame

Floats = NDArray[np.float64]

CELL = 0.1  # finer maps are looked at in cells of about this side [m]
NEAR = 0.2  # a wall as near as this may be the same wall [m]
FAR = 0.4  # free ground is clear where no wall is as near as this [m]
_SMOOTH = 1.5  # of the free ground beside a wall, for the wall's direction [cells]


@dataclass(frozen=True, eq=False)
class Charted:
    """A map's known part; places are metres from its middle, in the map's own frame."""

    frame: GridFrame  # of the known part, in the map's own frame
    classes: NDArray[np.uint8]  # (R, C) UNKNOWN, FREE or OCCUPIED

    @property
    def middle(self) -> Floats:
        """``(2,)`` x, y of the known part's middle [m], the map's own frame."""
        x_min, x_max, y_min, y_max = self.frame.extent
        return np.array([(x_min + x_max) / 2.0, (y_min + y_max) / 2.0])

    @property
    def cell(self) -> float:
        """Side of a cell [m]."""
        return self.frame.resolution

    @property
    def side(self) -> float:
        """The longer side of the known part [m]."""
        return max(self.frame.shape) * self.cell

    @cached_property
    def radius(self) -> float:
        """How far from the middle the known part reaches [m]."""
        return float(np.hypot(*np.vstack([self.walls, self.free]).T).max())

    @property
    def corner(self) -> Floats:
        """``(2,)`` of the first cell, from the middle [m]."""
        return np.array([-self.frame.cols, -self.frame.rows]) * self.cell / 2.0

    @cached_property
    def faces(self) -> NDArray[np.bool_]:
        """``(R, C)``: occupied cells beside free ones; what is behind them does not count."""
        beside = scipy.ndimage.binary_dilation(self.classes == FREE, np.ones((3, 3), np.bool_))
        return np.asarray(beside & (self.classes == OCCUPIED))

    @cached_property
    def walls(self) -> Floats:
        """``(n, 2)``: the faces' middles [m]."""
        return self._places(self.faces)

    @cached_property
    def free(self) -> Floats:
        """``(m, 2)``: the free cells' middles [m]."""
        return self._places(self.classes == FREE)

    @cached_property
    def normals(self) -> Floats:
        """``(n, 2)``: unit vectors from each face to the free ground before it."""
        open_ground = (self.classes == FREE).astype(np.float32) - (self.classes == OCCUPIED)
        smooth = scipy.ndimage.gaussian_filter(open_ground, _SMOOTH, mode="nearest", truncate=3.0)
        down, across = np.gradient(smooth) if min(smooth.shape) > 1 else (smooth * 0.0, smooth * 0.0)
        along = np.stack([across[self.faces], down[self.faces]], axis=1).astype(np.float64)
        length = np.hypot(*along.T)[:, None]
        normals: Floats = np.divide(along, length, out=np.zeros_like(along), where=length > 0.0)
        return normals

    @cached_property
    def _nearest(self) -> tuple[Floats, NDArray[np.int32]]:
        """How far each cell is from the next face [cells], and the face's flat cell."""
        far, (rows, cols) = scipy.ndimage.distance_transform_edt(~self.faces, return_indices=True)
        return far, (rows * self.frame.cols + cols).astype(np.int32)

    @cached_property
    def labels(self) -> NDArray[np.uint8]:
        """``(R, C)``: what a wall of another map that falls on a cell means."""
        far = self._nearest[0] * self.cell
        labels = np.where(self.classes == UNKNOWN, np.uint8(NOWHERE), np.uint8(ELSE))
        labels[(self.classes == FREE) & (far > FAR)] = CLEAR
        labels[far <= max(NEAR, 1.5 * self.cell)] = SAME
        return labels

    @cached_property
    def looks(self) -> NDArray[np.uint8]:
        """``(n,)``: which way each face looks, in 1/256 of a turn."""
        turns = np.arctan2(self.normals[:, 1], self.normals[:, 0]) * (128.0 / math.pi)
        return (np.rint(turns).astype(np.int64) % 256).astype(np.uint8)

    @cached_property
    def looks_at(self) -> NDArray[np.uint8]:
        """``(R, C)``: which way the face nearest to each cell looks."""
        return self.looks[self.face_at]

    @cached_property
    def face_at(self) -> NDArray[np.int32]:
        """``(R, C)``: which of `walls` is nearest to each cell."""
        number = np.cumsum(self.faces.ravel(), dtype=np.int32) - 1
        return number[self._nearest[1]]

    def _places(self, mask: NDArray[np.bool_]) -> Floats:
        rows, cols = np.nonzero(mask)
        return self.corner + (np.stack([cols, rows], axis=1) + 0.5) * self.cell


def charted(frame: GridFrame, classes: NDArray[np.uint8]) -> Charted | None:
    """Return the known part of a map, in cells of `CELL` or the map's own if those are larger.

    None: it knows no wall beside free ground, so that nothing can be laid on it.
    """
    rows, cols = np.nonzero(classes != UNKNOWN)
    if not len(rows):
        return None
    top, left = int(rows.min()), int(cols.min())
    known = classes[top : rows.max() + 1, left : cols.max() + 1]
    step = max(1, round(CELL / frame.resolution))
    x, y = frame.origin_x + left * frame.resolution, frame.origin_y + top * frame.resolution
    coarse = _coarse(known, step)
    high, wide = coarse.shape
    made = Charted(GridFrame(frame.resolution * step, high, wide, x, y), coarse)
    return made if made.faces.any() else None


def _coarse(classes: NDArray[np.uint8], step: int) -> NDArray[np.uint8]:
    """Return a map in cells of ``step x step``: occupied with any occupied cell, free with any free one."""
    if step == 1:
        return np.ascontiguousarray(classes)
    rows, cols = (-(-n // step) for n in classes.shape)
    padded = np.full((rows * step, cols * step), UNKNOWN, np.uint8)
    padded[: classes.shape[0], : classes.shape[1]] = classes
    # of the classes the highest counts: UNKNOWN < FREE < OCCUPIED
    return np.asarray(padded.reshape(rows, step, cols, step).max(axis=(1, 3)))
