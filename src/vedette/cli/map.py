"""``vedette map``: what a team on the network has found out by now, as files."""

from __future__ import annotations

from pathlib import Path

import click

from vedette.cli.options import FILE
from vedette.cli.reaching import reached, reaching_options
from vedette.net.hearing import Hearing
from vedette.net.names import robot_name
from vedette.net.report import Report
from vedette.net.results import told, write_results
from vedette.net.transport import Operator
from vedette.outcome import Outcome
from vedette.record.folder import OutputFolder


@click.command("map")
@reaching_options
@click.option("--out", type=FILE, required=True, metavar="DIR", help="Folder for what is fetched.")
@click.option("--force", is_flag=True, help="Write into DIR although it exists.")
def map_(config_paths: tuple[Path, ...], keys: Path | None, wait: float, out: Path, force: bool) -> None:
    """Fetch the team's map from any of its agents that listen where the CONFIG.yaml files say.

    Of those that answer, the one that knows most is believed. Of a team that tracks or searches, its tracks
    or its pdf are fetched. Exit status: 0 fetched, 1 nobody answered or knows anything, 2 bad input.
    """
    configs, access = reached(config_paths, keys)
    asked = {config.robot - 1 for config in configs}
    with Operator(access) as operator:
        hearing = Hearing(operator)
        hearing.listen(wait, lambda: hearing.reports.keys() >= asked and _anything(hearing))
    if not hearing.reports:
        click.echo(f"nobody answered within {wait:g} s: no agent runs where the files say", err=True)
        raise SystemExit(Outcome.UNHEARD.status)
    best = max(hearing.reports.values(), key=_knows)
    if best.condition.known_m2 == 0.0:
        click.echo("nothing is known yet: the robots that answered have not begun", err=True)
        raise SystemExit(Outcome.UNHEARD.status)
    team, mission = configs[0].team, configs[0].mission
    ended = Outcome.of(best.condition.ending) if best.condition.state == "done" else None
    with OutputFolder.make(out, force, "", config_paths) as folder:
        summary = write_results(best, folder.path, team, mission, ended)
        names = ", ".join(map(robot_name, sorted(hearing.reports)))
        click.echo(f"{told(summary)}\nof {summary.robot}, which knows most of {names}; kept in {folder.path}")


def _anything(hearing: Hearing) -> bool:
    """Tell whether anybody knows anything."""
    return any(report.condition.known_m2 != 0.0 for report in hearing.reports.values())


def _knows(report: Report) -> tuple[float, float]:
    """Return how much a robot knows, of a map or by the time."""
    return report.condition.known_m2 or 0.0, report.condition.time
