"""``vedette ros2``: what there is to a robot that runs ROS 2."""

from __future__ import annotations

from pathlib import Path

import click

from vedette.cli.options import FILE
from vedette.errors import InputError
from vedette.net.config import load_config
from vedette.ros2.check import Finding, check, could_start
from vedette.ros2.node import RosDoor
from vedette.ros2.settings import Ros2Settings

SIGNS = {True: "ok", None: "note", False: "missing"}


@click.group()
def ros2() -> None:
    """Look at a robot that runs ROS 2."""


@ros2.command("check")
@click.argument("config_path", metavar="[CONFIG.yaml]", required=False, type=FILE)
def check_robot(config_path: Path | None) -> None:
    """Say what an agent with this file, or with the usual names, would find at its robot and what it misses.

    It listens for a few seconds and sends nothing. Exit status: 0 an agent could start, 1 not so, 2 bad
    input.
    """
    settings = Ros2Settings() if config_path is None else _settings_of(config_path)
    door = RosDoor(settings, "vedette_check", listens_only=True)
    try:
        findings = check(settings, door)
    finally:
        door.close()
    for finding in findings:
        click.echo(line(finding))
    raise SystemExit(0 if could_start(findings) else 1)


def line(finding: Finding) -> str:
    """Return a finding as one line."""
    return f"{SIGNS[finding.good]:7}  {finding.said}"


def _settings_of(path: Path) -> Ros2Settings:
    settings = load_config(path).body.ros2
    if settings is None:
        raise InputError(f"{path}: body.ros2: missing; give it, if only {{}}, for a robot that runs ROS 2")
    return settings
