"""What may lie behind the frontiers: the known map, continued by pieces of itself that fit."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from vedette.domains.mapping.prior import block_sum
from vedette.maps import FREE, OCCUPIED, UNKNOWN

# All lengths in planning cells, as a robot at the frontier sees them that looks out.
BEHIND, BEFORE, BESIDE = 12, 3, 10  # a piece fits by what is known so far about the frontier
DEEP, WIDE = 30, 20  # it continues the map so far, and so far to either side
LONG = 4  # frontiers from this length are continued ...
MOST = 16  # ... and no more than these, the longest
INSIDE = 6  # what is unknown so near a wall, and nearer to it than to free ground, is solid
APART = 3  # pieces that begin so near each other along both axes are the same one
DRAWN_FROM = 4  # worlds draw from so many pieces that fit best: the first as often as all others together
FITS = 3, 10  # a piece must fit at least so well: share of the best that there can be
TURNS = 8  # with mirrors
EDGE = max(DEEP, WIDE, BEHIND) + APART

_SAME_WALL, _SAME_FREE = 4, 1  # how much a cell that is the same says for a piece
_WALL_AS = {OCCUPIED: _SAME_WALL, FREE: -4, UNKNOWN: -1}  # what a piece has where there is a wall
_FREE_AS = {OCCUPIED: -3, FREE: _SAME_FREE, UNKNOWN: -1}  # and where there is free ground

Frontiers = tuple[NDArray[np.int64], NDArray[np.int64]]  # as ``find_frontiers`` returns them


@dataclass(frozen=True, eq=False)
class _Turned:
    """The known map in one of its turns, with an edge of unknown ground all round."""

    pieces: NDArray[np.uint8]  # (H, W) what a piece continues a map with
    as_wall: NDArray[np.int16]  # (H, W) what each cell says for a piece that has it where there is a wall
    as_free: NDArray[np.int16]  # (H, W) likewise where there is free ground
    begins: NDArray[np.bool_]  # (H, W) without its edge: pieces can begin here

    @classmethod
    def of(cls, known: NDArray[np.uint8], pieces: NDArray[np.uint8]) -> _Turned:
        """Take classes; a piece begins on free ground, and at least half of it is known."""
        as_wall, as_free = (
            np.array([scores[each] for each in (UNKNOWN, FREE, OCCUPIED)], np.int16)[known]
            for scores in (_WALL_AS, _FREE_AS)
        )
        rows, cols = (size - 2 * EDGE for size in known.shape)
        sums = np.pad(np.cumsum(np.cumsum(pieces != UNKNOWN, 0), 1), ((1, 0), (1, 0)))
        bands = sums[EDGE + WIDE + 1 :][:rows] - sums[EDGE - WIDE :][:rows]
        told = bands[:, EDGE + DEEP :][:, :cols] - bands[:, EDGE:][:, :cols]
        begins = (known[EDGE:-EDGE, EDGE:-EDGE] == FREE) & (2 * told >= (2 * WIDE + 1) * DEEP)
        return cls(pieces, as_wall, as_free, begins)

    def fit(self, walls: NDArray[np.int64], free: NDArray[np.int64]) -> NDArray[np.int32]:
        """Return how well each piece fits, less than all that do where none begins; cells (n, 2) from it."""
        rows, cols = self.begins.shape
        total = np.zeros(self.begins.shape, np.int16)
        for said, cells in ((self.as_wall, walls), (self.as_free, free)):
            for down, along in cells + EDGE:
                total += said[down : down + rows, along : along + cols]
        return np.where(self.begins, total, np.iinfo(np.int16).min).astype(np.int32)


def completions(
    classes: NDArray[np.uint8], factor: int, first: tuple[int, int], frontiers: Frontiers, worlds: int
) -> list[NDArray[np.uint8]]:
    """Continue a map behind its frontiers, once for each of so many worlds.

    Behind a frontier lies in a world what lies behind a place of the known map, turned or mirrored, about
    which the walls lie alike.  docs/mapping.md (V200)-(V202)

    Args:
        classes: (R, C) team map in the window.
        factor: side of a planning cell [cells].
        first: planning cell (row, col) at the window's corner: worlds do not hang on the window.
        frontiers: of the map.
        worlds: how many.

    Returns:
        (R, C) each: FREE or OCCUPIED what was unknown and is told, all else UNKNOWN.
    """
    known = np.pad(_coarse(classes, factor), EDGE)
    pieces = _solid_behind_walls(known)
    turned = [_Turned.of(_turn(known, turn), _turn(pieces, turn)) for turn in range(TURNS)]
    told = [np.zeros_like(known) for _ in range(worlds)]
    for middle in _longest(frontiers, classes.shape[1], factor):
        facing = _facing(known, middle)
        if facing is None:
            continue
        fitting = _best(turned, known, middle, facing)
        for world, said in enumerate(told):
            if fitting:
                about = middle[0] + first[0], middle[1] + first[1], world
                turn, row, col = fitting[_draw(about, len(fitting))]
                _continue(said, known, middle, facing, turned[turn].pieces[row - WIDE :, col:])
    rows, cols = classes.shape
    fine = (said[EDGE:-EDGE, EDGE:-EDGE].repeat(factor, 0).repeat(factor, 1)[:rows, :cols] for said in told)
    return [np.where(classes == UNKNOWN, said, np.uint8(UNKNOWN)) for said in fine]


def _coarse(classes: NDArray[np.uint8], factor: int) -> NDArray[np.uint8]:
    """Return planning cells: walls where any of it is, free ground where half of it is, unknown else."""
    wall = block_sum(classes == OCCUPIED, factor) > 0
    free = 2 * block_sum(classes == FREE, factor) >= factor**2
    return np.where(wall, OCCUPIED, np.where(free, FREE, UNKNOWN)).astype(np.uint8)


def _solid_behind_walls(known: NDArray[np.uint8]) -> NDArray[np.uint8]:
    away, nearest = scipy.ndimage.distance_transform_edt(known == UNKNOWN, return_indices=True)
    solid = (known == UNKNOWN) & (known[tuple(nearest)] == OCCUPIED) & (away <= INSIDE)
    return np.where(solid, np.uint8(OCCUPIED), known)


def _longest(frontiers: Frontiers, cols: int, factor: int) -> Iterator[tuple[int, int]]:
    """Yield the planning cells in the middle of the longest frontiers, on the map with its edge."""
    cells, starts = frontiers
    sizes = np.diff(starts)
    order = np.argsort(-sizes, kind="stable")[:MOST]
    for k in order[sizes[order] >= LONG * factor]:
        row, col = np.divmod(cells[starts[k] : starts[k + 1]], cols)
        square = (len(row) * row - row.sum()) ** 2 + (len(col) * col - col.sum()) ** 2
        middle = int(np.argmin(square))
        yield int(row[middle]) // factor + EDGE, int(col[middle]) // factor + EDGE


def _facing(known: NDArray[np.uint8], middle: tuple[int, int]) -> int | None:
    """Return by which turn a frontier's unknown side lies along the columns; None: it has no sides."""
    row, col = middle
    near = known[row - LONG : row + LONG + 1, col - LONG : col + LONG + 1]
    (dark_rows, dark_cols), (rows, cols) = np.nonzero(near == UNKNOWN), np.nonzero(near == FREE)
    if not len(rows) or not len(dark_rows):
        return None
    down = int(dark_rows.sum()) * len(rows) - int(rows.sum()) * len(dark_rows)
    along = int(dark_cols.sum()) * len(cols) - int(cols.sum()) * len(dark_cols)
    if abs(along) >= abs(down):
        return 0 if along > 0 else 2
    return 1 if down > 0 else 3


