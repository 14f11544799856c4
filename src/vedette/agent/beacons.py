"""Beacons: where robots are, told to everybody over the tree."""

from __future__ import annotations

from math import ceil

import numpy as np

from vedette.agent import messages
from vedette.agent.effects import Effect, Shun
from vedette.agent.events import Pose
from vedette.agent.messages import Beacon, Vouched
from vedette.agent.state import Agent
from vedette.fusion.seals import BEACON

SIGNED = 8  # one beacon in so many is signed where there are keys, but for what evidence tells of the place
FIRST, INTRODUCES = 4, 1  # so many of the first ones are signed, and bring the certificate


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
    if agent.signed is None:
        return data
    agent.signed.be_at(beacon.sequence, beacon.x, beacon.y)
    if agent.beacons > FIRST and (agent.beacons % SIGNED or agent.signed.covers):
        return data
    notary = agent.signed.standing.notary
    certificate = notary.certificate if agent.beacons <= INTRODUCES else b""
    return messages.encode(Vouched(data, notary.sign(BEACON, data), certificate))


def hear(agent: Agent, sender: int, told: bytes, now: float) -> list[Effect]:
    """Keep a mate's beacon, and pass it on.

    Where there are keys, an unsigned one that is passed on is believed as far as it agrees with the last
    that its robot has signed, or said itself: a signature each would take more bytes than the beacons do.

    Raises:
        ValueError: malformed, or of a robot that the team cannot have.
    """
    message = messages.decode_told(told)
    if isinstance(message, Vouched):
        return _hear_vouched(agent, sender, message, told, now)
    passed_on = agent.signed is not None and message.robot != sender
    if message.robot == agent.robot or (passed_on and not agent.mates.is_likely(message, now)):
        return []
    if agent.mates.hear(message, now, sender, passed_on=passed_on):
        agent.relay.hear(message.robot, told, sender, agent.rounds.tree.neighbours, now)
    return []


def _hear_vouched(agent: Agent, sender: int, message: Vouched, told: bytes, now: float) -> list[Effect]:
    beacon = messages.decode_beacon(message.beacon)
    if agent.signed is None:
        raise ValueError("a signed beacon, where nobody signs")
    notary, gone = agent.signed.standing.notary, agent.signed.standing.gone
    if beacon.robot in (agent.robot, *gone) or not (message.certificate or notary.knows(beacon.robot)):
        return []  # nothing of it counts, or its certificate comes with its evidence
    try:
        if message.certificate:
            notary.admit(beacon.robot, message.certificate)
        notary.check(beacon.robot, message.signature, BEACON, message.beacon)
    except ValueError as error:
        about = f"a beacon of robot-{beacon.robot + 1} is not that robot's: {error}"
        agent.signed.standing.complaints[sender] = about
        return [Shun(sender)]
    if agent.mates.hear(beacon, now, sender, signed=True):
        agent.relay.hear(beacon.robot, told, sender, agent.rounds.tree.neighbours, now, proves=True)
    return []


def take_places(agent: Agent, now: float) -> None:
    """Take in where robots are by what they have signed with their evidence."""
    if agent.signed is not None:
        for (robot, boot), (place, signed) in agent.signed.take_places().items():
            stamp = boot, place.sequence
            if agent.mates.is_new(robot, stamp, now):
                agent.signed.standing.dates(robot, signed)
            agent.mates.prove(robot, stamp, place.x / 100.0, place.y / 100.0, now)
