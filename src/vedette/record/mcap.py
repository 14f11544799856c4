"""``run.mcap``: a mission as ROS 2 messages, for Foxglove, RViz and ``ros2 bag play``.

The file grows under a temporary name while the mission runs and moves into place on `close`, whatever ended
the mission. Stamps are simulated time from 0 s: the same mission gives the same bytes.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from copy import deepcopy
from math import isfinite
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Generic, Protocol, Self, TypeAlias, TypeVar, runtime_checkable

from mcap.writer import CompressionType, Writer

from vedette.errors import InputError
from vedette.record.files import atomic_path
from vedette.record.log import Timed, VehicleSample
from vedette.record.ros import FRAME_ID, RosMessages

Place: TypeAlias = Path | str | Callable[[], Path]  # of a file; asked again when it is whole
RosT = TypeVar("RosT", bound=RosMessages)


@runtime_checkable
class Medium(Protocol):
    """What takes messages in the place of a file, as ``mcap.writer.Writer`` does."""

    def register_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Take a message type; return its number."""

    def register_channel(self, topic: str, message_encoding: str, schema_id: int) -> int:
        """Take a topic; return its number."""

    def add_message(
        self, channel_id: int, log_time: int, data: bytes, publish_time: int, sequence: int = 0
    ) -> None:
        """Take a message; times [ns]."""


class McapFile(Generic[RosT]):
    """A context manager that writes messages; channels and schemas are registered as they first occur."""

    def __init__(self, place: Place | Medium, ros: RosT, facts: Mapping[str, str]) -> None:
        """Begin a file that says what it is of in the metadata record ``vedette``; or speak to a medium."""
        self._ros = ros
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._counts: dict[int, int] = {}
        self._states: dict[str, str] = {}
        self._closed = False
        self._files = ExitStack()
        if isinstance(place, Medium):
            self._medium: Medium = place
            return
        self._stream = self._files.enter_context(atomic_stream(place))
        self._medium = self._writer = Writer(self._stream, compression=CompressionType.ZSTD)
        self._writer.start(profile="ros2", library="vedette")
        self._writer.add_metadata("vedette", {"frame": FRAME_ID} | dict(facts))

    def update(self, snapshot: Any) -> None:
        """Write one snapshot, of the kind of mission that the file is of."""
        raise TypeError(f"{type(self).__name__} takes no snapshots")

    def close(self) -> None:
        """Write what is left and the index, and move the file into place; a second call does nothing."""
        if not self._closed:
            self._closed = True
            with self._files:
                self._write_rest()
                self._writer.finish()  # type: ignore[no-untyped-call]

    def save(self, path: Path) -> None:
        """Put a whole file of what has been recorded up to now in place; recording goes on.

        Raises:
            InputError: the file cannot be written there.
        """
        self._writer.flush()  # type: ignore[no-untyped-call]
        with atomic_path(path, ".saved-") as part, part.open("wb") as copy:
            self._stream.seek(0)
            shutil.copyfileobj(self._stream, copy)
            twin = deepcopy(self._writer, {id(self._stream): copy})  # it writes its index to the copy
            twin.finish()  # type: ignore[no-untyped-call]

    def __enter__(self) -> Self:
        """Return the writer."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close, after an interruption too: what was recorded until then is valid.

        Where bad input ends a mission before anything is recorded, no file is left.
        """
        if isinstance(error, InputError) and not self._channels:
            self._closed = True
            self._files.__exit__(kind, error, trace)
        self.close()

    def _write_rest(self) -> None:
        """Write what waits for the end of the mission."""

    def _write(self, topic: str, stamp: int, message: Any) -> None:
        """Write a message; ``stamp`` is simulated time [ns]."""
        channel = self._channels.get(topic) or self._open(topic, str(message.__msgtype__))
        self._counts[channel] += 1
        self._medium.add_message(channel, stamp, self._ros.encode(message), stamp, self._counts[channel])

    def _open(self, topic: str, kind: str) -> int:
        if kind not in self._schemas:
            definition = self._ros.definition(kind).encode()
            self._schemas[kind] = self._medium.register_schema(kind, "ros2msg", definition)
        self._channels[topic] = self._medium.register_channel(topic, "cdr", self._schemas[kind])
        self._counts[self._channels[topic]] = 0
        return self._channels[topic]

    def _write_frames(self, stamp: int, team: Iterable[tuple[str, VehicleSample]]) -> None:
        """Write the transforms of those who live, by their ROS names."""
        frames = [(f"{name}/base_link", v.x, v.y, v.heading) for name, v in team if v.alive]
        self._write("/tf", stamp, self._ros.transforms(stamp, frames))

    def _write_state(self, stamp: int, name: str, vehicle: VehicleSample) -> None:
        """Write what a vehicle does, if that has changed."""
        if self._states.get(name) != vehicle.state:
            self._states[name] = vehicle.state
            self._write(f"/{name}/state", stamp, self._ros.text(vehicle.state))

    def _write_flight(self, stamp: int, name: str, vehicle: VehicleSample) -> None:
        """Write what a vehicle does; while it lives, where it is and its plan too."""
        self._write_state(stamp, name, vehicle)
        if vehicle.alive:
            self._write_pose(stamp, name, vehicle)
            self._write(f"/{name}/path", stamp, self._ros.path(stamp, vehicle.path))

    def _write_pose(self, stamp: int, name: str, vehicle: VehicleSample) -> None:
        self._write(f"/{name}/pose", stamp, self._ros.pose(stamp, vehicle.x, vehicle.y, vehicle.heading))

    def _write_metrics(self, stamp: int, snapshot: Timed, names: Iterable[str]) -> None:
        """Write figures of a snapshot by the names of its fields; None and NaN are none."""
        for name in names:
            if (value := getattr(snapshot, name)) is not None and isfinite(value):
                self._write(f"/metrics/{name}", stamp, self._ros.number(value))


@contextmanager
def atomic_stream(place: Place) -> Iterator[IO[bytes]]:
    """Open a file that appears under its name when it is closed, where ``place`` says it belongs by then.

    So what was written stays, though the folder that it was begun in has vanished.

    Raises:
        InputError: the file cannot be written there.
    """
    path = _at(place)
    temporary = path.with_name(f".part-{path.name}")
    try:
        with temporary.open("w+b") as stream:
            yield stream
            stream.flush()
            last = _at(place)
            if last != path:
                stream.seek(0)
                with atomic_path(last) as again, again.open("wb") as copy:
                    shutil.copyfileobj(stream, copy)
        if last == path:
            temporary.replace(path)
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror or error}; choose another folder") from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def _at(place: Place) -> Path:
    return place() if callable(place) else Path(place)


def stamp_of(snapshot: Timed) -> int:
    """Return the time of a snapshot [ns]."""
    return round(snapshot.t * 1e9)
