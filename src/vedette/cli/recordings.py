"""What the commands share that read recorded lidar data: kinds of files, and options."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import click
import msgspec

from vedette.cli.options import OneOf, Positive, with_options
from vedette.errors import InputError
from vedette.input_file import open_input
from vedette.logs import RecordedLog, read_carmen
from vedette.ros2.bag import EVIDENCE, is_bag, read_bag
from vedette.ros2.settings import Ros2Settings
from vedette.sim.worlds import NO_RETURNS

_OTHERS = {
    b"SQLite format 3\0": "a file of a rosbag2 folder; give the folder",
    b"#ROSBAG V2.0": "a bag of ROS 1; convert it: rosbags-convert --src {path} --dst {bare}",
    b"\x89MCAP0\r\n": "an MCAP file; name it {bare}.mcap",
}  # how a file begins, and what it is then
CommandT = TypeVar("CommandT", bound=Callable[..., Any])
OF_RECORDINGS = ("reach", "no_return", "evidence", "namespace", "scan", "map", "base_frame", "map_frame")


def recording_options(command: CommandT) -> CommandT:
    """How a recording is read: ``--range``, ``--no-return``, and what of a ROS 2 recording."""
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
        click.option(
            "--evidence", type=OneOf(EVIDENCE),
            help="What of a ROS 2 recording is taken in.  [default: scans, or without any the robot's map]",
        ),
        click.option("--namespace", default=names.namespace, help="Of the robot, in a ROS 2 recording."),
        click.option("--scan", default=names.scan, show_default=True, help="Its topic of LaserScan."),
        click.option("--map", default=names.map, show_default=True, help="Its topic of OccupancyGrid."),
        click.option("--base-frame", default=names.base_frame, show_default=True, help="Its body in TF."),
        click.option("--map-frame", default=names.map_frame, show_default=True, help="Its map in TF."),
    )  # fmt: skip


def recording(path: Path, no_return: str, evidence: str | None, **names: str) -> RecordedLog:
    """Read a CARMEN log, a rosbag2 folder or an MCAP file.

    Raises:
        InputError: it cannot be read, or a name is none of ROS.
    """
    if not is_bag(path):
        _check_kind(path)
        return read_carmen(path)
    try:
        settings = msgspec.convert({"no_return": no_return, **names}, Ros2Settings)
    except msgspec.ValidationError as error:
        option = str(error).rpartition("$.")[2].rstrip("`").replace("_", "-")
        raise InputError(f"--{option} must be a name as ROS has them, of letters, digits and _") from error
    return read_bag(path, settings, evidence)


def check_in_vain(paths: Sequence[Path], evidence: str | None, **names: str) -> None:
    """Refuse what only a ROS 2 recording makes anything of, if there is none.

    Raises:
        InputError: so it is.
    """
    if any(map(is_bag, paths)):
        return
    usual = Ros2Settings()
    given = {name: value for name, value in names.items() if value != getattr(usual, name)}
    given |= {} if evidence is None else {"evidence": evidence}
    if given:
        name, value = next(iter(given.items()))
        option = f"--{name.replace('_', '-')} {value}"
        raise InputError(f"{option} is of ROS 2 recordings, and {paths[0]} is none; leave it out")


def _check_kind(path: Path) -> None:
    """Call by its name what is plainly no CARMEN log."""
    with open_input(path, "log") as file:
        begin = file.read(16)
    for magic, remedy in _OTHERS.items():
        if begin.startswith(magic):
            raise InputError(f"{path} is {remedy.format(path=path, bare=path.with_suffix(''))}")
