"""What a robot's agent shows to those who use its ROS: the team's map, its own plan, its condition."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent
from vedette.domains.mapping.belief import planning_factor
from vedette.domains.mapping.impact import Impact, final_miss, moved
from vedette.maps import GridFrame
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.frames.exploring import FramedExploring
from vedette.missions.explore.frames.shared import SharedFrames
from vedette.record.ros import RosMessages
from vedette.ros2.body import Ros2Body
from vedette.ros2.door import Notice
from vedette.ros2.transforms import place

TEAM_FRAME = "team"
PERIOD = 1.0  # of what is shown, at least [s]
GRID_PERIOD = 3.0  # of grids, which are shown when they have changed [s]
POINT_SIZE, TEXT_SIZE = 0.15, 0.4  # of frontiers' marks and of names [m]
_POINTS, _TEXT = 8, 9  # visualization_msgs/Marker
_COLOUR = (0.0, 0.45, 0.7, 1.0)  # seen on white and on black
_OK, _WARN = b"\x00", b"\x01"  # diagnostic_msgs/DiagnosticStatus


class ShowingMessages(RosMessages):
    """Messages for RViz and for who watches over robots."""

    def marker(self, stamp: int, name: str, number: int, points: NDArray[np.float64], text: str = "") -> Any:
        """Return a ``visualization_msgs/Marker``: ``(k, 2)`` points [m], or a text at the only one."""
        x, y = points[0].tolist() if text else (0.0, 0.0)
        size = TEXT_SIZE if text else POINT_SIZE
        header, nothing = self._header(stamp), np.empty(0, np.uint8)
        return self._make(
            "visualization_msgs/msg/Marker",
            header,
            name,
            number,
            _TEXT if text else _POINTS,
            0,  # add or replace
            self._pose(x, y, 0.0),
            self._make("geometry_msgs/msg/Vector3", size, size, size),
            self._make("std_msgs/msg/ColorRGBA", *_COLOUR),
            self._make("builtin_interfaces/msg/Duration", 5, 0),  # then it is gone
            False,  # frame_locked
            [] if text else [self._make("geometry_msgs/msg/Point", *at, 0.0) for at in points.tolist()],
            [],
            "",
            self._make("sensor_msgs/msg/CompressedImage", header, "", nothing),
            [],
            text,
            "",
            self._make("visualization_msgs/msg/MeshFile", "", nothing),
            False,
        )

    def markers(self, markers: Sequence[Any]) -> Any:
        """Return a ``visualization_msgs/MarkerArray``."""
        return self._make("visualization_msgs/msg/MarkerArray", list(markers))

    def diagnosis(self, stamp: int, name: str, worry: str, facts: dict[str, str]) -> Any:
        """Return a ``diagnostic_msgs/DiagnosticArray`` of one thing; ``worry``: what is wrong, or ''."""
        pairs = [self._make("diagnostic_msgs/msg/KeyValue", *pair) for pair in facts.items()]
        level = (_WARN if worry else _OK)[0]
        status = self._make("diagnostic_msgs/msg/DiagnosticStatus", level, name, worry or "ok", name, pairs)
        return self._make("diagnostic_msgs/msg/DiagnosticArray", self._header(stamp), [status])


@dataclass(eq=False)
class Showing:
    """Shows one exploring robot; ``show`` it while its agent is not at work. Times are the mission's [s]."""

    agent: Agent
    body: Ros2Body
    name: str
    _messages: ShowingMessages = field(default_factory=ShowingMessages)
    _anchored: bool = False  # where the team's frame lies was told
    _due: float = 0.0
    _grids_due: float = 0.0
    _news: tuple[int, int] | None = None  # the map and the decision that were shown last

    def __call__(self, now: float) -> None:
        """Show what is due."""
        if now < self._due:
            return
        self._due = now + PERIOD
        if not self._anchored:
            self._anchored = True
            self._anchor()
        stamp = round(1e9 * (self.body.stamp or 0.0))
        for topic, kind, message in (*self._joined(stamp), *self._grids(stamp, now), *self._rest(stamp)):
            self.body.door.show(Notice(topic, kind, self._messages.encode(message)))

    def _anchor(self) -> None:
        """Tell where the team's frame lies in the robot's map, by the names that the robot's TF has.

        Where frames are unknown that is not known yet, and all is shown in the frame of the robot's map.
        """
        settings = self.body.settings
        map_frame = self.body.frame(settings.map_frame)
        if self._framed is not None:
            self._messages.frame_id = map_frame
            return
        self._messages.frame_id = f"{self._prefix}{TEAM_FRAME}"
        at = RosMessages(map_frame)
        joint = at.transforms(0, [(self._messages.frame_id, *place(settings.T_map_team))])
        self.body.door.show(Notice(self._tf("tf_static"), "tf2_msgs/msg/TFMessage", at.encode(joint)))

    @property
    def _prefix(self) -> str:
        """What the robot's frames have before their names."""
        name = self.body.settings.map_frame
        return self.body.frame(name).removesuffix(name)

    def _tf(self, name: str) -> str:
        """Return the topic of TF that the robot's frames are on: all robots', where they are told apart."""
        namespace = "" if self._prefix else self.body.settings.namespace.strip("/")
        return f"/{namespace}/{name}".replace("//", "/")

    @property
    def _framed(self) -> SharedFrames | None:
        """What the robot knows of how frames lie; None: the team has one."""
        mission = self._mission
        return mission.frames if isinstance(mission, FramedExploring) else None

    def _joined(self, stamp: int) -> Iterator[tuple[str, str, Any]]:
        """Yield where the robot's map lies in the team's frame, while it is joined with anybody.

        It holds until the next is due, so it is dated ahead, as a localiser's is. Of several components each
        has a frame of its own name: nobody knows how they lie.
        """
        joined = None if self._framed is None else self._framed.joined
        if self._framed is None or joined is None:
            return
        (robot, boot), there = joined.anchor, joined.there
        first = robot == 0 and joined.anchor == min(self._framed.graph)
        at = RosMessages(TEAM_FRAME if first else f"{TEAM_FRAME}_{robot + 1}_{boot}")
        pose = there.x / 1000.0, there.y / 1000.0, there.radians
        ahead = stamp + round(1e9 * PERIOD)
        yield (
            self._tf("tf"),
            "tf2_msgs/msg/TFMessage",
            at.transforms(ahead, [(self._messages.frame_id, *pose)]),
        )

    @property
    def _mission(self) -> Exploring:
        return cast(Exploring, self.agent.mission)

    def _grids(self, stamp: int, now: float) -> Iterator[tuple[str, str, Any]]:
        """Yield the team's map, and what will be seen of it: by this robot, by all; where that is news."""
        mission, rounds = self._mission, self.agent.rounds
        news = mission.fusion.digest, rounds.decisions
        if now < self._grids_due or news == self._news:
            return
        self._grids_due, self._news = now + GRID_PERIOD, news
        known = mission.known
        frame = mission.frame.window(*known)
        if not frame.size:
            return
        classes = mission.fusion.classes.window(*known)
        yield "team_map", "nav_msgs/msg/OccupancyGrid", self._messages.map_grid(stamp, frame, classes)
        factor = planning_factor(mission.frame.resolution)
        whole, part = mission.frame.coarse(factor), frame.coarse(factor)
        for topic, impact in (("impact", rounds.impact), ("team_impact", rounds.team_impact)):
            share = None if impact is None else self._share(impact, whole, part)
            if share is not None:
                yield topic, "nav_msgs/msg/OccupancyGrid", self._messages.share_grid(stamp, part, share)

    def _share(self, impact: Impact, whole: GridFrame, part: GridFrame) -> NDArray[np.float32] | None:
        """Return how surely each of a part's planning cells ``(R, C)`` will be seen; None: nobody knows.

        Where frames are unknown impacts are of the plane of a round, and the part is of the robot's own map.
        """
        if self._framed is None:
            return 1.0 - final_miss(moved(impact, whole, part), part.size).reshape(part.shape)
        there = self._framed.plane.get(self._framed.key)
        if there is None:
            return None
        seen = 1.0 - final_miss(impact, whole.size)
        places = there.places(part.centres(np.arange(part.size)))
        inside = whole.holds(places)
        col, row = (
            np.floor((places[inside] - (whole.origin_x, whole.origin_y)) / whole.resolution).astype(int).T
        )
        share = np.zeros(part.size, np.float32)
        share[inside] = seen[row * whole.cols + col]
        return share.reshape(part.shape)

    def _rest(self, stamp: int) -> Iterator[tuple[str, str, Any]]:
        """Yield the robot's tour, its frontiers and mates, its condition."""
        mission, pose = self._mission, self.body.pose
        tour = np.vstack((np.array(pose[:2]), mission.strategy.views))
        yield "tour", "nav_msgs/msg/Path", self._messages.path(stamp, tour)
        marks = [self._messages.marker(stamp, "frontiers", 0, mission.platform.considered)]
        marks += [
            self._messages.marker(
                stamp, "names", mate.robot, np.array(((mate.x, mate.y),)), f"robot-{mate.robot + 1}"
            )
            for mate in self.agent.mates.all()
        ]
        yield "markers", "visualization_msgs/msg/MarkerArray", self._messages.markers(marks)
        diagnosis = self._messages.diagnosis(stamp, self.name, self.body.worry, self._facts)
        yield "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", diagnosis

    @property
    def _facts(self) -> dict[str, str]:
        rounds = self.agent.rounds
        return {
            "state": self.agent.state.value,
            "rounds": str(rounds.decisions),
            "robots on the tree": str(rounds.tree.size),
            "way [m]": f"{self.body.figures.travelled:.1f}",
            "scans without transforms": str(self.body.left_out),
        }


def showing(body: Ros2Body, name: str) -> Callable[[Agent], Callable[[float], None]]:
    """Return what shows an agent in this body."""
    return lambda agent: Showing(agent, body, name)
