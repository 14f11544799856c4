"""The agent: one state machine a robot, the same in the simulator and on a network.

``step(agent, events, now) -> effects`` has no I/O, no clock and no randomness of its own. One turn of the
loop is observation -> evidence -> belief -> strategies -> impact -> negotiation -> decision -> goal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from math import ceil

import numpy as np

from vedette.agent import behaviour, messages
from vedette.agent.effects import Effect, Send, Traffic
from vedette.agent.events import Arrived, Event, JobDone, Message, Pose, Scan, Stuck, TreeChanged
from vedette.agent.messages import Beacon
from vedette.agent.state import Agent, State

BEACON_PERIOD = 0.25  # [s]
LOOK_OUT_PERIOD = 0.5  # [s]
CHECK_PERIOD = 1.0  # of the present goal's point [s]
SHARE_PERIOD = 2.0  # evidence travels at least so often, rounds or not [s]
LISTEN = 3.0  # a robot waits at most so long for its mates' first beacons before it maps [s]


def step(agent: Agent, events: Iterable[Event], now: float) -> list[Effect]:
    """Let an agent take in events at a time [s]; return what it wants done."""
    effects: list[Effect] = []
    for event in events:
        effects += _take(agent, event, now)
    if agent.pose is not None:
        effects += _go_on(agent, agent.pose, now)
    return effects


def _take(agent: Agent, event: Event, now: float) -> list[Effect]:
    match event:
        case Message(sender, payload):
            return _guarded(agent, lambda: _hear(agent, sender, messages.decode(payload), now))
        case Pose():
            agent.pose = event
            agent.home = agent.home or (event.x, event.y)
        case Scan() if agent.listening:
            agent.held = event
        case Scan() if agent.pose is not None:
            agent.mission.observe(event, agent.pose, agent.mates.all(), now)
        case Arrived():
            return behaviour.arrived(agent, now)
        case Stuck():
            return behaviour.stuck(agent, now)
        case JobDone(key):
            return _prepared(agent, key, now)
        case TreeChanged():
            agent.rounds.join(event)
            agent.mission.fusion.set_neighbours(event.neighbours)
    return []


def _guarded(agent: Agent, hear: Callable[[], list[Effect]]) -> list[Effect]:
    """Hear a message; one that is malformed or out of place is the sender's fault: counted, never ours."""
    try:
        return hear()
    except ValueError:
        agent.dropped += 1
        return []


def _prepared(agent: Agent, key: tuple[int, int], now: float) -> list[Effect]:
    """Start negotiating, and take in what came before this robot was ready."""
    effects = agent.rounds.prepared(key, now)
    for sender, message in agent.rounds.take_early():
        effects += _guarded(agent, partial(agent.rounds.negotiate, sender, message, now))
    return effects


def _hear(agent: Agent, sender: int, message: messages.Wire, now: float) -> list[Effect]:
    if sender not in agent.rounds.tree.neighbours:
        return []
    from_parent = sender == agent.rounds.tree.parent
    match message:
        case Beacon():
            if message.robot == agent.robot or not agent.mates.hear(message, now):
                return []
            return _beacon_to(agent, message, [k for k in agent.rounds.tree.neighbours if k != sender])
        case messages.Evidence(data):
            agent.mission.fusion.receive(sender, data, now)
        case messages.Call(epoch) if epoch == agent.rounds.tree.epoch and not from_parent:
            return agent.rounds.call(now)
        case messages.Begin() if from_parent:
            return agent.rounds.begin(message, now)
        case messages.Flushed():
            return agent.rounds.flushed(sender, message, now)
        case messages.Freeze() if from_parent:
            return agent.rounds.freeze(message, now)
        case messages.Negotiate():
            return agent.rounds.negotiate(sender, message, now)
    return []


def _go_on(agent: Agent, pose: Pose, now: float) -> list[Effect]:
    """Do what time and the latest decisions ask for."""
    if agent.listening:
        _listen(agent, pose, now)
    wakeful = not agent.listening and not agent.finished
    effects = agent.rounds.tick(now) if wakeful or agent.rounds.busy else []
    if agent.redirect:
        agent.redirect = False
        effects += behaviour.follow_decision(agent, pose, now)
    if agent.rounds.frozen:
        effects.append(agent.rounds.preparation(pose, agent.mates.all(), now))
    if (
        agent.state is State.RETURNING
        and agent.driver.standing
        and agent.is_due("home", behaviour.HOME_AGAIN, now)
    ):
        effects += behaviour.go_home(agent, pose, now, blocked=False)
    if agent.is_due("beacon", BEACON_PERIOD, now):
        effects += _beacon(agent, pose)
    if agent.is_due("look out", LOOK_OUT_PERIOD, now):
        effects += behaviour.look_out(agent, pose, now)
    if agent.is_due("check", CHECK_PERIOD, now) and agent.state is State.DRIVING and agent.mission.served():
        agent.rounds.want()
    if agent.is_due("share", SHARE_PERIOD, now) and not agent.rounds.busy:
        agent.mission.publish(now)
        for neighbour in agent.rounds.tree.neighbours:
            effects += agent.rounds.news(neighbour, now)
    return effects


def _listen(agent: Agent, pose: Pose, now: float) -> None:
    """Begin to map once the mates' places are known, so that they are not taken for obstacles."""
    until = agent.due.setdefault("listen", now + LISTEN)
    if len(agent.mates.all()) < agent.rounds.tree.size - 1 and now < until:
        return
    agent.listening = False
    if agent.held is not None:
        agent.mission.observe(agent.held, pose, agent.mates.all(), now)
        agent.held = None


def _beacon(agent: Agent, pose: Pose) -> list[Effect]:
    path = agent.driver.beaconed(pose)
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
        ceil(agent.spec.radius * 100),
        ceil(agent.spec.speed * 100),
        tuple(offsets.ravel().tolist()),
    )
    return _beacon_to(agent, beacon, agent.rounds.tree.neighbours)


def _beacon_to(agent: Agent, beacon: Beacon, neighbours: Iterable[int]) -> list[Effect]:
    payload = messages.encode(beacon)
    return [Send(neighbour, Traffic.BEACONS, payload) for neighbour in neighbours]