def _turn(grid: NDArray[np.uint8], turn: int) -> NDArray[np.uint8]:
    """Turn a grid by quarters; from 4 on it is mirrored besides."""
    quarters = np.rot90(grid, turn % 4)
    return np.ascontiguousarray(quarters if turn < 4 else quarters.T)


def _turned_cell(cell: tuple[int, int], shape: tuple[int, int], turn: int) -> tuple[int, int]:
    """Return where a cell of a grid comes to lie."""
    (row, col), (rows, cols) = cell, shape
    for _ in range(turn % 4):
        row, col, rows, cols = cols - 1 - col, row, cols, rows
    return (row, col) if turn < 4 else (col, row)


def _best(
    turned: list[_Turned], known: NDArray[np.uint8], middle: tuple[int, int], facing: int
) -> list[tuple[int, int, int]]:
    """Return the pieces that fit a frontier best, the best first: turn, row and column where each begins."""
    row, col = _turned_cell(middle, known.shape, facing)
    about = _turn(known, facing)[row - BESIDE : row + BESIDE + 1, col - BEHIND : col + BEFORE + 1]
    walls, free = (np.argwhere(about == what) - (BESIDE, BEHIND) for what in (OCCUPIED, FREE))
    free = free[(free @ (1, 2)) % 5 == 0]  # a fifth of it, evenly, says as much
    least = (_SAME_WALL * len(walls) + _SAME_FREE * len(free)) * FITS[0] // FITS[1]
    found: list[tuple[int, int, int, int]] = []
    for turn, each in enumerate(turned):
        fits = each.fit(walls, free)
        own = _turned_cell(middle, known.shape, turn)
        _strike_out(fits, own[0] - EDGE, own[1] - EDGE)
        for _ in range(DRAWN_FROM):
            down, along = divmod(int(np.argmax(fits)), fits.shape[1])
            if fits[down, along] < max(least, 1):
                break
            found.append((-int(fits[down, along]), turn, down + EDGE, along + EDGE))
            _strike_out(fits, down, along)
    return [piece for _, *piece in sorted(found)[:DRAWN_FROM]]  # type: ignore[misc]


def _strike_out(fits: NDArray[np.int32], row: int, col: int) -> None:
    rows, cols = (slice(max(0, at - APART), max(0, at + APART + 1)) for at in (row, col))
    fits[rows, cols] = np.iinfo(np.int16).min


def _draw(about: tuple[int, int, int], pieces: int) -> int:
    """Return a number below ``pieces``, each twice as often as the next: the same on every machine."""
    drawn = hashlib.blake2b(repr(about).encode(), digest_size=2).digest()
    return min(16 - int.from_bytes(drawn, "little").bit_length(), pieces - 1)


def _continue(
    said: NDArray[np.uint8],
    known: NDArray[np.uint8],
    middle: tuple[int, int],
    facing: int,
    piece: NDArray[np.uint8],
) -> None:
    """Lay a piece behind a frontier where nothing is known or told yet."""
    row, col = _turned_cell(middle, known.shape, facing)
    there = np.s_[row - WIDE : row + WIDE + 1, col : col + DEEP]
    onto, over = (np.rot90(grid, facing)[there] for grid in (said, known))  # views: ``said`` is written to
    piece = piece[: onto.shape[0], : onto.shape[1]]
    new = (over == UNKNOWN) & (onto == UNKNOWN) & (piece != UNKNOWN)
    onto[new] = piece[new]
