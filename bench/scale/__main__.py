"""``python -m bench.scale``: what a platform computes and says as the team grows from 2 to 1024."""

from __future__ import annotations

from pathlib import Path

import click

from bench import command, machine
from bench.scale.report import run
from bench.scale.series import DOMAINS
from vedette.errors import check_word


@click.command()
@click.option("--quick", is_flag=True, help="Three teams up to 64 only.")
@click.option("--domains", default=",".join(DOMAINS), show_default=True, help="By name, with commas.")
@command.date_option
@command.out_option("table, JSON and picture")
def scale(quick: bool, domains: str, date: str | None, out: Path) -> None:
    """Measure what grows with the team, and say MET or MISSED. Exit status 0 either way."""
    names = domains.split(",")
    for name in names:
        check_word("domain", name, DOMAINS)
    folder = command.results_folder(out)
    machine.stay_on_one_core()
    about = machine.describe()
    click.echo(f"{about['machine']}; Python {about['python']}; commit {about['commit']}\n")
    about |= {"date": date or about["commit_date"]}
    click.echo(run(folder, about, quick, lambda text: click.echo(f"  {text} ...", err=True), names))


if __name__ == "__main__":
    command.run(scale, "bench.scale")
