"""Generate a cave: winding halls with no straight wall."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.components import components, largest
from vedette.maps.world import World, standable
from vedette.sim.worlds.size import world_frame

_COARSE = 0.5  # side of an automaton's cell [m]
_ROCK = 0.47  # share of rock before the automaton runs
_ROUNDS = 5
_LEAST_HALL = 16  # automaton's cells; smaller hollows are filled
_HALF_PASSAGE = 0.6  # [m]


def cave(
    rng: np.random.Generator, width: float = 30.0, height: float = 20.0, resolution: float = 0.1
) -> World:
    """Return a cave in one piece with passages at least 1.2 m wide, grown by a cellular automaton.

    Args:
        rng: where the variety comes from.
        width: in x [m], 10 to 400.
        height: in y [m], 10 to 400.
        resolution: cell side [m], 0.02 to 0.2.

    Raises:
        InputError: a size out of range, or more than 8000 cells a side.
    """
    frame = world_frame(width, height, resolution)
    coarse = round(height / _COARSE), round(width / _COARSE)
    rock = rng.random(coarse) < _ROCK
    for _ in range(_ROUNDS):
        rock = _rock_around(rock) >= 5
    rock[coarse[0] // 2 - 3 : coarse[0] // 2 + 4, coarse[1] // 2 - 3 : coarse[1] // 2 + 4] = False
    _join_halls(rng, rock)
    rock = _rock_around(rock) >= 5
    rough = World(frame, _enlarge(rock, frame.shape) >= 0.5, "cave")
    return World(frame, _without_narrows(rough), "cave")


def _rock_around(rock: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the number of rock cells in each 3x3 block; outside is rock."""
    padded = np.pad(rock, 1, constant_values=True).astype(np.int64)
    across = padded[:, :-2] + padded[:, 1:-1] + padded[:, 2:]
    count: NDArray[np.int64] = across[:-2] + across[1:-1] + across[2:]
    return count


def _join_halls(rng: np.random.Generator, rock: NDArray[np.bool_]) -> None:
    """Fill the small hollows and dig a winding tunnel from each hall to the largest, in place."""
    labels = components(~rock)
    sizes = np.bincount(labels[labels >= 0], minlength=1)
    rock |= (sizes < _LEAST_HALL)[labels]
    main = int(sizes.argmax())
    for hall in np.flatnonzero(sizes >= _LEAST_HALL):
        if hall != main:
            a, b = _closest(rng, np.argwhere(labels == hall), np.argwhere(labels == main))
            _dig(rng, rock, a, b)


def _closest(
    rng: np.random.Generator, hall: NDArray[np.int64], main: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return a cell of each of two halls, near each other: go to and fro to the nearest from a random one."""
    a = hall[rng.integers(len(hall))]
    for _ in range(3):
        b = main[np.square(main - a).sum(axis=1).argmin()]
        a = hall[np.square(hall - b).sum(axis=1).argmin()]
    return a, b


def _dig(
    rng: np.random.Generator, rock: NDArray[np.bool_], a: NDArray[np.int64], b: NDArray[np.int64]
) -> None:
    """Free a winding tunnel four cells wide from ``a`` to ``b``, in place."""
    at = a.copy()
    limit = np.array(rock.shape) - 3
    while True:
        at = np.clip(at, 1, limit)
        rock[at[0] - 1 : at[0] + 3, at[1] - 1 : at[1] + 3] = False
        left = b - at
        if np.abs(left).max() <= 1:
            return
        axis = int(rng.random() * np.abs(left).sum() >= abs(left[0]))
        at[axis] += np.sign(left[axis])
        if rng.random() < 0.2:
            at[1 - axis] += rng.integers(-1, 2)


def _enlarge(rock: NDArray[np.bool_], shape: tuple[int, int]) -> NDArray[np.float64]:
    """Return the share of rock around each point of a finer grid, between 3x3 means; the rim is rock."""
    share = _rock_around(rock) / 9.0
    share = np.pad(share, 1, constant_values=1.0)
    for axis, size in enumerate(shape):
        old = share.shape[axis] - 2
        place = (np.arange(size) + 0.5) * old / size + 0.5
        low = place.astype(np.int64)
        part = (place - low)[:, None] if axis == 0 else place - low
        share = share.take(low, axis) * (1.0 - part) + share.take(low + 1, axis) * part
    return share


def _without_narrows(rough: World) -> NDArray[np.bool_]:
    """Return the walls when only what a disc 1.2 m wide sweeps in its largest area stays free."""
    centres = largest(standable(rough, _HALF_PASSAGE))
    rows, cols = centres.shape
    radius = _HALF_PASSAGE / rough.frame.resolution - 1e-9
    reach = int(radius + 0.5)  # of the farthest cell that the disc touches
    count = np.cumsum(np.pad(centres, ((reach, reach), (reach + 1, reach))), axis=1, dtype=np.int32)
    solid = np.ones_like(centres)
    for step in range(-reach, reach + 1):
        half = int(np.sqrt(radius**2 - max(abs(step) - 0.5, 0.0) ** 2) + 0.5)
        band = count[reach + step : reach + step + rows]
        solid &= band[:, reach + half + 1 :][:, :cols] == band[:, reach - half :][:, :cols]
    return solid
