"""An MCAP file of ROS 2 messages, topic by topic, that moves into place when it is whole."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, TypeAlias

from mcap.writer import CompressionType, Writer

from vedette.errors import InputError
from vedette.record.files import atomic_path
from vedette.record.ros import FRAME_ID, RosMessages

Place: TypeAlias = Path | str | Callable[[], Path]  # of a file; asked again when it is whole


class Topics:
    """An MCAP stream whose channels and schemas are registered as they are first written to."""

    def __init__(self, stream: IO[bytes], ros: RosMessages) -> None:
        """Begin a file in an open stream."""
        self._ros = ros
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._counts: dict[int, int] = {}
        self._writer = Writer(stream, compression=CompressionType.ZSTD)
        self._writer.start(profile="ros2", library="vedette")

    def describe(self, facts: Mapping[str, str]) -> None:
        """Add the metadata record ``vedette``."""
        self._writer.add_metadata("vedette", {"frame": FRAME_ID} | dict(facts))

    def write(self, topic: str, stamp: int, message: Any) -> None:
        """Write a message; ``stamp`` is simulated time [ns]."""
        channel = self._channels.get(topic) or self._open(topic, str(message.__msgtype__))
        self._counts[channel] += 1
        self._writer.add_message(channel, stamp, self._ros.encode(message), stamp, self._counts[channel])

    def finish(self) -> None:
        """Write the index."""
        self._writer.finish()  # type: ignore[no-untyped-call]

    def _open(self, topic: str, kind: str) -> int:
        if kind not in self._schemas:
            definition = self._ros.definition(kind).encode()
            self._schemas[kind] = self._writer.register_schema(kind, "ros2msg", definition)
        self._channels[topic] = self._writer.register_channel(topic, "cdr", self._schemas[kind])
        self._counts[self._channels[topic]] = 0
        return self._channels[topic]


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
