"""The agent: one state machine a robot, the same in the simulator and on a network.

``step(agent, events, now) -> effects`` has no I/O, no clock and no randomness of its own. One turn of the
loop is observation -> evidence -> belief -> strategies -> impact -> negotiation -> decision -> goal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

from vedette.agent import beacons, messages, obeying
from vedette.agent.effects import Effect, Send, Shun, TrafficKind
from vedette.agent.events import (
    Arrived,
    CertificatesRevoked,
    Event,
    JobDone,
    Message,
    Ordered,
    Pose,
    Scan,
    Sensed,
    Stuck,
    TreeChanged,
)
from vedette.agent.messages import Beacon, Beacons, Vouched
from vedette.agent.state import Agent
from vedette.errors import PartError

BEACON_PERIOD = 0.25  # [s]
SHARE_PERIOD = 2.0  # evidence travels at least so often, rounds or not [s]
SETTLED_PERIOD = 10.0  # one's own, of who is done: what flickers before it has time to reach everybody [s]


def step(agent: Agent, events: Iterable[Event], now: float) -> list[Effect]:
    """Let an agent take in events at a time [s]; return what it wants done."""
    effects: list[Effect] = []
    for event in events:
        effects += _take(agent, event, now)
    effects += agent.relay.pass_on()
    if agent.pose is not None:
        effects += _go_on(agent, agent.pose, now)
    return effects


def _take(agent: Agent, event: Event, now: float) -> list[Effect]:
    match event:
        case Message(sender, payload):
            return _guarded(agent, sender, lambda: _listen(agent, sender, payload, now))
        case Pose():
            agent.pose, agent.posed = event, now
        case Scan() | Sensed():
            agent.behaviour.sense(agent, event, now)
        case Arrived() | Stuck():
            return agent.behaviour.moved(agent, event, now)
        case JobDone(key):
            return _prepared(agent, key, now)
        case TreeChanged():
            if event.epoch != agent.rounds.tree.epoch:
                agent.quiet = min(agent.quiet, 1)  # who is new may know of something left to do
            agent.rounds.join(event, now)
            agent.mission.fusion.set_neighbours(event.neighbours)
            return obeying.tell_all(agent)
        case CertificatesRevoked(robots) if agent.signed is not None and agent.signed.standing.revoke(robots):
            agent.signed.heed()
        case Ordered(order):
            return obeying.take(agent, [order], None)
    return []


def _guarded(agent: Agent, sender: int, hear: Callable[[], list[Effect]]) -> list[Effect]:
    """Hear a message; one that is malformed or out of place is the sender's fault: counted, never ours."""
    try:
        return hear()
    except PartError:
        raise
    except ValueError:
        agent.dropped += 1
        agent.dropped_of[sender] += 1
        return []


def _prepared(agent: Agent, key: tuple[int, int], now: float) -> list[Effect]:
    """Start negotiating, and take in what came before this robot was ready."""
    effects = agent.rounds.prepared(key, now)
    for sender, message in agent.rounds.take_early():
        effects += _guarded(agent, sender, partial(agent.rounds.negotiate, sender, message, now))
    return effects


def _listen(agent: Agent, sender: int, payload: bytes, now: float) -> list[Effect]:
    effects = _hear(agent, sender, payload, now)
    agent.rounds.heard(sender, now)
    return effects


def _hear(agent: Agent, sender: int, payload: bytes, now: float) -> list[Effect]:
    message = messages.decode(payload)
    if sender not in agent.rounds.tree.neighbours:
        return []
    from_parent = sender == agent.rounds.tree.parent
    match message:
        case Beacon() | Vouched():
            return beacons.hear(agent, sender, payload, now)
        case Beacons(told):
            told_on = partial(beacons.hear, agent, sender)
            heard = [_guarded(agent, sender, partial(told_on, each, now)) for each in told]
            return [effect for effects in heard for effect in effects]
        case messages.Evidence(data):
            agent.mission.fusion.receive(sender, data, now)
            beacons.take_places(agent, now)
            return _without_forger(agent, sender)
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
        case messages.Orders(told):
            return obeying.take(agent, told, sender)
        case messages.Audit() if agent.rounds.scrutiny.auditor is not None:
            return agent.rounds.scrutiny.auditor.ask(sender, message, agent.rounds.tree.neighbours, now)
        case messages.Account() if agent.rounds.scrutiny.auditor is not None:
            return agent.rounds.scrutiny.auditor.hear(sender, message, agent.rounds.tree.neighbours)
        case messages.Proof() if agent.proofs is not None:
            return agent.proofs.hear(sender, message, agent.rounds.tree.neighbours)
        case messages.Proven() if agent.proofs is not None:
            return agent.proofs.hear_proven(sender, message)
    return []


def _without_forger(agent: Agent, sender: int) -> list[Effect]:
    """Do without the link to a neighbour that has changed what it passes on."""
    if agent.signed is None or sender not in agent.signed.standing.forgers:
        return []
    agent.signed.standing.forgers.discard(sender)
    return [Shun(sender)]


def _go_on(agent: Agent, pose: Pose, now: float) -> list[Effect]:
    """Do what time and the latest decisions ask for."""
    agent.awake = agent.behaviour.wake(agent, pose, now)
    takes_part = (agent.awake and not agent.finished) or agent.rounds.busy
    effects = agent.rounds.tick(now) if takes_part else []
    if agent.proofs is not None:
        effects += agent.proofs.tick(agent.rounds.tree.neighbours, now)
    news, agent.news = agent.news, False
    effects += agent.behaviour.follow(agent, pose, now, news)
    if agent.framing is not None and agent.awake:
        agent.framing.meet(agent.mates.heard, now)
    belief = agent.rounds.frozen
    if belief is not None:
        start = agent.behaviour.departure(agent, pose, belief)
        effects.append(agent.rounds.preparation(start, agent.mates.all(), now))
    elif agent.framing is not None and not agent.rounds.busy and agent.awake:
        living = {agent.robot, *(mate.robot for mate in agent.mates.heard if not mate.silent(now))}
        job = agent.framing.errand(living, now)
        effects += [] if job is None else [job]
    if agent.is_due("beacon", BEACON_PERIOD, now):
        agent.relay.look(agent.mates.heard, agent.rounds.tree.neighbours, now)
        own = beacons.tell(agent, pose)
        effects += [Send(neighbour, TrafficKind.BEACONS, own) for neighbour in agent.rounds.tree.neighbours]
    effects += agent.behaviour.look_out(agent, pose, now)
    shared = agent.signed is not None and now < agent.rounds.began + SHARE_PERIOD  # and a signature is dear
    if not shared and agent.is_due("share", SHARE_PERIOD, now) and not agent.rounds.busy:
        if not agent.done or agent.is_due("settled", SETTLED_PERIOD, now):
            agent.mission.publish(now)
        for neighbour in agent.rounds.tree.neighbours:
            effects += agent.rounds.news(neighbour, now)
    return effects
