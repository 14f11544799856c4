"""Generate an office floor: the default world."""

from __future__ import annotations

import numpy as np

from vedette.kernels.components import largest
from vedette.maps.world import World, standable
from vedette.sim.worlds.floor_plan import FloorPlan, draw_plan
from vedette.sim.worlds.furnishing import furnish
from vedette.sim.worlds.furniture import Floor
from vedette.sim.worlds.size import WorldScale, world_frame

RADIUS = 0.25  # [m] of the disc that reaches every room


def office(
    rng: np.random.Generator, width: float = 30.0, height: float = 20.0, resolution: float = 0.1
) -> World:
    """Return a furnished office floor: corridors, rooms of many sizes, 0.9 m doors, some open-plan areas.

    At least 12 rooms from 250 m2 on. A disc of radius 0.25 m that reaches one room reaches every room and
    every place where it fits at all.

    Args:
        rng: where the variety comes from.
        width: in x [m], 10 to 400.
        height: in y [m], 10 to 400.
        resolution: cell side [m], 0.02 to 0.2.

    Raises:
        InputError: a size out of range, or more than 8000 cells a side.
    """
    frame = world_frame(width, height, resolution)
    cells = WorldScale(resolution)
    plan = draw_plan(rng, frame.rows, frame.cols, cells)
    floor = furnish(rng, plan, cells)
    world = World(frame, floor.solid, "office")
    _clear_ways(world, plan, floor)
    return world


def _clear_ways(world: World, plan: FloorPlan, floor: Floor) -> None:
    """Take furniture away, last come first, wherever a place that has room for the disc is cut off."""
    standing = standable(world, RADIUS)
    reached = largest(standing)
    for area in (*plan.rooms, *plan.corridors):
        inside = [entry for entry in floor.placed if area.holds(entry[0])]
        while inside and (not area.of(reached).any() or (area.of(standing) & ~area.of(reached)).any()):
            floor.remove(*inside.pop())
            standing = standable(world, RADIUS)
            reached = largest(standing)
