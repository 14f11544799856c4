"""``vedette watch``: a team or a run in a browser."""

from __future__ import annotations

import threading
from contextlib import ExitStack
from pathlib import Path

import click

from vedette.cli.options import FILE, Whole
from vedette.cli.reaching import reached
from vedette.cli.windows import address_options, linger, opened
from vedette.errors import InputError
from vedette.interrupt import ending_on_ctrl_c
from vedette.net.feed import TeamFeed
from vedette.net.onlookers import onlooker_of
from vedette.net.transport import Operator
from vedette.run.mission import RECORD
from vedette.window.export import Show, export_page
from vedette.window.foxglove import LOOPBACK, TOKEN, FoxgloveServer
from vedette.window.hub import Hub


@click.command()
@click.argument("sources", metavar="CONFIG.yaml... | RUN_DIR | run.mcap", nargs=-1, required=True, type=FILE)
@click.option("--keys", type=FILE, metavar="DIR", help="The operator's folder of `vedette keys`.")
@address_options
@click.option(
    "--foxglove",
    type=Whole(0, 65535),
    metavar="PORT",
    help="Serve a team to Foxglove as well, on this computer alone.",
)
@click.option("--export", type=FILE, metavar="FILE.html", help="Write a page that plays a record by itself.")
def watch(
    sources: tuple[Path, ...],
    keys: Path | None,
    host: str,
    port: int,
    foxglove: int | None,
    export: Path | None,
) -> None:
    """Show a team on the network, or a mission that was recorded, in a browser until Ctrl-C.

    The address that is printed has a token in it, without which nothing is shown. Of a team whose agents
    listen where the CONFIG.yaml files say, the page gives orders. Exit status: 0, or 2 for bad input.
    """
    from vedette.window.recorded import recorded  # who asks for help does not wait for it

    record = _record(sources)
    if export is not None:
        if record is None:
            raise InputError("--export: only what was recorded plays by itself; give a RUN_DIR or a run.mcap")
        hub = recorded(record)
        export_page([Show(hub.name, hub.history, hub.events(0)[1])], export)
        click.echo(f"open {export} in a browser")
        return
    if record is not None:
        if keys is not None or foxglove is not None:
            option = "--keys" if foxglove is None else "--foxglove"
            raise InputError(f"{option} is of teams on a network, and {record} is a record; leave it out")
        with opened(recorded(record), host, port):
            linger()
        return
    configs, access = reached(sources, keys)
    onlooker = onlooker_of(configs[0], sources[0].parent)
    ended = threading.Event()
    with Operator(access) as operator, ending_on_ctrl_c(ended.set):
        feed = TeamFeed(operator, access, onlooker)
        hub = Hub(access.team, feed.give)
        with opened(hub, host, port), ExitStack() as more:
            served = None
            if foxglove is not None:
                server = FoxgloveServer(access.team, feed.give, onlooker.recorder, foxglove)
                served = more.enter_context(server)
                click.echo(
                    f"Foxglove connects to ws://{LOOPBACK}:{served.port}; to give orders publish on {TOKEN} "
                    f'{{"data": "{served.token}"}}',
                    err=True,
                )
            feed.follow(hub, ended, served)


def _record(sources: tuple[Path, ...]) -> Path | None:
    """Return the record that is to be shown; None: the sources are robots' files."""
    first = sources[0]
    record = first / RECORD if first.is_dir() else first if first.suffix == ".mcap" else None
    if record is not None and len(sources) > 1:
        raise InputError(f"{sources[1]}: one run at a time can be watched; leave it out")
    return record
