"""Where the robots of a run start."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.kernels.distance import distance_field
from vedette.maps.world import World, standable
from vedette.number import many
from vedette.sim.indoors import indoors
from vedette.team import PlatformSpec

_TRIES = 8  # places that a robot is offered, of which it takes the one farthest from those before it
_AT_EASE = 0.3  # [m] room around a start, if the world has any such place
_GAP = 0.1  # [m] least gap between two robots


def team(platform: PlatformSpec, robots: int) -> list[PlatformSpec]:
    """Return a team of equal robots that will start together."""
    return [replace(platform, name=f"robot-{number}") for number in range(1, robots + 1)]


def spread(world: World, specs: Sequence[PlatformSpec], rng: np.random.Generator) -> list[PlatformSpec]:
    """Return the team with starts apart: random places, each the farthest by path of a few from the others.

    The first is anywhere; all are indoors, where the largest robot can stand.

    Raises:
        InputError: the team does not fit.
    """
    radius = max(spec.radius for spec in specs)
    area = indoors(world, radius)
    roomy = area & standable(world, radius + _AT_EASE)
    places = np.flatnonzero(roomy if roomy.any() else area)
    if not places.size:
        raise InputError(
            f"nowhere in {world.name} does a disc of radius {radius:g} m fit; use smaller robots"
        )
    away = np.full(world.frame.size, np.inf)  # from the nearest start so far, by path [m]
    starts = []
    for _ in specs:
        offered = rng.choice(places, _TRIES)
        cell = int(offered[away[offered].argmax()])
        if away[cell] < 2 * radius + _GAP:
            raise InputError(f"{many(len(specs), 'robot')} cannot start apart in {world.name}; use fewer")
        starts.append(_place(world, cell, rng))
        away = np.minimum(away, _distances(world, area, cell))
    return [replace(spec, start=start) for spec, start in zip(specs, starts, strict=True)]


def _place(world: World, cell: int, rng: np.random.Generator) -> tuple[float, ...]:
    """Return x, y and a random heading [m, m, deg] at a cell's centre."""
    x, y = world.frame.centres(np.array([cell]))[0].tolist()
    return x, y, math.degrees(rng.uniform(-math.pi, math.pi))


def _distances(world: World, area: NDArray[np.bool_], cell: int) -> NDArray[np.float64]:
    return distance_field(area, cell, world.frame.resolution).ravel().astype(np.float64)
