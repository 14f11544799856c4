"""``run.mcap`` of an exploration: map, impact, poses, plans, links, and metrics."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from vedette.record.explore import details
from vedette.record.explore.log import ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.markers import LinkMessages
from vedette.record.mcap import McapFile, Medium, Place, stamp_of
from vedette.record.ros import ros_names

OF_KNOWN = ("coverage", "known_fraction", "entropy", "known_m2", "frontiers")  # metrics of known ground
OF_OPEN = ("known_m2", "rate_m2_s", "frontiers")  # where nobody knows how much there is


class ExploreMcapWriter(McapFile[LinkMessages]):
    """Write each snapshot's poses, plans, links, metrics; grids every ``grid_period`` seconds and at the end.

    A context manager, and a ``Sink``. The topics are listed in ``docs/outputs.md``.
    """

    def __init__(self, place: Place | Medium, scene: ExploreScene, grid_period: float = 5.0) -> None:
        """Open the file; ``grid_period`` in simulated seconds."""
        self._scene, self._period = scene, grid_period
        self._next_grids = -math.inf
        self._unwritten: ExploreSnapshot | None = None  # the last one, if its grids are not in the file
        self._names = dict(zip(scene.vehicles, ros_names(scene.vehicles), strict=True))
        self._plans: dict[str, tuple[bytes, tuple[float, float] | None]] = {}
        self._told: dict[str, bytes] = {}  # by topic
        named = {f"robot {name}": ros for name, ros in self._names.items()}
        super().__init__(place, LinkMessages(), {"world": scene.name} | named)

    def update(self, snapshot: ExploreSnapshot) -> None:
        """Write one snapshot."""
        stamp = stamp_of(snapshot)
        team = [(self._names[robot.name], robot) for robot in snapshot.robots]
        self._write_frames(stamp, team)
        for name, robot in team:
            if robot.alive:
                self._write_pose(stamp, name, robot)
        for name, robot in team:
            self._write_state(stamp, name, robot)
            self._write_plan(stamp, name, robot)
            self._write(f"/{name}/driven", stamp, self._ros.number(robot.driven))
            self._write_new(f"/{name}/details", stamp, details.encode(details.RobotDetails.of(robot)))
        self._write_new("/left_out", stamp, details.encode(snapshot.left_out))
        self._write_metrics(stamp, snapshot, OF_OPEN if snapshot.coverage is None else OF_KNOWN)
        if snapshot.links is not None:
            self._write("/links", stamp, self._ros.links(stamp, snapshot))
        if snapshot.t >= self._next_grids:
            self._write_grids(snapshot)
            self._next_grids = snapshot.t + self._period
            self._unwritten = None
        else:
            self._unwritten = _with_own_grids(snapshot)

    def _write_rest(self) -> None:
        """Write the last grids."""
        if self._unwritten is not None:
            self._write_grids(self._unwritten)
            self._unwritten = None

    def _write_plan(self, stamp: int, name: str, robot: RobotSample) -> None:
        """Write a robot's path and goal where they changed."""
        plan = (np.asarray(robot.path, np.float64).tobytes(), robot.goal)
        if self._plans.get(name) != plan:
            self._plans[name] = plan
            self._write(f"/{name}/path", stamp, self._ros.path(stamp, robot.path))
            if robot.goal is not None:
                self._write(f"/{name}/goal", stamp, self._ros.pose(stamp, *robot.goal, 0.0))

    def _write_new(self, topic: str, stamp: int, told: bytes) -> None:
        """Write what is told in JSON, if it has changed."""
        if self._told.get(topic) != told:
            self._told[topic] = told
            self._write(topic, stamp, self._ros.text(told.decode()))

    def _write_grids(self, snapshot: ExploreSnapshot) -> None:
        stamp = stamp_of(snapshot)
        self._write("/map", stamp, self._ros.map_grid(stamp, self._scene.frame, snapshot.classes))
        if snapshot.impact is not None:
            impact = self._ros.share_grid(stamp, self._scene.planning, snapshot.impact)
            self._write("/team_impact", stamp, impact)


def _with_own_grids(snapshot: ExploreSnapshot) -> ExploreSnapshot:
    """Return the snapshot with copies of its grids, which the sender may change."""
    impact = None if snapshot.impact is None else snapshot.impact.copy()
    return replace(snapshot, classes=snapshot.classes.copy(), impact=impact)
