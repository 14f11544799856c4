"""``run.mcap`` of a search: the pdf, poses, plans, the truth, and metrics."""

from __future__ import annotations

from contextlib import ExitStack
from types import TracebackType

import numpy as np

from vedette.record.ros import RosMessages, ros_names
from vedette.record.search.log import Scene, SearchSnapshot, VehicleSample
from vedette.record.topics import Place, Topics, atomic_stream

_GRID_PERIOD = 4.0  # of writing the pdf [s]


class SearchMcapWriter:
    """Write each snapshot: a context manager, and a ``SearchSink``. ``docs/outputs.md`` lists the topics."""

    def __init__(self, place: Place, scene: Scene) -> None:
        """Open the file."""
        self._frame = scene.frame
        self._names = ros_names(scene.vehicles)
        self._states: dict[str, str] = {}
        self._full: float | None = None  # the probability that is shown as 100
        self._due = 0.0  # when the pdf is written next [s]
        self._unwritten: SearchSnapshot | None = None  # the last one, if its pdf is not in the file
        self._ros = RosMessages()
        self._closed = False
        self._files = ExitStack()
        self._topics = Topics(self._files.enter_context(atomic_stream(place)), self._ros)
        pairs = zip(scene.vehicles, self._names, strict=True)
        self._topics.describe({"scenario": scene.name} | {f"vehicle {name}": ros for name, ros in pairs})

    def update(self, snapshot: SearchSnapshot) -> None:
        """Write one snapshot."""
        stamp = _stamp(snapshot)
        vehicles = list(zip(self._names, snapshot.vehicles, strict=True))
        frames = [(f"{name}/base_link", v.x, v.y, v.heading) for name, v in vehicles if v.alive]
        self._topics.write("/tf", stamp, self._ros.transforms(stamp, frames))
        for name, vehicle in vehicles:
            self._write_vehicle(stamp, name, vehicle)
        self._topics.write("/target/truth", stamp, self._ros.pose(stamp, *snapshot.target, 0.0))
        for metric in ("detection", "entropy"):
            self._topics.write(f"/metrics/{metric}", stamp, self._ros.number(getattr(snapshot, metric)))
        self._unwritten = snapshot
        if snapshot.t >= self._due - 1e-9:
            self._due = snapshot.t + _GRID_PERIOD
            self._write_pdf()

    def _write_vehicle(self, stamp: int, name: str, vehicle: VehicleSample) -> None:
        if self._states.get(name) != vehicle.state:
            self._states[name] = vehicle.state
            self._topics.write(f"/{name}/state", stamp, self._ros.text(vehicle.state))
        if vehicle.alive:
            pose = self._ros.pose(stamp, vehicle.x, vehicle.y, vehicle.heading)
            self._topics.write(f"/{name}/pose", stamp, pose)
            self._topics.write(f"/{name}/path", stamp, self._ros.path(stamp, vehicle.path))
            if vehicle.goal is not None:
                self._topics.write(f"/{name}/goal", stamp, self._ros.pose(stamp, *vehicle.goal, 0.0))

    def _write_pdf(self) -> None:
        """Write the pdf in per cent of the most that a cell had at first; no more than 100."""
        if self._unwritten is None:
            return
        mass, stamp = self._unwritten.mass, _stamp(self._unwritten)
        if self._full is None:
            self._full = float(mass.max())
            self._topics.write("/pdf_full", stamp, self._ros.number(self._full))
        share = (mass / np.float32(self._full)).astype(np.float32)
        self._topics.write("/pdf", stamp, self._ros.share_grid(stamp, self._frame, share))
        self._unwritten = None

    def close(self) -> None:
        """Write the last pdf and the index, and move the file into place; a second call does nothing."""
        if not self._closed:
            self._closed = True
            with self._files:
                self._write_pdf()
                self._topics.finish()

    def __enter__(self) -> SearchMcapWriter:
        """Return the writer."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close, after an interruption too: what was recorded until then is valid."""
        self.close()


def _stamp(snapshot: SearchSnapshot) -> int:
    return round(snapshot.t * 1e9)
