"""``run.mcap`` of a tracking mission: poses, plans, tracks with their covariances, the truth, and metrics."""

from __future__ import annotations

from contextlib import ExitStack
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.record.ros import RosMessages, ros_names
from vedette.record.topics import Place, Topics, atomic_stream
from vedette.record.track.log import Scene, TrackSnapshot, VehicleSample


class TrackMessages(RosMessages):
    """The messages of tracking beside those of all missions."""

    def pose_with_covariance(
        self, stamp: int, state: NDArray[np.float64], covariance: NDArray[np.float64]
    ) -> Any:
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


class TrackMcapWriter:
    """Write each snapshot: a context manager, and a ``TrackSink``; ``docs/outputs.md`` lists the topics."""

    def __init__(self, place: Place, scene: Scene) -> None:
        """Open the file."""
        self._vehicles = ros_names(scene.vehicles)
        self._targets = ros_names(scene.targets)
        self._states: dict[str, str] = {}
        self._ros = TrackMessages()
        self._closed = False
        self._files = ExitStack()
        self._topics = Topics(self._files.enter_context(atomic_stream(place)), self._ros)
        pairs = [("vehicle", scene.vehicles, self._vehicles), ("target", scene.targets, self._targets)]
        named = {f"{k} {a}": b for k, names, ros in pairs for a, b in zip(names, ros, strict=True)}
        self._topics.describe({"scenario": scene.name} | named)

    def update(self, snapshot: TrackSnapshot) -> None:
        """Write one snapshot."""
        stamp = round(snapshot.t * 1e9)
        living = [(n, v) for n, v in zip(self._vehicles, snapshot.vehicles, strict=True) if v.alive]
        frames = [(f"{name}/base_link", v.x, v.y, v.heading) for name, v in living]
        self._topics.write("/tf", stamp, self._ros.transforms(stamp, frames))
        for name, vehicle in zip(self._vehicles, snapshot.vehicles, strict=True):
            self._write_vehicle(stamp, name, vehicle)
        for t, name in enumerate(self._targets):
            mean, covariance = snapshot.means[t], snapshot.covariances[t]
            track = self._ros.pose_with_covariance(stamp, mean, covariance)
            self._topics.write(f"/targets/{name}/track", stamp, track)
            x, y, vx, vy = snapshot.truth[t].tolist()
            truth = self._ros.pose(stamp, x, y, float(np.arctan2(vy, vx)))
            self._topics.write(f"/targets/{name}/truth", stamp, truth)
        for metric in ("entropy", "nees", "squared_error"):
            self._topics.write(f"/metrics/{metric}", stamp, self._ros.number(getattr(snapshot, metric)))

    def _write_vehicle(self, stamp: int, name: str, vehicle: VehicleSample) -> None:
        if self._states.get(name) != vehicle.state:
            self._states[name] = vehicle.state
            self._topics.write(f"/{name}/state", stamp, self._ros.text(vehicle.state))
        if vehicle.alive:
            pose = self._ros.pose(stamp, vehicle.x, vehicle.y, vehicle.heading)
            self._topics.write(f"/{name}/pose", stamp, pose)
            self._topics.write(f"/{name}/path", stamp, self._ros.path(stamp, vehicle.path))

    def close(self) -> None:
        """Write the index and move the file into place; a second call does nothing."""
        if not self._closed:
            self._closed = True
            with self._files:
                self._topics.finish()

    def __enter__(self) -> TrackMcapWriter:
        """Return the writer."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close, after an interruption too: what was recorded until then is valid."""
        self.close()
