"""How commands open the operator's window: where it listens, and for how long."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from vedette.agent.orders import Order
from vedette.cli.options import Positive, Whole, with_options
from vedette.interrupt import ending_on_ctrl_c
from vedette.record.space import space_alerts
from vedette.run.mission import StepwiseMission
from vedette.window.hub import LOOPBACK, Hub
from vedette.window.picture import Beside, ordered

if TYPE_CHECKING:
    from vedette.window.server import WindowServer

CommandT = TypeVar("CommandT", bound=Callable[..., Any])
PACE = 5.0


def address_options(command: CommandT) -> CommandT:
    """``--host`` and ``--port``."""
    return with_options(
        command,
        click.option(
            "--host", default=LOOPBACK, show_default=True, metavar="ADDRESS",
            help="Where the page is served; others than this computer see it by another address.",
        ),
        click.option(
            "--port", type=Whole(0, 65535), default=0, metavar="N",
            help="Of the page.  [default: any that is free]",
        ),
    )  # fmt: skip


def watch_options(command: CommandT) -> CommandT:
    """``--watch`` and ``--pace`` of a simulated mission."""
    return with_options(
        command,
        click.option("--watch", is_flag=True, help="Show it in a browser, where orders can be given too."),
        click.option(
            "--pace", type=Positive("times real time", most=1000.0), default=PACE, show_default=True,
            help="Of a mission that is watched.",
        ),
    )  # fmt: skip


def watched(mission: StepwiseMission[Any, Any, Any, Any], name: str) -> Hub:
    """Return a hub that gives a simulated mission orders."""

    def give(order: Order) -> str:
        mission.order(order)
        return "given"

    return Hub(name, give)


def beside_of(mission: StepwiseMission[Any, Any, Any, Any], names: Sequence[str], out: Path | None) -> Beside:
    """Return what robots of these names hold and have counted, and whether the disk for results is full."""
    held = [[given.order for given in book.all] for book in mission.books]
    orders, areas = ordered(zip(names, held, strict=True))
    return Beside(
        orders=orders,
        areas=areas,
        alerts=space_alerts(out or Path()),
        counts=dict(enumerate(mission.counts, 1)),
    )


@contextmanager
def opened(hub: Hub, host: str = LOOPBACK, port: int = 0) -> Iterator[WindowServer]:
    """Serve a hub, and say where."""
    from vedette.window.server import WindowServer  # who opens none does not wait for a web server

    with WindowServer(hub, host, port) as window:
        click.echo(f"watch it at {window.address}", err=True)
        yield window


def linger() -> None:
    """Wait for Ctrl-C."""
    ended = threading.Event()
    with ending_on_ctrl_c(ended.set):
        while not ended.wait(0.5):
            pass
