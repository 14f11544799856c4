"""``vedette status``: how the agents of a team are."""

from __future__ import annotations

from pathlib import Path

import click
from rich.console import Console

from vedette.cli.reaching import reached, reaching_options
from vedette.cli.showing import watch_team
from vedette.errors import InputError
from vedette.net.status import ask, status_table, team_status
from vedette.net.transport import Operator
from vedette.outcome import Outcome


@click.command()
@reaching_options
@click.option("--watch", is_flag=True, help="Go on to show them with their map, until Ctrl-C.")
@click.option("--json", "as_json", is_flag=True, help="Print what they say as JSON.")
def status(
    config_paths: tuple[Path, ...], keys: Path | None, wait: float, watch: bool, as_json: bool
) -> None:
    """List the agents that listen where the CONFIG.yaml files say: tree, links, agreement, refused messages.

    With --watch they are shown with their places and the map, until Ctrl-C. Exit status: 0 all of them
    answered and hold the same map, 1 not so, 2 bad input.
    """
    configs, access = reached(config_paths, keys)
    if watch and as_json:
        raise InputError("--json goes with one answer, and --watch goes on; leave one of them out")
    if watch:
        watch_team(access, configs[0].mission)
        return
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
