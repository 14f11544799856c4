"""How commands for operators reach a team: by the files of some of its robots, and the operator's keys."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TypeVar

import click

from vedette.cli.options import FILE, Positive, with_options
from vedette.errors import InputError
from vedette.net.access import Access
from vedette.net.config import ADMITTED, AgentConfig, load_config
from vedette.net.credentials import credentials

CommandT = TypeVar("CommandT", bound=Callable[..., Any])


def reaching_options(command: CommandT) -> CommandT:
    """``CONFIG.yaml...``, ``--keys`` and ``--wait``."""
    return with_options(
        command,
        click.argument("config_paths", metavar="CONFIG.yaml...", nargs=-1, required=True, type=FILE),
        click.option("--keys", type=FILE, metavar="DIR", help="The operator's folder of `vedette keys`."),
        click.option(
            "--wait", type=Positive("s", most=60.0), default=2.0, show_default=True,
            help="For agents to be reached and to answer [s].",
        ),
    )  # fmt: skip


def reached(config_paths: Sequence[Path], keys: Path | None) -> tuple[list[AgentConfig], Access]:
    """Return the robots of these files, all of one team, and how the operator gets at them.

    Raises:
        InputError: a file cannot be used, they are not of one team, or keys are missing.
    """
    configs = [load_config(path) for path in config_paths]
    if len({config.team for config in configs}) > 1:
        raise InputError("the files are of different teams; ask for one team at a time")
    _check_distinct(config_paths, configs)
    insecure = configs[0].links.insecure
    if any(config.links.insecure != insecure for config in configs):
        raise InputError("some of the files have secured links and some have not; ask for one kind at a time")
    if keys is None and not insecure:
        raise InputError("--keys is missing: the team's links are secured; give the operator's folder")
    operator = None if keys is None else credentials(keys, datetime.now(UTC))
    connect = tuple(dict.fromkeys(endpoint for config in configs for endpoint in config.links.reached_at))
    robots = max(ADMITTED, *(config.robot for config in configs))
    return configs, Access(configs[0].team, (), connect, operator, insecure, robots)


def _check_distinct(paths: Sequence[Path], configs: Sequence[AgentConfig]) -> None:
    """Refuse two files of one robot, of which one would not be asked."""
    first: dict[int, Path] = {}
    for path, config in zip(paths, configs, strict=True):
        if first.setdefault(config.robot, path) is not path:
            raise InputError(
                f"{first[config.robot]} and {path} are both of robot {config.robot}; leave one out"
            )
