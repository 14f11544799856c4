"""Draw the plan of an office floor: corridors, rooms and doors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vedette.sim.worlds.rect import Rect
from vedette.sim.worlds.size import WorldScale

DOOR = 0.9  # [m]
_OUTER, _MAIN, _PARTITION = 0.2, 0.2, 0.1  # thickness of walls [m]
_SIDE = 2.5  # least side of a room [m]
_DEEP = 11.0  # a block with no side below this gets a corridor of its own [m]
_ROOMS = 12  # at least, where the area allows
OPEN_PLAN = 38.0  # from this area on a room is open-plan [m2]


@dataclass(frozen=True)
class FloorPlan:
    """An office floor; what is in none of the lists is wall."""

    rows: int
    cols: int
    corridors: list[Rect]
    rooms: list[Rect]
    doors: list[Rect]  # 0.9 m wide, through the wall
    openings: list[Rect]  # wider, without a door

    def solid(self) -> np.ndarray[tuple[int, int], np.dtype[np.bool_]]:
        """Return the walls, ``bool[rows, cols]``."""
        grid = np.ones((self.rows, self.cols), np.bool_)
        for rect in (*self.corridors, *self.rooms, *self.doors, *self.openings):
            rect.of(grid)[...] = False
        return grid


Blocks = tuple[list[Rect], list[Rect]]  # corridors, and what lies between them


def draw_plan(rng: np.random.Generator, rows: int, cols: int, cells: WorldScale) -> FloorPlan:
    """Return a random floor: a corridor layout, rooms of many sizes along it, a way into every room."""
    outer = cells(_OUTER)
    inside = Rect(outer, outer, rows - outer, cols - outer)
    corridors, blocks = _layout(rng, inside, cells)
    extra, blocks = _serve_deep_blocks(rng, corridors, blocks, cells)
    corridors += extra
    rooms = [room for block in blocks for room in _rooms(rng, block, cells)]
    _split_to(rng, rooms, _ROOMS, cells)
    joints = [
        wall for i, a in enumerate(corridors) for b in corridors[:i] if (wall := a.between(b, cells(_MAIN)))
    ]
    rooms, doors, openings = _connect(rng, corridors, rooms, cells)
    return FloorPlan(rows, cols, corridors, rooms, doors, openings + joints)


def _layout(rng: np.random.Generator, inside: Rect, cells: WorldScale) -> Blocks:
    """Choose one of the corridor layouts that the size allows."""
    short, long = sorted((inside.height, inside.width))
    layouts: list[Callable[[np.random.Generator, Rect, WorldScale], Blocks]] = [_spine]
    if short >= cells(12.0) and long >= cells(16.0):
        layouts += [_cross]
    if short >= cells(15.5) and long >= cells(20.0):
        layouts += [_double, _ring]
    layout = layouts[rng.integers(len(layouts))]
    if inside.width >= inside.height:
        return layout(rng, inside, cells)
    corridors, blocks = layout(rng, inside.turned(), cells)
    return [rect.turned() for rect in corridors], [rect.turned() for rect in blocks]


def _corridor(
    rng: np.random.Generator, rect: Rect, at: float, rows: bool, cells: WorldScale
) -> tuple[Rect, Rect, Rect]:
    """Return what lies before a corridor across ``rect``, the corridor, and what lies after.

    It runs along the columns where ``rows`` (it cuts the rows in two); ``at`` is its place from 0 to 1.
    """
    wall, width = cells(_MAIN), cells(rng.uniform(1.5, 2.3))
    if not rows:
        before, corridor, after = _corridor(rng, rect.turned(), at, True, cells)
        return before.turned(), corridor.turned(), after.turned()
    start = rect.row + round(at * rect.height) - width // 2
    before, rest = rect.cut(start - wall, wall, rows=True)
    corridor, after = rest.cut(start + width, wall, rows=True)
    return before, corridor, after


def _spine(rng: np.random.Generator, inside: Rect, cells: WorldScale) -> Blocks:
    low, spine, high = _corridor(rng, inside, rng.uniform(0.38, 0.62), True, cells)
    return [spine], [low, high]


def _cross(rng: np.random.Generator, inside: Rect, cells: WorldScale) -> Blocks:
    low, spine, high = _corridor(rng, inside, rng.uniform(0.4, 0.6), True, cells)
    corridors, blocks = [spine], []
    at = rng.uniform(0.3, 0.7)
    for part in (low, high):
        left, branch, right = _corridor(rng, part, at, False, cells)
        corridors.append(branch)
        blocks += [left, right]
        if rng.random() < 0.3:
            at = rng.uniform(0.3, 0.7)  # the branches need not face each other
    return corridors, blocks


def _double(rng: np.random.Generator, inside: Rect, cells: WorldScale) -> Blocks:
    low, first, rest = _corridor(rng, inside, rng.uniform(0.26, 0.32), True, cells)
    core, second, high = _corridor(rng, rest, rng.uniform(0.5, 0.58), True, cells)
    left, link, right = _corridor(rng, core, rng.uniform(0.2, 0.4), False, cells)
    middle, other, right = _corridor(rng, right, rng.uniform(0.45, 0.65), False, cells)
    return [first, second, link, other], [low, high, left, middle, right]


def _ring(rng: np.random.Generator, inside: Rect, cells: WorldScale) -> Blocks:
    depth = min(rng.uniform(4.5, 5.6) / cells.resolution, 0.33 * inside.height)  # of the corridors' middle
    low, first, rest = _corridor(rng, inside, depth / inside.height, True, cells)
    belt, second, high = _corridor(rng, rest, 1.0 - depth / rest.height, True, cells)
    left, third, rest = _corridor(rng, belt, depth / belt.width, False, cells)
    core, fourth, right = _corridor(rng, rest, 1.0 - depth / rest.width, False, cells)
    return [first, second, third, fourth], [low, high, left, core, right]


def _serve_deep_blocks(
    rng: np.random.Generator, corridors: list[Rect], blocks: list[Rect], cells: WorldScale
) -> Blocks:
    """Cut blocks that are deep both ways by more corridors, each of which meets one that is there."""
    extra: list[Rect] = []
    done: list[Rect] = []
    waiting = list(blocks)
    while waiting:
        block = waiting.pop()
        if min(block.height, block.width) <= cells(_DEEP):
            done.append(block)
            continue
        meets = [wall for c in corridors + extra if (wall := block.between(c, cells(_MAIN)))]
        rows = max(meets, key=lambda wall: wall.area).height > cells(
            _MAIN
        )  # a side wall: run along the columns
        low, corridor, high = _corridor(rng, block, rng.uniform(0.4, 0.6), rows, cells)
        extra.append(corridor)
        waiting += [low, high]
    return extra, done


def _rooms(rng: np.random.Generator, block: Rect, cells: WorldScale) -> list[Rect]:
    """Slice a block across its length into strips of many widths, deep ones again into two or three."""
    if block.height > block.width:
        return [room.turned() for room in _rooms(rng, block.turned(), cells)]
    rooms = []
    rest: Rect | None = block
    while rest is not None:
        width = cells(
            rng.choice(
                [rng.uniform(2.6, 3.6), rng.uniform(3.6, 5.0), rng.uniform(6.0, 8.5)], p=[0.4, 0.4, 0.2]
            )
        )
        if rest.width - width < cells(_SIDE) + cells(_PARTITION):
            strip, rest = rest, None
        else:
            strip, rest = rest.cut(rest.col + width, cells(_PARTITION), rows=False)
        rooms += _split_strip(rng, strip, cells)
    return rooms


def _split_strip(rng: np.random.Generator, strip: Rect, cells: WorldScale) -> list[Rect]:
    wall = cells(_PARTITION)
    if strip.height < 2 * cells(_SIDE) + wall:
        return [strip]
    if strip.width >= cells(4.5) and strip.height <= 2 * strip.width and rng.random() < 0.6:
        return [strip]  # a large room
    at = strip.row + round(rng.uniform(0.36, 0.64) * strip.height)
    at = int(np.clip(at, strip.row + cells(_SIDE), strip.row_end - cells(_SIDE) - wall))
    return [room for part in strip.cut(at, wall, rows=True) for room in _halve_long(rng, part, cells)]


def _halve_long(rng: np.random.Generator, room: Rect, cells: WorldScale) -> list[Rect]:
    rows = room.height >= room.width
    long, short = max(room.height, room.width), min(room.height, room.width)
    if long <= 2.2 * short or long < 2 * cells(_SIDE) + cells(_PARTITION):
        return [room]
    start = room.row if rows else room.col
    return list(room.cut(start + round(rng.uniform(0.42, 0.58) * long), cells(_PARTITION), rows))


def _split_to(rng: np.random.Generator, rooms: list[Rect], count: int, cells: WorldScale) -> None:
    """Halve the longest rooms until there are ``count``, as far as they can be halved."""
    while len(rooms) < count:
        room = max(rooms, key=lambda rect: max(rect.height, rect.width))
        rows = room.height >= room.width
        long = max(room.height, room.width)
        if long < 2 * cells(_SIDE) + cells(_PARTITION):
            return
        rooms.remove(room)
        rooms += room.cut((room.row if rows else room.col) + long // 2, cells(_PARTITION), rows)


def _connect(
    rng: np.random.Generator, corridors: list[Rect], rooms: list[Rect], cells: WorldScale
) -> tuple[list[Rect], list[Rect], list[Rect]]:
    """Give each room on a corridor a door to it, each other one a way through a neighbour, and some a second.

    Returns the rooms with a way in, the doors, and the wider openings.
    """
    reached: list[Rect] = []
    gaps: list[Rect] = []
    for room in rooms:
        walls = _walls(room, corridors, cells)
        if walls:
            reached.append(room)
            chosen = walls[rng.integers(len(walls))]
            open_plan = room.area * cells.resolution**2 >= OPEN_PLAN and rng.random() < 0.6
            gaps.append(_gap(rng, chosen, rng.uniform(1.6, 3.0) if open_plan else DOOR, cells))
    waiting = [room for room in rooms if room not in reached]
    while ways := [(room, wall) for room in waiting for wall in _walls(room, reached, cells)]:
        room, wall = ways[rng.integers(len(ways))]
        gaps.append(_gap(rng, wall, rng.uniform(1.2, 2.2) if rng.random() < 0.25 else DOOR, cells))
        reached.append(room)
        waiting.remove(room)
    for i, room in enumerate(reached):
        for wall in _walls(room, reached[:i], cells):
            if rng.random() < 0.1 and not any(_meet(wall, gap) for gap in gaps):
                gaps.append(_gap(rng, wall, rng.uniform(1.2, 2.2) if rng.random() < 0.4 else DOOR, cells))
    wide = [gap for gap in gaps if max(gap.height, gap.width) != cells(DOOR)]
    return reached, [gap for gap in gaps if gap not in wide], wide


def _walls(room: Rect, others: list[Rect], cells: WorldScale) -> list[Rect]:
    """Return the walls that a room shares with others and that are long enough for a door."""
    walls = (room.between(other, cells(_MAIN)) for other in others)
    return [wall for wall in walls if wall and max(wall.height, wall.width) >= cells(DOOR) + 2 * cells(0.2)]


def _gap(rng: np.random.Generator, wall: Rect, metres: float, cells: WorldScale) -> Rect:
    """Return a gap through a wall, at most as wide as it allows; doors are mostly near an end of it."""
    if wall.height < wall.width:
        return _gap(rng, wall.turned(), metres, cells).turned()
    width = min(cells(metres), wall.height - 2 * cells(0.2))
    low, high = wall.row + cells(0.2), wall.row_end - cells(0.2) - width
    row = int(rng.choice(np.array([low, high, rng.integers(low, high + 1)]), p=[0.35, 0.35, 0.3]))
    return Rect(row, wall.col, row + width, wall.col_end)


def _meet(a: Rect, b: Rect) -> bool:
    return a.row < b.row_end and b.row < a.row_end and a.col < b.col_end and b.col < a.col_end
