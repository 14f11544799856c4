"""``vedette status``: how the agents of a team are."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

import click
from rich.console import Console

from vedette.cli.options import FILE, Positive
from vedette.errors import InputError
from vedette.net.access import Access
from vedette.net.config import ADMITTED, AgentConfig, load_config
from vedette.net.credentials import credentials
from vedette.net.status import ask, status_table, team_status
from vedette.net.transport import Operator
from vedette.outcome import Outcome


@click.command()
@click.argument("config_paths", metavar="CONFIG.yaml...", nargs=-1, required=True, type=FILE)
@click.option("--keys", type=FILE, metavar="DIR", help="The operator's folder of `vedette keys`.")
@click.option(
    "--wait",
    type=Positive("s", most=60.0),
    default=2.0,
    show_default=True,
    help="For agents to be reached and to answer [s].",
)
@click.option("--json", "as_json", is_flag=True, help="Print what they say as JSON.")
def status(config_paths: tuple[Path, ...], keys: Path | None, wait: float, as_json: bool) -> None:
    """List the agents that listen where the CONFIG.yaml files say: tree, links, agreement, refused messages.

    Exit status: 0 all of them answered and hold the same map, 1 not so, 2 bad input.
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
    access = Access(configs[0].team, (), connect, operator, insecure, robots)
    with Operator(access) as session:
        told = ask(session, [config.robot - 1 for config in configs], wait)
    if as_json:
        click.echo(team_status(told).to_json(), nl=False)
    else:
        Console().print(status_table(told))
    answered = [condition for condition in told.values() if condition is not None]
    agreed = len({condition.digest for condition in answered}) <= 1
    outcome = Outcome.COMPLETE if agreed and len(answered) == len(told) else Outcome.MAPS_DIFFER
    raise SystemExit(outcome.status)


def _check_distinct(paths: Sequence[Path], configs: Sequence[AgentConfig]) -> None:
    """Refuse two files of one robot, of which one would not be asked."""
    first: dict[int, Path] = {}
    for path, config in zip(paths, configs, strict=True):
        if first.setdefault(config.robot, path) is not path:
            raise InputError(
                f"{first[config.robot]} and {path} are both of robot {config.robot}; leave one out"
            )
