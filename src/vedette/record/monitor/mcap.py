"""``run.mcap`` of monitoring: the field as it is taken to be, poses, plans, and metrics."""

from __future__ import annotations

import numpy as np

from vedette.record.mcap import McapFile, Medium, Place, stamp_of
from vedette.record.monitor.log import MonitorScene, MonitorSnapshot
from vedette.record.ros import RosMessages, ros_names
from vedette.record.scenes import facts_of_scene


class MonitorMcapWriter(McapFile[RosMessages]):
    """Write each snapshot: a context manager, and a ``Sink``; ``docs/outputs.md`` lists the topics."""

    def __init__(self, place: Place | Medium, scene: MonitorScene) -> None:
        """Open the file."""
        self._frame, self._names = scene.frame, ros_names(scene.vehicles)
        pairs = zip(scene.vehicles, self._names, strict=True)
        facts = {"scenario": scene.name} | {f"vehicle {name}": ros for name, ros in pairs}
        super().__init__(place, RosMessages(), facts | facts_of_scene("monitor", scene))

    def update(self, snapshot: MonitorSnapshot) -> None:
        """Write one snapshot."""
        stamp = stamp_of(snapshot)
        vehicles = list(zip(self._names, snapshot.vehicles, strict=True))
        self._write_frames(stamp, vehicles)
        for name, vehicle in vehicles:
            self._write_flight(stamp, name, vehicle)
        self._write_metrics(stamp, snapshot, ("rmse", "entropy", "worst_age", "mean_age"))
        if snapshot.mean is not None:
            low, high = float(snapshot.mean.min()), float(snapshot.mean.max())
            share = (snapshot.mean - low) / max(high - low, 1e-12)
            self._write("/field_low", stamp, self._ros.number(low))
            self._write("/field_high", stamp, self._ros.number(high))
            self._write("/field", stamp, self._ros.share_grid(stamp, self._frame, share.astype(np.float32)))
