"""What orders mean to a team: areas to leave alone, areas that come first, whom to believe."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from vedette.agent.orders import Exclude, LookThere, NoGo, OrderBook, Priority, Reinstate
from vedette.maps import GridFrame
from vedette.maps.area import Area

LOOK_RADIUS, LOOK_FACTOR = 1.5, 20.0  # of a place that the team is to look at [m], and what it is worth
SIDES = 8  # of the polygon that stands for such a place


def no_go_areas(book: OrderBook) -> tuple[Area, ...]:
    """Return the areas where nobody may go."""
    return tuple(Area(order.corners) for order in book.all_of(NoGo))


def priority_areas(book: OrderBook) -> list[tuple[Area, float]]:
    """Return the areas that come first, and how many times as much all in them is worth."""
    areas = [(Area(order.corners), order.factor) for order in book.all_of(Priority)]
    places = [_around(*order.at) for order in book.all_of(LookThere) if order.robot is None]
    return [*areas, *((place, LOOK_FACTOR) for place in places)]


def cells_in(area: Area, frame: GridFrame) -> NDArray[np.bool_]:
    """Return ``(R, C)`` the cells whose middle is in an area; of one too small, the cell about its own."""
    inside = area.holds(frame)
    if not inside.any():
        x, y = np.mean(area.corners, axis=0).tolist()
        if frame.contains(x, y):
            inside[frame.cell(x, y)] = True
    return inside


def trusted(book: OrderBook) -> tuple[frozenset[int], frozenset[int]]:
    """Return the robots, by index, not to believe whatever they agree with, and to believe whatever not."""
    out = frozenset(order.robot - 1 for order in book.all_of(Exclude))
    return out, frozenset(order.robot - 1 for order in book.all_of(Reinstate))


def _around(x: float, y: float) -> Area:
    """Return a polygon about a place."""
    turns = [2.0 * pi * k / SIDES for k in range(SIDES)]
    return Area(tuple((x + LOOK_RADIUS * cos(turn), y + LOOK_RADIUS * sin(turn)) for turn in turns))
