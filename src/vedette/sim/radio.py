"""Radio between simulated robots: links end with distance and are weakened by walls."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError

EXPONENT = 2.0  # of the distance law: that of free space, for walls are counted apart
WALL_DB = 3.4  # of a light wall (COST 231); of one of brick or concrete 6.9 [dB]
SOUND_DB = 6.0  # a link with this margin loses nothing [dB]
EDGE_LOSS = 0.5  # share of messages lost where the margin is 0

_NUMBER = r"(\d+\.?\d*|\.\d+)"
_RADIO = re.compile(rf"{_NUMBER}(?:\s*,\s*{_NUMBER})?")
_AT_ONCE = 1 << 18  # crossings of cell borders worked on together
_TOUCH = 1e-9  # share of a segment that is no more than a corner touched


@dataclass(frozen=True)
class Radio:
    """All robots' radios, alike.

    The margin of a link is ``10 EXPONENT log10(range / distance) - wall_db * walls`` [dB]: free space and a
    fixed loss a wall, the multi-wall model of COST 231 (final report, section 4.7). A link exists where the
    margin is not negative, so never beyond ``range``.

    Raises:
        InputError: a field out of its range.
    """

    range: float  # with nothing between [m]
    wall_db: float = WALL_DB  # lost in each wall [dB]

    def __post_init__(self) -> None:
        if not 0.1 <= self.range <= 1e4:
            raise InputError(f"the range of a radio must be 0.1 to 10000 m; got {self.range:g}")
        if not 0.0 <= self.wall_db <= 200.0:
            raise InputError(f"what a radio loses in a wall must be 0 to 200 dB; got {self.wall_db:g}")

    def __str__(self) -> str:
        """Return what :func:`parse_radio` reads."""
        return f"{self.range:g},{self.wall_db:g}"

    def margin(self, distance: NDArray[np.float64], walls: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return how far above the faintest that is heard a signal comes in [dB], for distances [m]."""
        clear = 10.0 * EXPONENT * np.log10(self.range / np.maximum(distance, 1e-6))
        return np.asarray(clear - self.wall_db * walls)

    def quality(
        self, solid: NDArray[np.bool_], resolution: float, positions: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return ``(n, n)``: share of messages lost between robots; 1 where there is no link. Symmetric.

        ``solid[row, col]`` is the true world in cells of ``resolution`` [m], ``positions`` ``(n, 2)``
        x and y in it [m], from its lower-left corner. Nobody has a link to itself.
        """
        loss = np.ones((len(positions), len(positions)))
        a, b = np.triu_indices(len(positions), 1)
        distance = np.hypot(*(positions[b] - positions[a]).T)
        near = distance <= self.range
        a, b, distance = a[near], b[near], distance[near]
        walls = walls_between(solid, positions[a] / resolution, positions[b] / resolution)
        loss[a, b] = loss[b, a] = packet_loss(self.margin(distance, walls))
        return loss


def parse_radio(text: str) -> Radio:
    """Return the radio of ``--radio RANGE[,WALL_DB]``.

    Raises:
        InputError: not of that form, or a number out of its range.
    """
    match = _RADIO.fullmatch(text.strip())
    if match is None:
        raise InputError(f"--radio must be range in m[,dB lost a wall], such as 12 or 12,3.4; got {text!r}")
    try:
        return Radio(float(match[1]), WALL_DB if match[2] is None else float(match[2]))
    except InputError as error:
        raise InputError(f"--radio {text}: {error}") from None


def packet_loss(margin: NDArray[np.float64]) -> NDArray[np.float64]:
    """``EDGE_LOSS (1 - margin / SOUND_DB)^2`` from 0 to ``SOUND_DB``; 0 above, 1 below: no link."""
    falls_short = np.clip(1.0 - margin / SOUND_DB, 0.0, 1.0)
    return np.where(margin < 0.0, 1.0, EDGE_LOSS * falls_short**2)


def walls_between(
    solid: NDArray[np.bool_], start: NDArray[np.float64], end: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Return ``(m,)``: the separate runs of solid cells that segments cross.

    ``start`` and ``end`` are ``(m, 2)``, x and y in cells from the lower-left corner of ``solid[row, col]``.
    Cells that a segment only touches at a corner are not crossed.
    """
    walls = np.zeros(len(start), dtype=np.int64)
    if not len(start):
        return walls
    lines = 2 + np.ceil(np.abs(end - start).max(axis=0)).astype(
        int
    )  # of the grid that one may cross, by axis
    share = max(1, _AT_ONCE // int(lines.sum()))
    for first in range(0, len(start), share):
        some = slice(first, first + share)
        walls[some] = _runs(_solid_along(solid, start[some], end[some] - start[some], lines))
    return walls


def _solid_along(
    solid: NDArray[np.bool_], start: NDArray[np.float64], step: NDArray[np.float64], lines: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Return ``(m, k)``: whether each piece of a segment, from one border of a cell to the next, is solid."""
    ends = np.zeros((len(start), 1)), np.ones((len(start), 1))
    cuts = np.concatenate(
        [ends[0], _cuts(start, step, lines, 0), _cuts(start, step, lines, 1), ends[1]], axis=1
    )
    cuts.sort(axis=1)
    middle = 0.5 * (cuts[:, 1:] + cuts[:, :-1])
    col, row = (
        np.clip((start[:, axis, None] + step[:, axis, None] * middle).astype(np.int64), 0, size - 1)
        for axis, size in enumerate(solid.shape[::-1])
    )
    pieces = np.arange(middle.shape[1])
    last = np.maximum.accumulate(
        np.where(np.diff(cuts) > _TOUCH, pieces, 0), axis=1
    )  # that is not a mere touch
    return np.take_along_axis(solid[row, col], last, axis=1)


def _cuts(
    start: NDArray[np.float64], step: NDArray[np.float64], lines: NDArray[np.int64], axis: int
) -> NDArray[np.float64]:
    """Return ``(m, lines)`` in [0, 1]: where segments cross the grid lines of an axis; 1 for those beyond."""
    low = np.minimum(start[:, axis], start[:, axis] + step[:, axis])
    line = np.floor(low)[:, None] + 1.0 + np.arange(lines[axis])
    along = np.full(line.shape, math.inf)
    np.divide(line - start[:, axis, None], step[:, axis, None], out=along, where=step[:, axis, None] != 0.0)
    return np.asarray(np.clip(along, 0.0, 1.0))


def _runs(along: NDArray[np.bool_]) -> NDArray[np.int64]:
    begins = along[:, 1:] & ~along[:, :-1]
    return np.asarray(along[:, 0] + np.count_nonzero(begins, axis=1))
