"""Reports of robots that may share no frame, laid out for somebody who does not know the truth.

Of those that are joined, the map of the first one is shown, in its frame, and the others where it takes them
to be. Whoever is not joined with them is shown beside, on a part of the plane of its own. An order from the
picture carries the frame of the robot whose map is drawn where its place is.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import inf

import numpy as np
from msgspec import structs

from vedette.agent.orders import PLACES, Order, moved
from vedette.align import FramePose
from vedette.maps.transform import Transform
from vedette.net.explore.content import MapContent

GAP = 2.0  # between what robots know that are not joined [m]


@dataclass(frozen=True)
class _Part:
    """Ground that one robot's map is drawn on."""

    leader: int  # that robot, by its index
    left: float  # where it begins [m]
    shift: float  # to the right, from where it is in the robot's frame [m]


@dataclass(frozen=True)
class Apart:
    """Components side by side."""

    maps: list[MapContent]  # to be shown, moved
    there: dict[int, FramePose]  # where each robot's frame lies among them
    parts: list[_Part]  # from the left

    @classmethod
    def of(cls, told: Mapping[int, MapContent]) -> Apart:
        """Lay out what robots, by their indices, have told."""
        apart = cls([], {}, [])
        right = None
        for leader in sorted(told):
            if leader in apart.there:
                continue
            each = told[leader]
            # whole cells, so that the map lies on the grid of the others
            shift = 0.0 if right is None else each.resolution * np.ceil((right - each.x) / each.resolution)
            left = -inf if right is None else right - GAP / 2.0
            right = each.x + shift + each.cols * each.resolution + GAP
            apart.maps.append(structs.replace(each, x=each.x + shift))
            apart.parts.append(_Part(leader, left, float(shift)))
            for robot, frame in _joined(leader, each).items():
                apart.there.setdefault(robot, FramePose(shift, 0.0, 0.0).after(frame))
        return apart

    def as_drawn(self, order: Order) -> Order:
        """Return an order whose place is taken from the picture as it lies in the frame that is drawn there.

        An order that names a frame is meant so. An area is on the part that its middle is on.
        """
        if order.in_frame_of is None or getattr(order, "frame", None) is not None:
            return order
        places = next(place for name in PLACES if (place := getattr(order, name, None)) is not None)
        middle = float(np.mean(np.reshape(places, (-1, 2))[:, 0]))
        part = max((each for each in self.parts if each.left <= middle), key=lambda each: each.left)
        return structs.replace(moved(order, Transform.of(-part.shift, 0.0, 0.0)), frame=part.leader + 1)


def orders_drawn(orders: Iterable[Order], there: Mapping[int, FramePose]) -> tuple[Order, ...]:
    """Return orders with their places as drawn, without those of frames that nobody who is heard knows."""
    drawn = list[Order]()
    for order in orders:
        of = order.in_frame_of
        if of is None:
            drawn.append(order)
        elif of in there:
            drawn.append(moved(order, Transform.of(there[of].x, there[of].y, there[of].angle)))
    return tuple(drawn)


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
