"""``run.mcap`` of a tracking mission: poses, plans, tracks with their covariances, the truth, and metrics."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np

from vedette.record.log import Floats
from vedette.record.mcap import McapFile, Medium, Place, stamp_of
from vedette.record.ros import RosMessages, ros_names
from vedette.record.scenes import facts_of_scene
from vedette.record.track.log import TrackScene, TrackSnapshot


class TrackMessages(RosMessages):
    """The messages of tracking beside those of all missions."""

    def pose_with_covariance(self, stamp: int, state: Floats, covariance: Floats) -> Any:
        """Return a ``geometry_msgs/PoseWithCovarianceStamped`` of a state (4,) and its covariance (4, 4).

        The heading is that of the velocity; rotations, of which nothing is known, have variance pi^2 / 3.
        """
        x, y, vx, vy = state.tolist()
        pose = self._pose(x, y, float(np.arctan2(vy, vx)))
        full = np.zeros((6, 6))
        full[:2, :2] = covariance[:2, :2]
        full[[3, 4, 5], [3, 4, 5]] = np.pi**2 / 3.0
        return self._make(
            "geometry_msgs/msg/PoseWithCovarianceStamped",
            self._header(stamp),
            self._make("geometry_msgs/msg/PoseWithCovariance", pose, full.ravel()),
        )


class TrackMcapWriter(McapFile[TrackMessages]):
    """Write each snapshot: a context manager, and a ``Sink``; ``docs/outputs.md`` lists the topics."""

    def __init__(self, place: Place | Medium, scene: TrackScene) -> None:
        """Open the file."""
        self._vehicles, self._targets = ros_names(scene.vehicles), ros_names(scene.targets)
        self._seen: dict[str, tuple[int, ...]] = {}
        pairs = [("vehicle", scene.vehicles, self._vehicles), ("target", scene.targets, self._targets)]
        named = {f"{k} {a}": b for k, names, ros in pairs for a, b in zip(names, ros, strict=True)}
        super().__init__(
            place, TrackMessages(), {"scenario": scene.name} | named | facts_of_scene("track", scene)
        )

    def update(self, snapshot: TrackSnapshot) -> None:
        """Write one snapshot."""
        stamp = stamp_of(snapshot)
        vehicles = list(zip(self._vehicles, snapshot.vehicles, strict=True))
        self._write_frames(stamp, vehicles)
        for name, vehicle in vehicles:
            self._write_flight(stamp, name, vehicle)
            if self._seen.get(name, ()) != vehicle.seen:
                self._seen[name] = vehicle.seen
                self._write(f"/{name}/seen", stamp, self._ros.text(" ".join(map(str, vehicle.seen))))
        for t, name in enumerate(self._targets):
            mean, covariance = snapshot.means[t], snapshot.covariances[t]
            track = self._ros.pose_with_covariance(stamp, mean, covariance)
            self._write(f"/targets/{name}/track", stamp, track)
            x, y, vx, vy = snapshot.truth[t].tolist()
            if isfinite(x):
                truth = self._ros.pose(stamp, x, y, float(np.arctan2(vy, vx)))
                self._write(f"/targets/{name}/truth", stamp, truth)
        self._write_metrics(stamp, snapshot, ("entropy", "nees", "squared_error"))
