"""Recordings of ROS 2 as a robot in a known building would have left them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapFile
from numpy.typing import NDArray
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from tests.support.recordings import places, ranges_from
from vedette.maps import FREE, OCCUPIED, GridFrame
from vedette.maps.world import World
from vedette.ros2.bag import typestore

STORE = typestore()
Told = tuple[float, str, Any]  # when [s], topic, message


def message(kind: str, *fields: Any) -> Any:
    """A message by its type and its fields in order."""
    return STORE.types[kind](*fields)


def stamp(now: float) -> Any:
    """A Time."""
    nanoseconds = round(now * 1e9)
    return message("builtin_interfaces/msg/Time", nanoseconds // 10**9, nanoseconds % 10**9)


def header(now: float, frame: str) -> Any:
    """A Header."""
    return message("std_msgs/msg/Header", stamp(now), frame)


def joint(now: float, parent: str, child: str, x: float, y: float, yaw: float) -> Any:
    """A TFMessage."""
    place = message("geometry_msgs/msg/Vector3", x, y, 0.0)
    turn = message("geometry_msgs/msg/Quaternion", 0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2))
    transform = message("geometry_msgs/msg/Transform", place, turn)
    told = message("geometry_msgs/msg/TransformStamped", header(now, parent), child, transform)
    return message("tf2_msgs/msg/TFMessage", [told])


def scan(now: float, ranges: NDArray[np.float64]) -> Any:
    """A LaserScan of all directions from straight behind on, clockwise."""
    step = -2.0 * np.pi / len(ranges)
    fields = np.pi, np.pi + step * (len(ranges) - 1), step, 0.0, 0.1, 0.05, 8.0
    empty = np.zeros(0, np.float32)
    return message(
        "sensor_msgs/msg/LaserScan", header(now, "laser"), *fields, ranges.astype(np.float32), empty
    )


def grid(
    now: float, classes: NDArray[np.uint8], frame: GridFrame, yaw: float = 0.0, name: str = "map"
) -> Any:
    """An OccupancyGrid; the frame's corner is where its own begins, turned by ``yaw`` about itself."""
    cells = np.select([classes == FREE, classes == OCCUPIED], [0, 100], -1).astype(np.int8)
    at = message("geometry_msgs/msg/Point", frame.origin_x, frame.origin_y, 0.0)
    turn = message("geometry_msgs/msg/Quaternion", 0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2))
    corner = message("geometry_msgs/msg/Pose", at, turn)
    rows, cols = classes.shape
    info = message("nav_msgs/msg/MapMetaData", stamp(now), frame.resolution, cols, rows, corner)
    return message("nav_msgs/msg/OccupancyGrid", header(now, name), info, cells.ravel())


def patch(now: float, classes: NDArray[np.uint8], row: int, col: int) -> Any:
    """An OccupancyGridUpdate."""
    cells = np.select([classes == FREE, classes == OCCUPIED], [0, 100], -1).astype(np.int8)
    rows, cols = classes.shape
    return message(
        "map_msgs/msg/OccupancyGridUpdate", header(now, "map"), col, row, cols, rows, cells.ravel()
    )


def tour(world: World, step: float = 1.0) -> list[Told]:
    """What a robot tells that drives from place to place and looks; its lidar is off its middle."""
    told: list[Told] = [(0.0, "/tf_static", joint(0.0, "base_link", "laser", 0.1, 0.0, 0.0))]
    angles = np.pi - 2.0 * np.pi / 360 * np.arange(360)
    for k, (x, y) in enumerate(places(world, step).tolist()):
        now, heading = 1.0 + 0.5 * k, 0.7 * k
        base = x - 0.1 * np.cos(heading), y - 0.1 * np.sin(heading)
        for t in (now - 0.05, now + 0.05):
            told.append((t, "/tf", joint(t, "odom", "base_link", *base, heading)))
            told.append((t, "/tf", joint(t, "map", "odom", 0.0, 0.0, 0.0)))
        ranges = ranges_from(world, x, y, heading, angles)
        told.append((now, "/scan", scan(now, np.where(ranges < 8.0, ranges, np.inf))))
    return sorted(told, key=lambda each: each[0])


def write_folder(
    folder: Path,
    told: Sequence[Told],
    storage: StoragePlugin = StoragePlugin.MCAP,
    compressed: CompressionMode | None = None,
) -> Path:
    """Write a rosbag2 folder."""
    writer = Writer(folder, version=9 if compressed is None else 8, storage_plugin=storage)
    if compressed is not None:
        writer.set_compression(compressed, CompressionFormat.ZSTD)
    with writer:
        connections: dict[str, Any] = {}
        for now, topic, content in told:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, content.__msgtype__, typestore=STORE)
            data = STORE.serialize_cdr(content, content.__msgtype__)
            writer.write(connections[topic], round(now * 1e9), data)
    return folder


def write_mcap(path: Path, told: Sequence[Told], compression: CompressionType) -> Path:
    """Write an MCAP file whose chunks are compressed, or not."""
    with path.open("wb") as stream:
        writer = McapFile(stream, chunk_size=4096, compression=compression)
        writer.start(profile="ros2")
        channels: dict[str, int] = {}
        for now, topic, content in told:
            kind = content.__msgtype__
            if topic not in channels:
                text, _ = STORE.generate_msgdef(kind, ros_version=2)
                schema = writer.register_schema(kind, "ros2msg", text.encode())
                channels[topic] = writer.register_channel(topic, "cdr", schema)
            data = bytes(STORE.serialize_cdr(content, kind))
            writer.add_message(channels[topic], round(now * 1e9), data, round(now * 1e9))
        writer.finish()
    return path
