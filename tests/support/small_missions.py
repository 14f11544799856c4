"""Small worlds and whole missions in them, a second or two each."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.maps import FREE, OCCUPIED, GridFrame, write_map
from vedette.maps.world import World
from vedette.record.explore.observer import ExploreReport
from vedette.record.explore.score import Reference, coverage
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.worlds import maze, office
from vedette.team import PlatformSpec

TWO_ROOMS = """
################
#       #      #
#       #      #
#              #
#              #
#       #      #
################
"""


def plan(world: World, folder: Path) -> Path:
    """Save a world's map as an old one."""
    write_map(folder / "old", world.frame, np.where(world.solid, OCCUPIED, FREE).astype(np.uint8))
    return folder / "old.yaml"


@cache
def small_maze(seed: int = 1) -> World:
    """Ten metres square."""
    return maze(np.random.default_rng(seed), 10.0, 10.0)


@cache
def small_office(seed: int = 1) -> World:
    """Twelve by ten metres."""
    return office(np.random.default_rng(seed), 12.0, 10.0)


def drawn(picture: str, resolution: float = 0.1, scale: int = 5) -> World:
    """A world from a picture: '#' is solid, one character is ``scale`` cells a side."""
    lines = [line for line in picture.splitlines() if line]
    width = max(map(len, lines))
    solid = np.array([[mark == "#" for mark in line.ljust(width, "#")] for line in reversed(lines)])
    solid = solid.repeat(scale, axis=0).repeat(scale, axis=1)
    return World(GridFrame(resolution, *solid.shape), solid, "drawn")


def room_with_a_wall(resolution: float) -> World:
    """Six metres square inside, with a wall of four metres from one side on through its middle."""
    inside, thick = round(6.0 / resolution), max(1, round(0.1 / resolution))
    solid = np.pad(np.zeros((inside, inside), bool), thick, constant_values=True)
    middle = len(solid) // 2
    solid[: thick + round(4.0 / resolution), middle : middle + thick] = True
    return World(GridFrame(resolution, *solid.shape), solid, "room")


def two_rooms(width: float, resolution: float, *, bent: bool = False) -> World:
    """Two rooms of 3 x 3 m, and between them a corridor of 1.5 m, straight or with two bends."""
    room, length, wide, wall = round(3.0 / resolution), round(1.5 / resolution), round(width / resolution), 2
    solid = np.ones((room + 2 * wall, 2 * room + length + 2 * wall), bool)
    solid[wall:-wall, wall : wall + room] = solid[wall:-wall, -wall - room : -wall] = False
    begins, ends, middle = wall + room, wall + room + length, wall + room // 2
    if not bent:
        low = middle - wide // 2
        solid[low : low + wide, begins:ends] = False
        return World(GridFrame(resolution, *solid.shape), solid, "rooms")
    aside, half = round(0.6 / resolution), begins + length // 2
    solid[middle - aside : middle - aside + wide, begins : half + wide] = False
    solid[middle - aside : middle + aside + wide, half : half + wide] = False
    solid[middle + aside : middle + aside + wide, half:ends] = False
    return World(GridFrame(resolution, *solid.shape), solid, "rooms")


def robots(n: int, **fields: Any) -> list[PlatformSpec]:
    """Equal robots."""
    return [PlatformSpec(name=f"robot-{i + 1}", **fields) for i in range(n)]


def run(world: World, specs: Sequence[PlatformSpec], **setup: Any) -> tuple[ExploreSimulation, ExploreReport]:
    """A whole mission, at most 900 s unless the setup says otherwise."""
    simulation = prepare(world, specs, ExploreSetup(**{"max_time": 900.0, **setup}))
    return simulation, explore(simulation)


def begun(seconds: float) -> ExploreSimulation:
    """A team of two that has explored a small office for a while."""
    simulation = prepare(small_office(seed=1), robots(2), ExploreSetup(seed=7))
    while simulation.now < seconds:
        simulation.step()
    return simulation


def covered(
    world: World, specs: Sequence[PlatformSpec], starts: NDArray[np.float64], report: ExploreReport
) -> float:
    """The share known, in truth, of what such a team can see of a world, whatever it knows of its extent."""
    return coverage(Reference(world, specs, starts), report.classes)


def check_complete(report: ExploreReport) -> None:
    """The mission is complete, the map whole and true, nobody touched anything."""
    summary = report.summary
    assert summary.outcome.value == "complete"
    assert summary.completed
    assert summary.coverage is not None
    assert summary.coverage >= 0.995
    assert summary.map_errors == 0
    assert summary.collisions == 0
    assert summary.min_clearance_m > 0.0
