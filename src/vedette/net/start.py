"""From a robot's file to its running process."""

from __future__ import annotations

import time
from datetime import UTC, datetime
from pathlib import Path

from vedette.agent import NetworkedAgent
from vedette.maps.world import World
from vedette.missions.explore.assemble import assemble
from vedette.net.config import AgentConfig, access_of
from vedette.net.inbox import Inbox
from vedette.net.names import robot_name
from vedette.net.process import AgentProcess, MissionClock
from vedette.net.simulated import simulated_robot
from vedette.net.transport import Transport
from vedette.net.witness import Witness
from vedette.team import Most

EPOCH = datetime(2025, 1, 1, tzinfo=UTC)


def boot_at(now: datetime) -> int:
    """Return the number of a start at a time: it grows from start to start, in steps of 1/16 s.

    A robot whose clock has gone back since its last start is taken for an old one until it catches up.
    """
    return max(int((now - EPOCH).total_seconds() * 16), 0) % (1 << 38)


def agent_process(config: AgentConfig, folder: Path, speed: float) -> AgentProcess:
    """Open a robot's session and bring it to life; ``folder``: what paths in its file are relative to.

    Raises:
        InputError: the map, the start, the keys or an endpoint cannot be used.
    """
    now = datetime.now(UTC)
    robot, boot = config.robot - 1, boot_at(now)
    world = World.from_map(folder / config.body.map, config.body.resolution)
    body, best = simulated_robot(config, world), config.best
    agent = assemble(
        world.frame,
        body.hull,
        config.explore,
        robot,
        boot,
        robots=config.robots,
        most=Most.of([body.hull]) if best is None else Most(best.range, best.speed),
        waits_for=config.robots,
    )
    clock = MissionClock(speed)
    inbox = Inbox()
    transport = Transport(access_of(config, folder, now), robot, inbox)
    node = NetworkedAgent(
        agent,
        time.monotonic(),
        lease=config.links.lease,
        mission_time=clock.shows,
    )
    witness = Witness(node, body, transport, robot_name(robot))
    return AgentProcess(node, body, body, transport, inbox, witness, clock)
