"""``run.mcap`` of one robot: where it is, what it does, where it goes, and its map, as it tells of itself."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vedette.maps import GridFrame
from vedette.record.log import VehicleSample
from vedette.record.mcap import McapFile, Place
from vedette.record.ros import RosMessages, ros_names


class RobotRecorder(McapFile[RosMessages]):
    """Writes one robot's samples, and its map whenever there is one; stamps are the mission's time."""

    def __init__(self, place: Place, name: str, facts: Mapping[str, str]) -> None:
        """Open the file of the robot of this name."""
        (self._name,) = ros_names([name])
        super().__init__(place, RosMessages(), {f"robot {name}": self._name} | dict(facts))

    def add(self, t: float, sample: VehicleSample) -> None:
        """Write where the robot is at a time [s], what it does and where it goes."""
        stamp = round(t * 1e9)
        self._write_frames(stamp, [(self._name, sample)])
        self._write_flight(stamp, self._name, sample)

    def add_map(self, t: float, frame: GridFrame, classes: NDArray[np.uint8]) -> None:
        """Write the map that the robot holds at a time [s], ``(R, C)`` of the frame."""
        stamp = round(t * 1e9)
        self._write("/map", stamp, self._ros.map_grid(stamp, frame, classes))
