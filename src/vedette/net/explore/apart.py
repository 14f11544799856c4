"""Reports of robots that may share no frame, laid out for somebody who does not know the truth.

Of those that are joined, the map of the first one is shown, in its frame, in which places of orders lie that
name no other; and the others where it takes them to be. Whoever is not joined with them is shown beside, on a
part of the plane of its own.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from msgspec import structs

from vedette.align import FramePose
from vedette.maps.transform import Transform
from vedette.net.explore.content import MapContent

GAP = 2.0  # between what robots know that are not joined [m]


def side_by_side(told: Mapping[int, MapContent]) -> tuple[list[MapContent], dict[int, FramePose]]:
    """Return the maps to be shown, moved, and where each robot's frame lies among them."""
    maps, there = list[MapContent](), dict[int, FramePose]()
    right = None
    for leader in sorted(told):
        if leader in there:
            continue
        each = told[leader]
        # whole cells, so that the map lies on the grid of the others
        shift = 0.0 if right is None else each.resolution * np.ceil((right - each.x) / each.resolution)
        right = each.x + shift + each.cols * each.resolution + GAP
        maps.append(structs.replace(each, x=each.x + shift))
        for robot, frame in _joined(leader, each).items():
            if robot in told:
                there.setdefault(robot, FramePose(shift, 0.0, 0.0).after(frame))
    return maps, there


def _joined(robot: int, told: MapContent) -> dict[int, FramePose]:
    """Return where the frames of a robot, and of those that it is joined with, lie in its own."""
    latest = {each.robot: each for each in sorted(told.found.graph)}
    own = latest.get(robot)
    if own is None:
        return {robot: FramePose(0.0, 0.0, 0.0)}
    back = own.there.inverse()
    joined = {k: back.after(each.there) for k, each in latest.items() if each.anchor == own.anchor}
    return {k: _pose_of(there) for k, there in joined.items()}


def _pose_of(there: Transform) -> FramePose:
    return FramePose(there.x / 1000.0, there.y / 1000.0, there.radians)
