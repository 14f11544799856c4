"""Recorded ROS 2 data: what a robot told, as its agent would have taken it in."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from mcap.reader import make_reader
from msgspec.structs import replace
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from vedette.errors import InputError, nearest_name
from vedette.input_file import open_input
from vedette.logs import RecordedLog, RecordedMap, RecordedScan
from vedette.ros2.body import Ros2Body
from vedette.ros2.recorded import KINDS, MAPS, PATCHES, SCANS, STEP, OwnMaps, Recorded, RecordedDoor, scans_of
from vedette.ros2.settings import Ros2Settings
from vedette.team import PlatformSpec

EVIDENCE = ("scan", "map")
_PATCH = "std_msgs/Header header\nint32 x\nint32 y\nuint32 width\nuint32 height\nint8[] data"


def is_bag(path: Path) -> bool:
    """Tell whether a path is a recording of ROS 2: a rosbag2 folder, or an MCAP file."""
    return path.suffix == ".mcap" or path.is_dir()


def read_bag(path: Path, settings: Ros2Settings, evidence: str | None = None) -> RecordedLog:
    """Read a rosbag2 folder or an MCAP file: scans, each from where TF has the lidar then, or maps.

    Every scan is taken in as by a robot's agent: deskewed, in the frame ``map_frame`` of the settings, at
    most some five a second. Of maps there is one a second at most, and the last.

    Args:
        path: of the recording.
        settings: names of topics and frames.
        evidence: ``scan`` or ``map``; None: scans where there are any, else maps.

    Raises:
        InputError: the recording cannot be read, it has no such topic, or nothing that TF places.
    """
    heard = _heard(path, replace(settings, evidence=evidence or "scan"))
    if evidence is None and SCANS not in (kinds := set(heard.door.topics.values())) and MAPS in kinds:
        heard = _heard(path, replace(settings, evidence="map"))
    if not heard.scans and not heard.maps:
        raise InputError(f"{path}: {_why(heard)}")
    lidar = heard.door.lidar
    reach = 0.0 if lidar is None else lidar.range
    return RecordedLog(path.resolve().stem, tuple(heard.scans), reach, tuple(heard.maps))


@dataclass(eq=False)
class _Heard:
    """What has come of a recording."""

    door: RecordedDoor
    body: Ros2Body
    scans: list[RecordedScan]
    maps: list[RecordedMap]


def _heard(path: Path, settings: Ros2Settings) -> _Heard:
    door = RecordedDoor(settings)
    heard = _Heard(door, Ros2Body(PlatformSpec(), settings, door), [], [])
    own_maps, maps = OwnMaps(), settings.evidence == "map"
    first, told_at, now = None, -STEP, 0.0
    with closing(_messages(path)) as messages:
        for stamp, topic, kind, read in messages:
            first = stamp if first is None else first
            now = stamp - first
            with _telling(path):
                try:
                    door.hear(topic, kind, read)
                except InputError as error:
                    raise InputError(f"{path}: {error}") from error
            if now >= told_at + STEP:
                heard.maps += own_maps.of(heard.body, now) if maps else ()
                heard.scans += () if maps else scans_of(heard.body, now)
                told_at = now
    heard.maps += own_maps.of(heard.body, now, at_last=True) if maps else ()
    heard.scans += () if maps else scans_of(heard.body, told_at + STEP)
    return heard


def _why(heard: _Heard) -> str:
    """Say why a recording has nothing to replay."""
    door, body, settings = heard.door, heard.body, heard.door.settings
    maps = settings.evidence == "map"
    kind, wanted = (MAPS, settings.map) if maps else (SCANS, settings.scan)
    topics = [topic for topic, told in door.topics.items() if told == kind]
    if not topics:
        other = "" if maps or MAPS not in door.topics.values() else "; maps are: give --evidence map"
        return f"no topic of {kind} in it{other}"
    frame = body.latest and body.latest.frame if not maps else body.grids.latest and body.grids.latest.frame
    if frame is None and door.senseless:
        return f"no map on {wanted} has as many cells as it says"
    if frame is None:
        return f"nothing on {wanted}; {nearest_name(wanted, topics)}: give --{'map' if maps else 'scan'}"
    frames = ", ".join(sorted(body.transforms.frames)) or "none"
    return (
        f"TF joins no {'map' if maps else 'scan'}'s frame {frame} to {settings.map_frame}; frames told of: "
        f"{frames}; give --map-frame, or record /tf and /tf_static"
    )


def _messages(path: Path) -> Generator[Recorded, None, None]:
    """Yield what is of use in a recording, in the order in which it was recorded.

    Raises:
        InputError: it cannot be read, or not to its end.
    """
    with _telling(path):
        yield from _of_mcap(path) if path.suffix == ".mcap" else _of_folder(path)


@contextmanager
def _telling(path: Path) -> Iterator[None]:
    """Say in a line what is wrong with a recording, whatever library unpacks, decompresses or queries."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        said = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"cannot read recording {path}: {said[:300]}; it is cut off or damaged") from error


def _of_folder(path: Path) -> Iterator[Recorded]:
    if not (path / "metadata.yaml").exists():
        raise InputError(f"{path}: no metadata.yaml in it; give a rosbag2 folder or an MCAP file")
    with AnyReader([path], default_typestore=typestore()) as reader:
        wanted = [each for each in reader.connections if each.msgtype in KINDS]
        for each, stamp, data in reader.messages(wanted):
            yield stamp * 1e-9, each.topic, each.msgtype, partial(reader.deserialize, data, each.msgtype)


def _of_mcap(path: Path) -> Iterator[Recorded]:
    store = typestore()
    with open_input(path, "recording") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            if schema is not None and schema.name in KINDS:
                read = partial(store.deserialize_cdr, message.data, schema.name)
                yield message.log_time * 1e-9, channel.topic, schema.name, read


def typestore() -> Typestore:
    """Return the types of messages that recordings may have without telling them."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(_PATCH, PATCHES))
    return store
