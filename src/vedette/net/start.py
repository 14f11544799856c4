"""From a robot's file to its running process."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from pathlib import Path

from vedette.agent import NetworkedAgent
from vedette.agent.body import TICK
from vedette.missions.pairs import tell_unheeded, tell_unsaid
from vedette.net.clock import Clockwork, MissionClock, ToldClock
from vedette.net.config import AgentConfig, access_of
from vedette.net.domain import vehicle
from vedette.net.explore.robot import explorer
from vedette.net.inbox import Inbox
from vedette.net.names import robot_name
from vedette.net.process import AgentProcess
from vedette.net.revocations import Revocations
from vedette.net.robot import Robot
from vedette.net.search.robot import searcher
from vedette.net.simulated import staged_faults
from vedette.net.track.robot import tracker
from vedette.net.transport import Transport
from vedette.net.witness import Witness

ROBOTS: Mapping[str, Callable[[AgentConfig, Path, int, float], Robot]] = {
    "explore": explorer,
    "track": tracker,
    "search": searcher,
    "domain": vehicle,
}
EPOCH = datetime(2025, 1, 1, tzinfo=UTC)


def boot_at(now: datetime) -> int:
    """Return the number of a start at a time: it grows from start to start, in steps of 1/16 s.

    A robot whose clock has gone back since its last start is taken for an old one until it catches up.
    """
    return max(int((now - EPOCH).total_seconds() * 16), 0) % (1 << 38)


def time_of_day(now: float) -> float:
    """Return what this host's clock shows when the process's shows ``now`` [s]."""
    return time.time() - time.monotonic() + now


def agent_process(
    config: AgentConfig, folder: Path, speed: float, say: Callable[[str], None] = print
) -> AgentProcess:
    """Open a robot's session and bring it to life; ``folder``: what paths in its file are relative to.

    ``say``: tells whoever watches the process what is wrong with whom, a line each.

    Raises:
        InputError: the map, the scenario, the start, the keys or an endpoint cannot be used.
    """
    _tell_what_is_in_vain(config)
    now = datetime.now(UTC)
    index = config.robot - 1
    begins = None if config.begins is None else time.monotonic() + (config.begins - now).total_seconds()
    shared = MissionClock(speed, begins)
    staged = staged_faults(config, folder, shared)
    robot = ROBOTS[config.mission](config, folder, boot_at(now), speed)
    clock = _clock_of(config, robot, speed, shared)
    inbox = Inbox()
    access = access_of(config, folder, now)
    transport = Transport(access, index, inbox)
    node = NetworkedAgent(
        robot.agent,
        time.monotonic(),
        lease=config.links.lease,
        mission_time=clock.shows,
        tempo=speed,
        terms=robot.terms,
        time_of_day=time_of_day,
        admitted=access.robots,
    )
    mission = "" if robot.judge is None else robot.judge.gate.mission
    witness = Witness(node, robot.body, transport, robot.teller, robot_name(index), mission)
    keys = access.credentials
    revocations = None if keys is None else Revocations(keys, say)
    return AgentProcess(
        node,
        robot.body,
        robot.shown,
        transport,
        inbox,
        witness,
        clock,
        robot.show,
        say,
        revocations,
        staged,
        judge=robot.judge,
    )


def _clock_of(config: AgentConfig, robot: Robot, speed: float, shared: MissionClock) -> Clockwork:
    """Return what the mission's time goes by.

    Robots on the ground begin when they have found each other, each by a clock of its own.
    """
    if robot.time is not None:
        return ToldClock(robot.time, 0.5 * TICK / speed)
    return MissionClock(speed) if config.mission == "explore" else shared


def _tell_what_is_in_vain(config: AgentConfig) -> None:
    """Say which of its options a robot's mission makes nothing of; ``robots`` 0: as many as there are."""
    if (options := config.flies) is not None:
        tell_unsaid(options.coordination, 0, options.scheme, fusion=options.fusion)
    elif config.explore is not None:
        tell_unheeded(config.explore.planner, 0, config.explore.scheme)
