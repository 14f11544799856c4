"""What stands in which room of an office."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from vedette.sim.worlds.floor_plan import OPEN_PLAN, FloorPlan
from vedette.sim.worlds.furniture import Floor, Piece
from vedette.sim.worlds.rect import Rect
from vedette.sim.worlds.size import WorldScale

Fill = Callable[[np.random.Generator, Floor, Rect], None]


def furnish(rng: np.random.Generator, plan: FloorPlan, cells: WorldScale) -> Floor:
    """Return the floor with furniture in every room, by its size, and a little in the corridors."""
    floor = Floor(plan, cells)
    for room in plan.rooms:
        area = room.area * cells.resolution**2
        if area >= OPEN_PLAN:
            fills: list[tuple[float, Fill]] = [(0.65, _open_plan), (0.15, _canteen), (0.2, _laboratory)]
        elif area >= 20.0:
            fills = [(0.4, _shared_office), (0.35, _meeting), (0.25, _laboratory)]
        else:
            fills = [(0.68, _office), (0.14, _meeting), (0.18, _store)]
        chances, choices = zip(*fills, strict=True)
        choices[rng.choice(len(choices), p=chances)](rng, floor, room)
    for corridor in plan.corridors:
        length = max(corridor.height, corridor.width) * cells.resolution
        pieces = [_box(cells, rng.uniform(0.3, 0.4), rng.uniform(0.8, 1.6)) for _ in range(int(length / 8.0))]
        _along_walls(rng, floor, corridor, pieces)
    return floor


def _office(rng: np.random.Generator, floor: Floor, room: Rect) -> None:
    """One or two desks, cupboards, a shelf."""
    cells = floor.cells
    pieces = [_desk(cells) for _ in range(int(rng.integers(1, 3)))]
    pieces += [_box(cells, 0.4, rng.uniform(0.8, 1.8)) for _ in range(int(rng.integers(1, 4)))]
    _along_walls(rng, floor, room, pieces)


def _shared_office(rng: np.random.Generator, floor: Floor, room: Rect) -> None:
    """An island of desks or desks along the walls, and cupboards."""
    cells = floor.cells
    if rng.random() < 0.6:
        _in_the_middle(floor, room, _island(cells, 2))
    desks = [_desk(cells) for _ in range(int(rng.integers(2, 4)))]
    cupboards = [_box(cells, 0.4, rng.uniform(1.0, 2.4)) for _ in range(3)]
    _along_walls(rng, floor, room, desks + cupboards)


def _meeting(rng: np.random.Generator, floor: Floor, room: Rect) -> None:
    """A table with chairs, as long as the room allows, and a cupboard."""
    cells = floor.cells
    long = max(room.height, room.width) * cells.resolution
    short = min(room.height, room.width) * cells.resolution
    wide = 1.2 if short > 4.2 else 0.8
    for seats in range(min(7, int((long - 2.4) / 0.7)), 1, -1):
        if _in_the_middle(floor, room, _table(cells, seats, wide)):
            break
    _along_walls(rng, floor, room, [_box(cells, 0.4, rng.uniform(1.0, 2.0)) for _ in range(2)])


def _store(rng: np.random.Generator, floor: Floor, room: Rect) -> None:
    """Shelves along the walls, as many as go in."""
    cells = floor.cells
    _along_walls(rng, floor, room, [_box(cells, 0.5, rng.uniform(1.2, 2.4)) for _ in range(6)])


def _laboratory(rng: np.random.Generator, floor: Floor, room: Rect) -> None:
    """Rows of benches across the room, long cupboards on the walls."""
    cells = floor.cells
    short = min(room.height, room.width) * cells.resolution
    benches = [_box(cells, 0.9, long) for long in (1.6, 2.4, max(1.4, short - 2.4))]
    _rows(rng, floor, room, benches, aisle=1.2, keep=0.95)
    _along_walls(rng, floor, room, [_box(cells, 0.5, rng.uniform(1.2, 3.0)) for _ in range(5)])


def _open_plan(rng: np.random.Generator, floor: Floor, room: Rect) -> None:
    """Rows of desk islands with aisles, pillars between, shelves on the walls."""
    cells = floor.cells
    _rows(rng, floor, room, [_island(cells, pairs) for pairs in (1, 2, 3)], aisle=0.9, keep=0.92)
    _along_walls(rng, floor, room, [_box(cells, 0.4, rng.uniform(1.0, 2.4)) for _ in range(6)])


def _canteen(rng: np.random.Generator, floor: Floor, room: Rect) -> None:
    """A counter and small tables."""
    cells = floor.cells
    _rows(rng, floor, room, [_table(cells, seats, 0.8) for seats in (1, 2)], aisle=1.2, keep=0.9)
    _along_walls(rng, floor, room, [_box(cells, 0.5, rng.uniform(2.0, 3.5)) for _ in range(2)])


def _along_walls(rng: np.random.Generator, floor: Floor, area: Rect, pieces: Sequence[Piece]) -> None:
    """Stand each piece with its back to some wall, in a corner or anywhere along it, where it first fits."""
    for piece in pieces:
        for wall in rng.permutation(4):
            turned = piece
            for _ in range(wall):
                turned = turned.turned()
            if _against(rng, floor, area, turned, int(wall)):
                break


def _against(rng: np.random.Generator, floor: Floor, area: Rect, piece: Piece, wall: int) -> bool:
    """Try both corners and four places more along a wall: 0 low row, 1 high col, 2 high row, 3 low col."""
    rows = area.row, area.row_end - piece.height
    cols = area.col, area.col_end - piece.width
    low, high = cols if wall in (0, 2) else rows
    if high < low:
        return False
    fixed = (rows[0], cols[1], rows[1], cols[0])[wall]
    places = [low, high, *rng.integers(low, high + 1, size=4)]
    for place in rng.permutation(np.array(places)).tolist():
        row, col = (fixed, place) if wall in (0, 2) else (place, fixed)
        if floor.put(piece, row, col):
            return True
    return False


def _in_the_middle(floor: Floor, room: Rect, piece: Piece) -> bool:
    """Put a piece in the middle of a room, its length along the room's."""
    if room.height > room.width:
        piece = piece.turned()
    row = (room.row + room.row_end - piece.height) // 2
    col = (room.col + room.col_end - piece.width) // 2
    return floor.put(piece, row, col)


