"""``run.mcap``: the mission as ROS 2 messages, for Foxglove, RViz and ``ros2 bag play``.

The file grows under a temporary name while the mission runs and moves into place on `close`, whatever
ended the mission. Stamps are simulated time from 0 s: the same mission gives the same bytes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from types import TracebackType

import numpy as np

from vedette.maps import GridFrame
from vedette.record.explore.log import ExploreSnapshot, RobotSample
from vedette.record.explore.markers import LinkMessages
from vedette.record.ros import ros_names
from vedette.record.topics import Place, Topics, atomic_stream


class ExploreMcapWriter:
    """Write each snapshot's poses, plans, links, metrics; grids every ``grid_period`` seconds and at the end.

    A context manager, and a `vedette.record.explore.log.Sink`. The topics are listed in ``docs/outputs.md``.
    """

    def __init__(
        self,
        place: Place,
        world: str,
        frame: GridFrame,
        planning: GridFrame,
        robots: Sequence[str],
        grid_period: float = 5.0,
    ) -> None:
        """Open the file for the named robots; ``grid_period`` in simulated seconds."""
        self._frame = frame
        self._planning = planning
        self._period = grid_period
        self._next_grids = -math.inf
        self._unwritten: ExploreSnapshot | None = None  # the last one, if its grids are not in the file
        self._names = dict(zip(robots, ros_names(robots), strict=True))
        self._plans: dict[str, tuple[bytes, tuple[float, float] | None]] = {}
        self._states: dict[str, str] = {}
        self._ros = LinkMessages()
        self._closed = False
        self._files = ExitStack()
        stream = self._files.enter_context(atomic_stream(place))
        self._topics = Topics(stream, self._ros)
        self._topics.describe({"world": world} | {f"robot {name}": ros for name, ros in self._names.items()})

    def update(self, snapshot: ExploreSnapshot) -> None:
        """Write one snapshot."""
        stamp = _stamp(snapshot)
        alive = [robot for robot in snapshot.robots if robot.alive]
        frames = [
            (f"{self._names[robot.name]}/base_link", robot.x, robot.y, robot.heading) for robot in alive
        ]
        self._topics.write("/tf", stamp, self._ros.transforms(stamp, frames))
        for robot in alive:
            pose = self._ros.pose(stamp, robot.x, robot.y, robot.heading)
            self._topics.write(f"/{self._names[robot.name]}/pose", stamp, pose)
        for robot in snapshot.robots:
            self._write_intent(stamp, robot)
        for metric in ("coverage", "known_fraction", "entropy"):
            self._topics.write(f"/metrics/{metric}", stamp, self._ros.number(getattr(snapshot, metric)))
        if snapshot.links is not None:
            self._topics.write("/links", stamp, self._ros.links(stamp, snapshot))
        if snapshot.t >= self._next_grids:
            self._write_grids(snapshot)
            self._next_grids = snapshot.t + self._period
            self._unwritten = None
        else:
            self._unwritten = _with_own_grids(snapshot)

    def close(self) -> None:
        """Write the last grids and the index, and move the file into place; a second call does nothing."""
        if self._closed:
            return
        self._closed = True
        with self._files:
            if self._unwritten is not None:
                self._write_grids(self._unwritten)
                self._unwritten = None
            self._topics.finish()

    def __enter__(self) -> ExploreMcapWriter:
        """Return the writer."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close, after an interruption too: what was recorded until then is valid."""
        self.close()

    def _write_intent(self, stamp: int, robot: RobotSample) -> None:
        """Write a robot's state, path and goal where they changed."""
        name = self._names[robot.name]
        if self._states.get(name) != robot.state:
            self._states[name] = robot.state
            self._topics.write(f"/{name}/state", stamp, self._ros.text(robot.state))
        plan = (np.asarray(robot.path, np.float64).tobytes(), robot.goal)
        if self._plans.get(name) != plan:
            self._plans[name] = plan
            self._topics.write(f"/{name}/path", stamp, self._ros.path(stamp, robot.path))
            if robot.goal is not None:
                self._topics.write(f"/{name}/goal", stamp, self._ros.pose(stamp, *robot.goal, 0.0))

    def _write_grids(self, snapshot: ExploreSnapshot) -> None:
        stamp = _stamp(snapshot)
        self._topics.write("/map", stamp, self._ros.map_grid(stamp, self._frame, snapshot.classes))
        if snapshot.impact is not None:
            impact = self._ros.share_grid(stamp, self._planning, snapshot.impact)
            self._topics.write("/team_impact", stamp, impact)


def _stamp(snapshot: ExploreSnapshot) -> int:
    return round(snapshot.t * 1e9)


def _with_own_grids(snapshot: ExploreSnapshot) -> ExploreSnapshot:
    """Return the snapshot with copies of its grids, which the sender may change."""
    impact = None if snapshot.impact is None else snapshot.impact.copy()
    return replace(snapshot, classes=snapshot.classes.copy(), impact=impact)
