"""``run.mcap`` of a search: the pdf, poses, plans, the truth, and metrics."""

from __future__ import annotations

from math import isfinite

import numpy as np

from vedette.record.mcap import McapFile, Medium, Place, stamp_of
from vedette.record.ros import RosMessages, ros_names
from vedette.record.scenes import facts_of_scene
from vedette.record.search.log import SearchScene, SearchSnapshot

_GRID_PERIOD = 4.0  # of writing the pdf [s]


class SearchMcapWriter(McapFile[RosMessages]):
    """Write each snapshot: a context manager, and a ``Sink``; ``docs/outputs.md`` lists the topics."""

    def __init__(self, place: Place | Medium, scene: SearchScene) -> None:
        """Open the file."""
        self._frame, self._names = scene.frame, ros_names(scene.vehicles)
        self._full: float | None = None  # the probability that is shown as 100
        self._due = 0.0  # when the pdf is written next [s]
        self._unwritten: SearchSnapshot | None = None  # the last one, if its pdf is not in the file
        pairs = zip(scene.vehicles, self._names, strict=True)
        facts = {"scenario": scene.name} | {f"vehicle {name}": ros for name, ros in pairs}
        super().__init__(place, RosMessages(), facts | facts_of_scene("search", scene))

    def update(self, snapshot: SearchSnapshot) -> None:
        """Write one snapshot."""
        stamp = stamp_of(snapshot)
        vehicles = list(zip(self._names, snapshot.vehicles, strict=True))
        self._write_frames(stamp, vehicles)
        for name, vehicle in vehicles:
            self._write_flight(stamp, name, vehicle)
            if vehicle.alive and vehicle.goal is not None:
                self._write(f"/{name}/goal", stamp, self._ros.pose(stamp, *vehicle.goal, 0.0))
        if isfinite(snapshot.target[0]):
            self._write("/target/truth", stamp, self._ros.pose(stamp, *snapshot.target, 0.0))
        left = () if snapshot.outside is None else ("outside",)
        self._write_metrics(stamp, snapshot, ("detection", "entropy", *left))
        self._unwritten = snapshot
        if snapshot.t >= self._due - 1e-9:
            self._due = snapshot.t + _GRID_PERIOD
            self._write_rest()

    def _write_rest(self) -> None:
        """Write the pdf in per cent of the most that a cell had at first; no more than 100."""
        if self._unwritten is None:
            return
        mass, stamp = self._unwritten.mass, stamp_of(self._unwritten)
        if self._full is None:
            self._full = float(mass.max())
            self._write("/pdf_full", stamp, self._ros.number(self._full))
        share = (mass / np.float32(self._full)).astype(np.float32)
        self._write("/pdf", stamp, self._ros.share_grid(stamp, self._frame, share))
        self._unwritten = None
