"""Recorded ROS 2 data: what a robot told, as its agent would have taken it in."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

from mcap.exceptions import McapError
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore

from vedette.agent.events import Pose, Scan
from vedette.errors import InputError, nearest_name
from vedette.input_file import open_input
from vedette.logs import RecordedLog, RecordedScan
from vedette.ros2.body import Ros2Body
from vedette.ros2.door import Notice, Told
from vedette.ros2.goals import Place
from vedette.ros2.messages import joints_of, sweep_of
from vedette.ros2.scans import Lidar
from vedette.ros2.settings import Ros2Settings
from vedette.team import PlatformSpec

STEP = 0.1  # of the bag's time that the body is told at once [s]
SCANS, TRANSFORMS = "sensor_msgs/msg/LaserScan", "tf2_msgs/msg/TFMessage"
Recorded: TypeAlias = tuple[float, str, str, Any]  # when [s], topic, type, message


def is_bag(path: Path) -> bool:
    """Tell whether a path is a recording of ROS 2: a rosbag2 folder, or an MCAP file."""
    return path.suffix == ".mcap" or path.is_dir()


def read_bag(path: Path, settings: Ros2Settings) -> RecordedLog:
    """Read the scans of a rosbag2 folder or an MCAP file, each from where TF has the lidar then.

    Every scan is taken in as by a robot's agent: deskewed, in the frame ``map_frame`` of the settings, at
    most some five a second.

    Raises:
        InputError: the recording cannot be read, it has no such topic, or no scan that TF places.
    """
    door = RecordedDoor(settings)
    body = Ros2Body(PlatformSpec(), settings, door)
    scans: list[RecordedScan] = []
    first: float | None = None
    try:
        with _opened(path) as recorded:
            for now, topic, kind, message in recorded:
                first = now if first is None else first
                door.hear(topic, kind, message)
                if now >= door.told_at + STEP:
                    scans += _scans(body, now - first)
                    door.told_at = now
            scans += _scans(body, door.told_at + STEP - (first or 0.0))
    except (AnyReaderError, McapError, SerdeError, EOFError, OSError) as error:
        raise InputError(f"cannot read recording {path}: {error or type(error).__name__}") from error
    if not scans:
        raise InputError(f"{path}: {_why(door, body, settings)}")
    assert body.latest is not None, "there is a scan"
    return RecordedLog(path.stem, tuple(scans), Lidar.of(body.latest, settings.scan).range)


@dataclass(eq=False)
class RecordedDoor:
    """What a robot told in its time; nobody takes orders; ``vedette.ros2.door.Door``."""

    settings: Ros2Settings
    time: float | None = None  # no /clock is needed: the recording has its own
    told_at: float = -STEP  # up to when the body has been told [s]
    topics: dict[str, str] = field(default_factory=dict)  # what there was, with its type
    _told: deque[Told] = field(default_factory=deque)

    def hear(self, topic: str, kind: str, message: Any) -> None:
        """Take in a message, of whatever topic."""
        self.topics[topic] = kind
        own = f"/{self.settings.namespace.strip('/')}".rstrip("/")
        if kind == TRANSFORMS and topic in ("/tf", "/tf_static", f"{own}/tf", f"{own}/tf_static"):
            self._told += joints_of(message, fixed=topic.endswith("tf_static"))
        elif kind == SCANS and topic in (self.settings.scan, f"{own}/{self.settings.scan}"):
            self._told.append(sweep_of(message))

    def take(self) -> Sequence[Told]:
        """Return what has been told since the last call."""
        told, self._told = self._told, deque()
        return tuple(told)

    def ask(self, goal: int, place: Place, frame: str) -> None:
        """Send nobody anywhere."""

    def cancel(self, goal: int) -> None:
        """There is nothing to cancel."""

    def show(self, notice: Notice) -> None:
        """Show nobody anything."""

    def close(self) -> None:
        """There is nobody to leave."""


def _scans(body: Ros2Body, now: float) -> Iterator[RecordedScan]:
    """Yield the scans that a body takes in now, [s] since the recording began."""
    pose: Pose | None = None
    for event in body.sense(now):
        match event:
            case Pose():
                pose = event
            case Scan() if pose is not None:
                x, y = pose.x + event.offset[0], pose.y + event.offset[1]
                yield RecordedScan(now, x, y, pose.heading, event.angles, event.ranges)


def _why(door: RecordedDoor, body: Ros2Body, settings: Ros2Settings) -> str:
    """Say why a recording has no scan to replay."""
    scans = [topic for topic, kind in door.topics.items() if kind == SCANS]
    if not scans:
        return f"no topic of {SCANS} in it"
    if body.latest is None:
        wanted = settings.scan
        return f"nothing on {wanted}; {nearest_name(wanted, scans)}: give --scan"
    frames = ", ".join(sorted(body.transforms.frames)) or "none"
    return (
        f"TF joins no scan's frame {body.latest.frame} to {settings.map_frame}; frames told of: {frames}; "
        "give --map-frame, or record /tf and /tf_static"
    )


@contextmanager
def _opened(path: Path) -> Iterator[Iterator[Recorded]]:
    """Open a recording, its messages in the order in which they were recorded."""
    if path.suffix == ".mcap":
        with open_input(path, "recording") as file:
            yield _of_mcap(make_reader(file).iter_messages())
        return
    if not (path / "metadata.yaml").exists():
        raise InputError(f"{path}: no metadata.yaml in it; give a rosbag2 folder or an MCAP file")
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        wanted = [each for each in reader.connections if each.msgtype in (SCANS, TRANSFORMS)]
        yield (
            (stamp * 1e-9, each.topic, each.msgtype, reader.deserialize(data, each.msgtype))
            for each, stamp, data in reader.messages(wanted)
        )


def _of_mcap(messages: Any) -> Iterator[Recorded]:
    store = get_typestore(Stores.ROS2_HUMBLE)
    for schema, channel, message in messages:
        if schema is not None and schema.name in (SCANS, TRANSFORMS):
            data = store.deserialize_cdr(message.data, schema.name)
            yield message.log_time * 1e-9, channel.topic, schema.name, data
