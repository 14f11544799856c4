"""Generated worlds by name: the house's, and somebody's own."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from vedette.maps.world import World
from vedette.parts import PartKind, telling
from vedette.sim.worlds.cave import cave
from vedette.sim.worlds.maze import maze
from vedette.sim.worlds.office import office
from vedette.sim.worlds.size import world_frame

WIDTH, HEIGHT, RESOLUTION = 30.0, 20.0, 0.1  # where nobody says otherwise [m]


class Generator(Protocol):
    """Makes worlds from chance: a function of the size in x and y, and of a cell's side [m]."""

    def __call__(
        self, rng: np.random.Generator, width: float = ..., height: float = ..., resolution: float = ..., /
    ) -> World:
        """Return a world."""


GENERATORS: dict[str, Generator] = {"office": office, "cave": cave, "maze": maze}


def _wrong(part: Any) -> str | None:
    return None if callable(part) else f"is {type(part).__name__}, not a function that returns a World"


WORLD: PartKind[Generator] = PartKind("worlds", "kind", GENERATORS, _wrong, "docs/how-to/worlds.md")


def generated(
    kind: str, seed: int, width: float = WIDTH, height: float = HEIGHT, resolution: float = RESOLUTION
) -> World:
    """Return the world of a seed.

    Args:
        kind: its generator: a name, or ``module:NAME``.
        seed: the same gives the same world.
        width, height: in x and y [m].
        resolution: a cell's side [m].

    Raises:
        InputError: there is no such generator, or it makes no world of this size.
    """
    generator, rng = WORLD.find(kind), np.random.default_rng(seed)
    if kind in GENERATORS:
        return generator(rng, width, height, resolution)
    world_frame(width, height, resolution)
    with telling(f"{WORLD.word} {kind}"):
        world = generator(rng, width, height, resolution)
        if not isinstance(world, World):
            raise TypeError(f"gives {type(world).__name__}; a World is asked for")
        if world.solid.all():
            raise ValueError("gives a world without free space")
    return world