def _rows(
    rng: np.random.Generator, floor: Floor, room: Rect, pieces: Sequence[Piece], aisle: float, keep: float
) -> None:
    """Fill a room with rows of the piece that fills it best, ``aisle`` [m] apart, some left out by chance."""
    gap = floor.cells(aisle)
    plans = []
    for piece in (*pieces, *(piece.turned() for piece in pieces)):
        rows = _spread(room.row, room.row_end, piece.height, gap)
        cols = _spread(room.col, room.col_end, piece.width, gap)
        filled = len(rows) * len(cols) * piece.height * piece.width
        plans.append((filled * rng.uniform(0.8, 1.0), piece, rows, cols))
    _, piece, rows, cols = max(plans, key=lambda plan: plan[0])
    for row in rows:
        for col in cols:
            if rng.random() < keep:
                floor.put(piece, row, col)


def _spread(low: int, high: int, size: int, gap: int) -> list[int]:
    """Return where pieces of ``size`` begin when as many as go in stand evenly between two walls."""
    count = max(0, (high - low - gap) // (size + gap))
    room = high - low - count * size
    return [low + (i + 1) * room // (count + 1) + i * size for i in range(count)]


def _box(cells: WorldScale, deep: float, wide: float) -> Piece:
    """A cupboard, shelf, counter or bench."""
    height, width = cells(deep), cells(wide)
    return Piece(height, width, (Rect(0, 0, height, width),))


def _desk(cells: WorldScale) -> Piece:
    """A desk with its back to the wall and a chair drawn up to it."""
    height, width, chair = cells(0.8), cells(1.6), cells(0.5)
    middle = (width - chair) // 2
    parts = (Rect(0, 0, height, width), Rect(height, middle, height + chair, middle + chair))
    return Piece(height + chair, width, parts)


def _island(cells: WorldScale, pairs: int) -> Piece:
    """Pairs of desks face to face, side by side, with a chair at each."""
    return _seated(cells, deep=1.6, step=1.4, count=pairs)


def _table(cells: WorldScale, seats: int, deep: float) -> Piece:
    """A table with ``seats`` chairs on either long side."""
    return _seated(cells, deep, step=0.8, count=seats)


def _seated(cells: WorldScale, deep: float, step: float, count: int) -> Piece:
    chair, height = cells(0.4), cells(deep)
    width = cells(step * count)
    parts = [Rect(chair, 0, chair + height, width)]
    for i in range(count):
        left = cells(step * (i + 0.5)) - (chair + 1) // 2
        parts.append(Rect(0, left, chair, left + chair))
        parts.append(Rect(chair + height, left, 2 * chair + height, left + chair))
    return Piece(height + 2 * chair, width, tuple(parts))
