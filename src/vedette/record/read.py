"""Reading ``run.mcap`` again: its messages by topic, as they follow each other in time."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mcap.exceptions import McapError
from mcap.reader import make_reader
from rosbags.typesys import Stores, get_typestore

from vedette.errors import InputError
from vedette.input_file import open_input


@dataclass(frozen=True)
class Moment:
    """All messages of one time."""

    stamp: int  # [ns]
    messages: dict[str, Any]  # the latest by topic


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
