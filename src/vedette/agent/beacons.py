"""Beacons: where robots are, told to everybody over the tree."""

from __future__ import annotations

from math import ceil

import numpy as np

from vedette.agent import messages
from vedette.agent.effects import Effect, Shun
from vedette.agent.events import Pose
from vedette.agent.messages import Beacon, Vouched
from vedette.agent.state import Agent

SIGNED = 4  # one beacon in so many is signed, where there are keys: those alone are passed on
BEACON = "beacon"


def tell(agent: Agent, pose: Pose) -> bytes:
    """Return this robot's beacon, some of them signed where there are keys."""
    path = agent.behaviour.ahead(pose)
    offsets = np.rint((path - (pose.x, pose.y)) * 100.0).astype(int)
    agent.beacons += 1
    beacon = Beacon(
        agent.robot,
        agent.boot,
        agent.beacons,
        round(pose.x * 100),
        round(pose.y * 100),
        round(pose.heading * 1000),
        round(pose.slowed * 10),
        ceil(agent.hull.radius * 100),
        max(ceil(agent.hull.speed * 100), 1),
        tuple(offsets.ravel().tolist()),
    )
    data = messages.encode(beacon)
    if agent.signed is None or agent.beacons % SIGNED:
        return data
    return messages.encode(Vouched(data, agent.signed.notary.sign(BEACON, data)))


def hear(agent: Agent, sender: int, told: bytes, now: float) -> list[Effect]:
    """Keep a mate's beacon, and pass it on.

    Where there are keys, an unsigned one is its maker's own, from its own link, and goes no farther: a
    signature each would take more bytes than the beacons do, and a mate that is links away is seldom near.

    Raises:
        ValueError: malformed, of a robot that the team cannot have, or of another than its link's, unsigned.
    """
    message = messages.decode_told(told)
    if isinstance(message, Vouched):
        return _hear_vouched(agent, sender, message, told, now)
    if agent.signed is not None and message.robot != sender:
        raise ValueError(f"beacon of robot {message.robot} from robot {sender}, unsigned")
    if message.robot != agent.robot and agent.mates.hear(message, now, sender) and agent.signed is None:
        agent.relay.hear(message.robot, told, sender, agent.rounds.tree.neighbours, now)
    return []


def _hear_vouched(agent: Agent, sender: int, message: Vouched, told: bytes, now: float) -> list[Effect]:
    beacon = messages.decode_beacon(message.beacon)
    if agent.signed is None:
        raise ValueError("a signed beacon, where nobody signs")
    if beacon.robot == agent.robot or not agent.signed.notary.knows(beacon.robot):
        return []  # its certificate comes with its evidence
    try:
        agent.signed.notary.check(beacon.robot, message.signature, BEACON, message.beacon)
    except ValueError as error:
        agent.signed.accuse(sender, f"a beacon of robot-{beacon.robot + 1} is not that robot's: {error}")
        return [Shun(sender)]
    if agent.mates.hear(beacon, now, sender, signed=True):
        agent.relay.hear(beacon.robot, told, sender, agent.rounds.tree.neighbours, now)
    return []
