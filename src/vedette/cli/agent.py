"""``vedette agent``: one robot's process."""

from __future__ import annotations

import os
import signal
import threading
import time
import warnings
from collections.abc import Callable, Mapping
from contextlib import ExitStack, suppress
from pathlib import Path

import click
from msgspec import ValidationError, convert, to_builtins
from msgspec.structs import replace

from vedette.cli.options import FILE, Positive
from vedette.errors import InputError, InputWarning, brief
from vedette.fusion.standing import signed_by
from vedette.interrupt import ENDINGS
from vedette.net.config import AgentConfig, load_config
from vedette.net.keeping import Keeper, folder_of_a_start
from vedette.net.onlookers import onlooker_of
from vedette.net.process import AgentProcess
from vedette.net.start import agent_process
from vedette.ros2.settings import Ros2Settings

WATCH_PERIOD = 1.0  # [s]


@click.command()
@click.argument("config_path", metavar="CONFIG.yaml", type=FILE)
@click.option(
    "--speed",
    type=Positive("times real time", most=50.0),
    default=1.0,
    show_default=True,
    help="Of the simulated body and the mission, in seconds a second; the same for the whole team.",
)
@click.option(
    "--wait",
    type=Positive("s", most=86400.0),
    help="For a robot that runs ROS 2 to tell what is needed, before the agent ends; else as its file says.",
)
@click.option("--namespace", metavar="NAME", help="Of a robot that runs ROS 2; else as its file says.")
@click.option(
    "--out",
    type=FILE,
    metavar="DIR",
    help="For what it finds out, kept every 30 s and in the end; else as its file says.",
)
@click.option("--starter", type=int, hidden=True, help="Stop when this process, the parent, ends.")
def agent(
    config_path: Path,
    speed: float,
    wait: float | None,
    namespace: str | None,
    out: Path | None,
    starter: int | None,
) -> None:
    """Run the robot that CONFIG.yaml describes, with the neighbours it names, until Ctrl-C or SIGTERM.

    docs/how-to/network.md explains the file. Exit status: 0 stopped, 2 bad input.
    """
    config = load_config(config_path)
    config = told_by_options(config, {"wait": wait, "namespace": namespace})
    folder = config_path.resolve().parent
    try:
        process = agent_process(config, folder, speed, _say)
    except InputError as error:
        raise InputError(f"{config_path}: {error}") from error
    if out is None and config.out is not None:
        out = folder / config.out
    for number in ENDINGS:
        if number == signal.SIGINT or signal.getsignal(number) is not signal.SIG_IGN:  # as nohup has SIGHUP
            signal.signal(number, lambda *_: process.stop())
    if starter is not None:
        threading.Thread(target=_outlive, args=(starter, process.stop), daemon=True).start()
    unsigned = _unsigned(config, process)
    if unsigned is not None:
        _tell(f"vedette: {unsigned}", err=True)
    links = config.links
    _tell(
        f"robot {config.robot} of team {config.team}: listens on {', '.join(links.listen) or 'nothing'}, "
        f"connects to {', '.join(links.connect) or 'nobody'}; stop it with Ctrl-C"
    )
    with process.transport, ExitStack() as kept:
        if out is not None:
            results = kept.enter_context(folder_of_a_start(out))
            flies = config.flies is not None
            onlooker = onlooker_of(config, folder, config.robot - 1) if flies else None
            process.keeper = Keeper(results, config.team, config.mission, _say, onlooker)
        process.run()
    _tell(f"robot {config.robot}: stopped")


def _say(line: str) -> None:
    """Tell whoever watches the process."""
    _tell(f"vedette: {line}", err=True)


def _unsigned(config: AgentConfig, process: AgentProcess) -> str | None:
    """Return what nobody vouches for; None: robots sign what they see."""
    if config.links.insecure:
        return "links are plain TCP: whoever reaches the port can read and write, and nothing is signed"
    if signed_by(process.node.agent.mission.fusion) is not None:
        return None
    return "this way of fusing sends sums of many robots, which nobody can sign: members can change them"


def _tell(line: str, err: bool = False) -> None:
    """Print a line; a robot goes on where that fails, as on a full disk."""
    with suppress(InputError):
        click.echo(line, err=err)


def told_by_options(config: AgentConfig, options: Mapping[str, object]) -> AgentConfig:
    """Return what a robot's file says, but for what options say of how its ROS is reached; None: nothing."""
    told = {name: value for name, value in options.items() if value is not None}
    if config.body.ros2 is None:
        for name in told:
            text = f"--{name} changes nothing: this robot does not run ROS 2"
            warnings.warn(text, InputWarning, stacklevel=2)
        return config
    try:
        ros2 = convert({**to_builtins(config.body.ros2), **told}, Ros2Settings)
    except ValidationError:
        given = brief(told.get("namespace"))
        raise InputError(f"--namespace is {given}; give a name of ROS, say robot1") from None
    return replace(config, body=replace(config.body, ros2=ros2))


def _outlive(starter: int, stop: Callable[[], None]) -> None:
    """Wait for the process that started this one to end, however it does; then stop."""
    while os.getppid() == starter:
        time.sleep(WATCH_PERIOD)
    stop()
