"""Places that look alike in parts: equal rooms, racks, a corridor, and buildings symmetric about a point."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.maps import GridFrame
from vedette.maps.world import World

SIDE = 0.1  # of a cell [m]


def hotel(rng: np.random.Generator) -> World:
    """Equal rooms on both sides of a corridor, with equal doors."""
    room, depth, count = rng.integers(28, 45), rng.integers(30, 50), rng.integers(7, 12)
    hall, door = rng.integers(14, 22), rng.integers(9, 12)
    rows, cols = int(2 * depth + hall + 4), int(count * room + 1)
    solid = np.zeros((rows, cols), np.bool_)
    for row in (0, depth + 1, depth + hall + 2, rows - 1):
        solid[row] = True
    for left in range(0, cols, room):
        solid[: depth + 2, left] = solid[depth + hall + 2 :, left] = True
        if left + room < cols:
            at = left + room // 3
            solid[[depth + 1, depth + hall + 2], at : at + door] = False
    solid[:, [0, -1]] = True
    return _world(solid, "hotel")


def racks(rng: np.random.Generator) -> World:
    """A hall of equal racks with aisles between them."""
    long, thick, aisle = rng.integers(60, 100), rng.integers(8, 13), rng.integers(18, 28)
    across, along = rng.integers(4, 7), rng.integers(2, 4)
    rows, cols = across * (thick + aisle) + aisle, along * (long + aisle) + aisle
    solid = np.zeros((rows, cols), np.bool_)
    for top in range(aisle, rows - thick, thick + aisle):
        for left in range(aisle, cols - long, long + aisle):
            solid[top : top + thick, left : left + long] = True
    solid[[0, -1]] = solid[:, [0, -1]] = True
    return _world(solid, "racks")


def corridor(rng: np.random.Generator) -> World:
    """A corridor of 60 to 100 m with equal niches."""
    length, wide, step = rng.integers(600, 1000), rng.integers(16, 26), rng.integers(40, 90)
    solid = np.ones((wide + 12, length), np.bool_)
    solid[6 : 6 + wide, 1:-1] = False
    for left in range(20, length - 20, step):
        solid[3:6, left : left + 12] = False
    return _world(solid, "corridor")


def symmetric(world: World) -> World:
    """A building and the same turned by half a turn beside it, with the wall between them open."""
    seam = world.solid[:, -6:].copy()
    half = world.solid.copy()
    open_rows = ~half[:, -14:-6].any(axis=1)
    seam[open_rows] = False
    half[:, -6:] = seam
    return _world(np.hstack([half, half[::-1, ::-1]]), f"symmetric {world.name}")


def _world(solid: NDArray[np.bool_], name: str) -> World:
    return World(GridFrame(SIDE, *solid.shape), solid, name)
