"""Reading ``run.mcap`` again: its messages by topic, as they follow each other in time."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import atan2
from pathlib import Path
from typing import Any

import numpy as np
from mcap.exceptions import McapError
from mcap.reader import make_reader
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_typestore

from vedette.errors import InputError
from vedette.input_file import open_input
from vedette.record.log import DEAD, LEFT, VehicleSample

NO_PATH = np.empty((0, 2))


@dataclass(frozen=True)
class Moment:
    """All messages of one time."""

    stamp: int  # [ns]
    messages: dict[str, Any]  # the latest by topic


@dataclass
class Mover:
    """A robot or vehicle as a record has it up to now, under its own topics."""

    topic: str  # that they begin with
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)  # x, y, heading [m, m, rad]
    state: str = "waiting"
    path: NDArray[np.float64] = field(default_factory=lambda: NO_PATH)  # (k, 2) [m]
    goal: tuple[float, float] | None = None  # that it tells of itself [m]
    seen: tuple[int, ...] = ()  # targets, by its latest look

    def hear(self, messages: Mapping[str, Any]) -> None:
        """Take what is told of it."""
        if (pose := messages.get(f"/{self.topic}/pose")) is not None:
            self.at = pose_of(pose.pose)
        if (state := messages.get(f"/{self.topic}/state")) is not None:
            self.state = state.data
        if (path := messages.get(f"/{self.topic}/path")) is not None:
            self.path = np.array([pose_of(each.pose)[:2] for each in path.poses]).reshape(-1, 2)
        if (goal := messages.get(f"/{self.topic}/goal")) is not None:
            self.goal = goal.pose.position.x, goal.pose.position.y
        if (seen := messages.get(f"/{self.topic}/seen")) is not None:
            self.seen = tuple(map(int, seen.data.split()))

    @property
    def alive(self) -> bool:
        """It takes part."""
        return self.state not in (DEAD, LEFT)

    def sample(self) -> VehicleSample:
        """Return it as it is now."""
        return VehicleSample(*self.at, self.state, self.alive, self.path)


def pose_of(pose: Any) -> tuple[float, float, float]:
    """Return x, y [m] and heading [rad] of a ``geometry_msgs/Pose``."""
    return pose.position.x, pose.position.y, 2.0 * atan2(pose.orientation.z, pose.orientation.w)


def grid_of(grid: Any) -> NDArray[np.int8]:
    """Return the cells (R, C) of a ``nav_msgs/OccupancyGrid``."""
    return np.asarray(grid.data, np.int8).reshape(grid.info.height, grid.info.width)


def metrics_of(moment: Moment) -> dict[str, float]:
    """Return the figures of a moment by name."""
    told = moment.messages
    return {name.rpartition("/")[2]: told[name].data for name in told if name.startswith("/metrics/")}


def facts_of(path: Path) -> dict[str, str]:
    """Return what a record says it is of.

    Raises:
        InputError: it cannot be read, or it is no record of Vedette's.
    """
    with open_input(path, "record") as stream:
        try:
            for record in make_reader(stream).iter_metadata():
                if record.name == "vedette":
                    return dict(record.metadata)
        except (McapError, struct.error) as error:
            raise InputError(f"{path}: not a whole MCAP file: {error}") from error
    raise InputError(f"{path}: not a run record of Vedette's; give a folder with run.mcap in it")


def moments(path: Path) -> Iterator[Moment]:
    """Yield what a record holds in order of time.

    Raises:
        InputError: it cannot be read.
    """
    store = get_typestore(Stores.ROS2_HUMBLE)
    gathered: Moment | None = None
    with open_input(path, "record") as stream:
        try:
            for schema, channel, message in make_reader(stream).iter_messages():
                if gathered is not None and message.log_time != gathered.stamp:
                    yield gathered
                    gathered = None
                gathered = gathered or Moment(message.log_time, {})
                kind = "" if schema is None else schema.name
                gathered.messages[channel.topic] = store.deserialize_cdr(message.data, kind)
        except (McapError, struct.error, KeyError) as error:
            raise InputError(f"{path}: not a record that can be read: {error}") from error
    if gathered is not None:
        yield gathered
