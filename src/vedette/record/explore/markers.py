"""The team's links as ROS 2 markers, which Foxglove and RViz draw over the map, and back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from vedette.record import palette
from vedette.record.explore.log import ExploreSnapshot, RobotSample
from vedette.record.links import Link
from vedette.record.ros import RosMessages

_COLOUR = palette.unit((0, 114, 178))  # seen on white and on black
_LINE_LIST, _ADD, _DELETE = 5, 0, 2  # visualization_msgs/Marker
_ABOVE = 0.05  # the map [m]
_TREE_WIDTH, _OTHER_WIDTH = 0.08, 0.03  # [m]
_TREE_OPACITY, _OTHER_OPACITY = 1.0, 0.4  # of a link that loses nothing
_FADING = 0.8  # share of the opacity that goes where all is lost


class LinkMessages(RosMessages):
    """Messages of what the record holds, links included."""

    def links(self, stamp: int, snapshot: ExploreSnapshot) -> Any:
        """Return a ``visualization_msgs/MarkerArray`` of two line lists, ``tree`` and ``other``.

        The paler a line, the more is lost on it. A list without lines is deleted.
        """
        links = snapshot.links or ()
        tree = [link for link in links if link.on_tree]
        other = [link for link in links if not link.on_tree]
        lists = [
            self._lines(stamp, snapshot, "tree", tree, _TREE_WIDTH, _TREE_OPACITY),
            self._lines(stamp, snapshot, "other", other, _OTHER_WIDTH, _OTHER_OPACITY),
        ]
        return self._make("visualization_msgs/msg/MarkerArray", lists)

    def _lines(
        self,
        stamp: int,
        snapshot: ExploreSnapshot,
        name: str,
        links: Sequence[Link],
        width: float,
        opacity: float,
    ) -> Any:
        ends = [snapshot.robots[i] for link in links for i in (link.a, link.b)]
        alphas = [opacity * (1.0 - _FADING * link.loss) for link in links for _ in range(2)]
        header, nothing = self._header(stamp), np.empty(0, np.uint8)
        return self._make(
            "visualization_msgs/msg/Marker",
            header,
            name,
            0,  # id
            _LINE_LIST,
            _ADD if links else _DELETE,
            self._pose(0.0, 0.0, 0.0),
            self._make("geometry_msgs/msg/Vector3", width, 0.0, 0.0),
            self._colour(opacity),
            self._make("builtin_interfaces/msg/Duration", 0, 0),  # until the next one
            False,  # frame_locked
            [self._make("geometry_msgs/msg/Point", end.x, end.y, _ABOVE) for end in ends],
            [self._colour(alpha) for alpha in alphas],
            "",
            self._make("sensor_msgs/msg/CompressedImage", header, "", nothing),
            [],
            "",
            "",
            self._make("visualization_msgs/msg/MeshFile", "", nothing),
            False,
        )

    def _colour(self, alpha: float) -> Any:
        return self._make("std_msgs/msg/ColorRGBA", *_COLOUR, alpha)


def links_in(array: Any, robots: Sequence[RobotSample]) -> tuple[Link, ...]:
    """Return the links that a ``visualization_msgs/MarkerArray`` shows between robots where they are."""
    places = {(robot.x, robot.y): i for i, robot in enumerate(robots)}
    links = []
    for marker in array.markers:
        opacity = _TREE_OPACITY if marker.ns == "tree" else _OTHER_OPACITY
        ends = [places.get((point.x, point.y)) for point in marker.points]
        for k in range(0, len(ends) - 1, 2):
            a, b = ends[k], ends[k + 1]
            if a is not None and b is not None:
                loss = (1.0 - marker.colors[k].a / opacity) / _FADING
                links.append(Link(min(a, b), max(a, b), marker.ns == "tree", min(max(loss, 0.0), 1.0)))
    return tuple(links)
