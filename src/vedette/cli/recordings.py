"""What the commands share that read recorded lidar data: kinds of files, and options."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click
import msgspec

from vedette.cli.options import OneOf, Positive, with_options
from vedette.errors import InputError
from vedette.logs import RecordedLog, read_carmen
from vedette.ros2.bag import is_bag, read_bag
from vedette.ros2.settings import Ros2Settings
from vedette.sim.worlds import NO_RETURNS

CommandT = TypeVar("CommandT", bound=Callable[..., Any])
OF_RECORDINGS = ("reach", "no_return", "namespace", "scan", "base_frame", "map_frame")


def recording_options(command: CommandT) -> CommandT:
    """How a recording is read: ``--range``, ``--no-return``, and the names of a ROS 2 recording."""
    names = Ros2Settings()
    return with_options(
        command,
        click.option(
            "--range", "reach", type=Positive("m"), default=20.0, show_default=True,
            help="How far a recording's beams count [m].",
        ),
        click.option(
            "--no-return", type=OneOf(NO_RETURNS), default="ignore", show_default=True,
            help="What a beam says that did not come back: nothing, or that the way is free.",
        ),
        click.option("--namespace", default=names.namespace, help="Of the robot, in a ROS 2 recording."),
        click.option("--scan", default=names.scan, show_default=True, help="Its topic of LaserScan."),
        click.option("--base-frame", default=names.base_frame, show_default=True, help="Its body in TF."),
        click.option("--map-frame", default=names.map_frame, show_default=True, help="Its map in TF."),
    )  # fmt: skip


def recording(path: Path, no_return: str, **names: str) -> RecordedLog:
    """Read a CARMEN log, a rosbag2 folder or an MCAP file.

    Raises:
        InputError: it cannot be read, or a name is none of ROS.
    """
    if not is_bag(path):
        return read_carmen(path)
    try:
        settings = msgspec.convert({"no_return": no_return, **names}, Ros2Settings)
    except msgspec.ValidationError as error:
        option = str(error).rpartition("$.")[2].rstrip("`").replace("_", "-")
        raise InputError(f"--{option} must be a name as ROS has them, of letters, digits and _") from error
    return read_bag(path, settings)
