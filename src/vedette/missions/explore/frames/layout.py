"""Components side by side on one plane, farther apart than anybody sees."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from vedette.fusion.link import Key
from vedette.maps.transform import Transform
from vedette.missions.explore.frames.graph import Graph

STEP = 8.0  # rims of components are taken at multiples of it, so that they seldom move [m]
LARGE = 128.0  # components up to this side come first; those of twice as much next, and so on [m]

Box = tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y [m]


class PlacedOnPlane(NamedTuple):
    """Where a contributor's frame lies on the plane, and which component it is of."""

    key: Key
    part: int
    there: Transform  # T_plane_contributor


def laid_out(graph: Graph, boxes: Mapping[Key, Box], gap: float, most: float) -> list[PlacedOnPlane]:
    """Return where contributors lie on one plane: one component after another along x, then in another row.

    The first component's frame is the plane's. Components for which there is no room are left out; large ones
    come last, so that nobody who tells of a boundless map leaves the others no room.

    Args:
        graph: where contributors lie in their components.
        boxes: around what each has seen, its own frame; those without one are left out.
        gap: between what components have seen, at least [m].
        most: half of the plane's side [m].
    """
    laid: list[PlacedOnPlane] = []
    right, low, row = 0.0, 0.0, 0.0
    components = dict[Key, dict[Key, Transform]]()
    for key, placed in sorted(graph.items()):
        if key in boxes:
            components.setdefault(placed.anchor, {})[key] = placed.there
    ranked = sorted((_size(around(members, boxes)), anchor) for anchor, members in components.items())
    for part, (_, anchor) in enumerate(ranked):
        members = components[anchor]
        x0, y0, x1, y1 = around(members, boxes)
        if part == 0:
            x, y = 0.0, 0.0
            right, low, row = x1 + gap, y0, y1 - y0
        else:
            if right + x1 - x0 > most:
                right, low, row = -most, low + row + gap, 0.0
            x, y = right - x0, low - y0
            right, row = right + x1 - x0 + gap, max(row, y1 - y0)
        if max(x + x1, y + y1) > most or min(x + x0, y + y0) < -most:
            continue
        onto = Transform.of(x, y, 0.0)
        laid += [PlacedOnPlane(key, part, onto.after(there)) for key, there in sorted(members.items())]
    return laid


def _size(box: Box) -> int:
    """Return how many times the larger side of a box is twice what is not large."""
    return max(0, math.ceil(math.log2(max(box[2] - box[0], box[3] - box[1]) / LARGE)))


def around(members: Mapping[Key, Transform], boxes: Mapping[Key, Box]) -> Box:
    """Return a box around what some have seen, in a frame that they lie in, at multiples of `STEP`."""
    corners = []
    for key, there in members.items():
        x0, y0, x1, y1 = boxes[key]
        corners += [there.place(x, y) for x in (x0, x1) for y in (y0, y1)]
    xs, ys = zip(*corners, strict=True)
    return (
        STEP * math.floor(min(xs) / STEP),
        STEP * math.floor(min(ys) / STEP),
        STEP * math.ceil(max(xs) / STEP),
        STEP * math.ceil(max(ys) / STEP),
    )
