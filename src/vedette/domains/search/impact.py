"""The impact of a search strategy: quantised log-misses per cell and layer, sparse."""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.misses import CERTAIN, STEPS_PER_NAT, Misses, SparseMisses
from vedette.maps import GridFrame
from vedette.maps.swept import most_cells_swept
from vedette.problem import Reach

Impact: TypeAlias = SparseMisses  # docs/search.md (V44)
NOTHING = Impact(np.empty(0, np.uint32), np.empty(0, np.uint8))


def quantise(probability: NDArray[np.float64]) -> Misses:
    """``-16 ln(1 - p)``, rounded once; a detection probability below 3 % rounds to nothing (0)."""
    with np.errstate(divide="ignore"):
        levels = -STEPS_PER_NAT * np.log(1.0 - np.asarray(probability, np.float64))
    return np.minimum(levels + 0.5, CERTAIN).astype(np.uint8)


def clip(impact: Impact, frame: GridFrame, layers: int, reach: Reach) -> Impact:
    """Keep what lies in cells that any of the boxes touches.

    If they hold those of ``SearchPlatform.reach`` for every receiver, no receiver's gains change.

    Args:
        impact: what to send.
        frame: the belief's grid.
        layers: the belief's.
        reach: boxes lowest x, lowest y, highest x, highest y [m], team frame.
    """
    row, col = np.divmod(impact.keys // np.uint32(layers), np.uint32(frame.cols))
    keep = np.zeros(len(impact.keys), bool)
    for x0, y0, x1, y1 in reach:
        first, last = frame.cell(x0, y0), frame.cell(x1, y1)
        keep |= (row >= first[0]) & (row <= last[0]) & (col >= first[1]) & (col <= last[1])
    return Impact(impact.keys[keep], impact.misses[keep])


@dataclass(frozen=True)
class Most:
    """What no vehicle of the team exceeds."""

    range: float  # of the detector [m]
    speed: float  # [m/s]


def check_claim(
    impact: Impact, robots: int, most: Most, side: float, layers: int, horizon: int, dt: float
) -> None:
    """Raise ``ValueError`` for what so many vehicles cannot look at, wherever they are.

    In a step each looks at what comes within its range on a way of ``speed dt``; after the horizon each
    promises one block, of at most the area ``2 range speed horizon dt`` that it sweeps meanwhile.

    Args:
        impact: of so many vehicles, combined.
        robots: how many.
        most: the team's limits.
        side: of a cell [m].
        layers, horizon, dt: the belief's; the first ``horizon`` layers are steps, the others promises.
    """
    looked = np.bincount(impact.keys % np.uint32(layers), minlength=layers)
    step = float(most_cells_swept(most.range, most.speed * dt, side))
    block = (math.sqrt(2.0 * most.range * most.speed * horizon * dt) / side + 1.0) ** 2
    if looked[:horizon].max() > robots * step:
        raise ValueError(
            f"impact claims {looked[:horizon].max()} cells in a step; {robots} vehicles see fewer"
        )
    if looked[horizon:].sum() > robots * block:
        raise ValueError(f"impact promises {looked[horizon:].sum()} cells; {robots} vehicles search fewer")


class ImpactCodec:
    """Impacts as bytes: layer by layer, cells by gaps, log-misses apart, deflated."""

    def __init__(self, cells: int, layers: int) -> None:
        """Take the belief's number of cells and layers."""
        self._cells = cells
        self._layers = layers

    def encode(self, impact: Impact) -> bytes:
        """Return at most ``bound`` bytes for any impact over these cells and layers."""
        cell, layer = np.divmod(impact.keys.astype(np.int64), self._layers)
        place = layer * self._cells + cell
        order = np.argsort(place, kind="stable")
        gap = np.diff(place[order], prepend=0)
        small = np.minimum(gap, 255).astype(np.uint8)
        large = gap[gap >= 255].astype("<u4")
        count = np.array([len(gap)], "<u4")
        body = b"".join((count.tobytes(), small.tobytes(), impact.misses[order].tobytes(), large.tobytes()))
        return zlib.compress(body, 6, wbits=-15)

    def decode(self, payload: bytes) -> Impact:
        """Return the impact.

        Raises:
            ValueError: the payload is not an impact over these cells and layers.
        """
        body = self._inflate(payload)
        count = int(np.frombuffer(body, "<u4", 1)[0])
        if len(body) < 4 + 2 * count:
            raise ValueError("impact has fewer entries than it declares")
        small = np.frombuffer(body, np.uint8, count, 4)
        misses = np.frombuffer(body, np.uint8, count, 4 + count)
        large = body[4 + 2 * count :]
        wide = small == 255
        if len(large) != 4 * int(np.count_nonzero(wide)):
            raise ValueError("impact has the wrong number of wide gaps")
        gap = small.astype(np.int64)
        gap[wide] = np.frombuffer(large, "<u4")
        if np.any(gap[1:] == 0) or np.any(misses == 0):
            raise ValueError("impact has the same cell and layer twice, or an empty entry")
        place = np.cumsum(gap)
        if count and place[-1] >= self._cells * self._layers:
            raise ValueError("impact has a cell outside the area or a layer beyond the horizon")
        layer, cell = np.divmod(place, self._cells)
        keys = (cell * self._layers + layer).astype(np.uint32)
        order = np.argsort(keys, kind="stable")
        return Impact(keys[order], misses[order])

    def _inflate(self, payload: bytes) -> bytes:
        try:
            unpacker = zlib.decompressobj(wbits=-15)
            body = unpacker.decompress(payload, self._largest_body + 1)
        except zlib.error as error:
            raise ValueError(f"impact does not inflate: {error}") from None
        if not unpacker.eof or unpacker.unused_data or len(body) < 4:
            raise ValueError("impact is cut short or too large")
        return body

    @property
    def bound(self) -> int:
        """Largest encoding of any impact over these cells and layers [bytes]; no team size in it."""
        return self._largest_body + 5 * (self._largest_body // 16383 + 1) + 64  # deflate at its worst

    @property
    def _largest_body(self) -> int:
        """The count, two bytes an entry, four more a wide gap: gaps sum to less than the places."""
        places = self._cells * self._layers
        return 4 + 2 * places + 4 * (places // 255)
