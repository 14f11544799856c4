"""The agent: one state machine a robot, the same in the simulator and on a network.

``step(agent, events, now) -> effects`` has no I/O, no clock and no randomness of its own. One turn of the loop is
observation -> evidence -> belief -> strategies -> impact -> negotiation -> decision -> goal.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from vedette.agent import messages
from vedette.agent.driving import YIELD_LIMIT, Driver
from vedette.agent.effects import Drive, Effect, Send, Traffic
from vedette.agent.events import Arrived, Event, JobDone, Message, Pose, Scan, Stuck, TreeChanged
from vedette.agent.mates import Mates
from vedette.agent.messages import Beacon
from vedette.agent.mission import Mission
from vedette.agent.rounds import Decision, Rounds
from vedette.maps import GridFrame
from vedette.team import PlatformSpec

BEACON_PERIOD = 0.25  # [s]
LOOK_OUT_PERIOD = 0.5  # [s]
CHECK_PERIOD = 1.0  # of the present goal's point [s]
SHARE_PERIOD = 2.0  # evidence travels at least so often, rounds or not [s]
QUIET_ROUNDS = 2  # so many rounds in a row with nothing to gain for anybody end the mission


class State(Enum):
    """What a robot is doing, as people are shown it."""

    WAITING = "waiting"  # for its first plan
    DRIVING = "driving"
    YIELDING = "making room"
    STUCK = "stuck"
    IDLE = "idle"  # nothing it can do is worth doing
    RETURNING = "returning"
    DONE = "done"


@dataclass
class Agent:
    """One robot's whole state."""

    robot: int
    boot: int
    spec: PlatformSpec
    frame: GridFrame
    mission: Mission
    scheme: str = "token"
    return_home: bool = False
    state: State = State.WAITING
    pose: Pose | None = None
    home: tuple[float, float] | None = None
    dropped: int = 0  # messages that did not make sense
    mates: Mates = field(default_factory=Mates)
    rounds: Rounds = field(init=False)
    driver: Driver = field(init=False)
    _quiet: int = 0
    _beacons: int = 0
    _due: dict[str, float] = field(default_factory=dict)
    _redirect: bool = False  # a new decision waits to be driven

    def __post_init__(self) -> None:
        self.rounds = Rounds(self.mission, self.scheme, self._decided)
        self.driver = Driver(self.robot, self.spec, self.frame)

    @property
    def finished(self) -> bool:
        """Tell whether the team has agreed that nothing is left to gain."""
        return self._quiet >= QUIET_ROUNDS

    @property
    def done(self) -> bool:
        """Tell whether this robot has nothing left to do, the way home included."""
        return self.state is State.DONE

    def _decided(self, decision: Decision) -> None:
        nothing_to_gain = decision.outcome.value <= 0.0 and not decision.approximate
        self._quiet = self._quiet + 1 if nothing_to_gain else 0
        self._redirect = True


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
            try:
                return _hear(agent, sender, messages.decode(payload), now)
            except ValueError:  # malformed, or out of place: a sender's fault, counted, never ours
                agent.dropped += 1
        case Pose():
            agent.pose = event
            agent.home = agent.home or (event.x, event.y)
        case Scan() if agent.pose is not None:
            agent.mission.observe(event, agent.pose, agent.mates.all(), now)
        case Arrived():
            return _arrived(agent, now)
        case Stuck():
            return _stuck(agent, now)
        case JobDone(key):
            return agent.rounds.prepared(key, now)
        case TreeChanged():
            agent.rounds.join(event)
            agent.mission.fusion.set_neighbours(event.neighbours)
    return []


def _hear(agent: Agent, sender: int, message: messages.Wire, now: float) -> list[Effect]:
    if sender not in agent.rounds.tree.neighbours:
        return []
    match message:
        case Beacon():
            if message.robot == agent.robot or not agent.mates.hear(message, now):
                return []
            return _beacon_to(agent, message, [k for k in agent.rounds.tree.neighbours if k != sender])
        case messages.Evidence(data):
            agent.mission.fusion.receive(sender, data, now)
        case messages.Call(epoch) if epoch == agent.rounds.tree.epoch:
            return agent.rounds.call(now)
        case messages.Begin():
            return agent.rounds.begin(message, now)
        case messages.Flushed():
            return agent.rounds.flushed(sender, message, now)
        case messages.Freeze():
            return agent.rounds.freeze(message, now)
        case messages.Negotiate():
            return agent.rounds.negotiate(sender, message, now)
    return []


def _go_on(agent: Agent, pose: Pose, now: float) -> list[Effect]:
    """Do what time and the latest decisions ask for."""
    effects = agent.rounds.tick(now) if not agent.finished or agent.rounds.busy else []
    if agent._redirect:
        agent._redirect = False
        effects += _follow_decision(agent, pose, now)
    if agent.rounds.frozen:
        effects.append(agent.rounds.preparation(pose, agent.mates.all(), now))
    if _is_due(agent, "beacon", BEACON_PERIOD, now):
        effects += _beacon(agent, pose)
    if _is_due(agent, "look out", LOOK_OUT_PERIOD, now):
        effects += _look_out(agent, pose, now)
    if _is_due(agent, "check", CHECK_PERIOD, now) and agent.state is State.DRIVING and agent.mission.served():
        agent.rounds.want()
    if _is_due(agent, "share", SHARE_PERIOD, now) and not agent.rounds.busy:
        agent.mission.publish(now)
        for neighbour in agent.rounds.tree.neighbours:
            effects += agent.rounds.news(neighbour, now)
    return effects


def _is_due(agent: Agent, what: str, period: float, now: float) -> bool:
    if now < agent._due.get(what, -1.0) - 1e-9:
        return False
    agent._due[what] = now + period
    return True


# -- driving ----------------------------------------------------------------------------------------


def _follow_decision(agent: Agent, pose: Pose, now: float) -> list[Effect]:
    if not agent.finished:
        return _drive_on(agent, pose, now)
    if agent.done or agent.state is State.RETURNING:
        return []
    if not agent.return_home or agent.home is None:
        agent.state = State.DONE
        return [agent.driver.go(None)]
    return _go_home(agent, pose, now, blocked=False)


def _go_home(agent: Agent, pose: Pose, now: float, *, blocked: bool) -> list[Effect]:
    assert agent.home
    agent.state = State.RETURNING
    return [agent.driver.go(agent.mission.route(pose, agent.home, agent.mates.all(), blocked, now))]


def _drive_on(agent: Agent, pose: Pose, now: float) -> list[Effect]:
    """Drive to the strategy's next goal; with none, stand by."""
    goal = agent.mission.goal()
    if goal is None:
        agent.state = State.IDLE
        return [agent.driver.go(None)]
    if agent.driver.yielding:
        return []
    route = agent.mission.route(pose, goal, agent.mates.all(), agent.state is State.STUCK, now)
    if route is None:
        agent.mission.release(now)
        agent.rounds.want()
        agent.state = State.IDLE
    else:
        agent.state = State.DRIVING
    return [agent.driver.go(route)]


def _arrived(agent: Agent, now: float) -> list[Effect]:
    if agent.pose is None or agent.driver.yielding or agent.driver.wanted is None:
        return []
    if agent.state is State.RETURNING:
        agent.state = State.DONE
        return [agent.driver.go(None)]
    if agent.state is not State.DRIVING:
        return []
    agent.mission.reached(now)
    agent.rounds.want()
    return _drive_on(agent, agent.pose, now)


def _stuck(agent: Agent, now: float) -> list[Effect]:
    """Release the work at once, so that others can take it, and plan round what is in the way."""
    assert agent.pose
    if agent.state is State.RETURNING:
        return _go_home(agent, agent.pose, now, blocked=True)
    if agent.state is not State.DRIVING and not agent.driver.yielding:
        return []
    agent.mission.release(now)
    agent.state = State.STUCK
    agent.rounds.blocked = True
    agent.rounds.want()
    return [agent.driver.go(None)]


def _look_out(agent: Agent, pose: Pose, now: float) -> list[Effect]:
    mates = agent.mates.all()
    if not mates:
        return []
    if agent.driver.yielding and now > agent.driver.yielding_since + YIELD_LIMIT:
        return _stuck(agent, now)
    standing = agent.driver.wanted or agent.mission.route(pose, (pose.x, pose.y), mates, False, now)
    if standing is None:
        return []
    drive: Drive | None = agent.driver.look_out(pose, mates, standing, now)
    if agent.driver.yielding and agent.state is State.DRIVING:
        agent.state = State.YIELDING
    elif not agent.driver.yielding and agent.state is State.YIELDING:
        return _drive_on(agent, pose, now)
    return [] if drive is None else [drive]


# -- beacons ----------------------------------------------------------------------------------------


def _beacon(agent: Agent, pose: Pose) -> list[Effect]:
    path = agent.driver.beaconed(pose)
    offsets = np.rint((path - (pose.x, pose.y)) * 100.0).astype(int)
    agent._beacons += 1
    beacon = Beacon(
        agent.robot,
        agent.boot,
        agent._beacons,
        round(pose.x * 100),
        round(pose.y * 100),
        round(pose.heading * 1000),
        round(pose.slowed * 10),
        tuple(offsets.ravel().tolist()),
    )
    return _beacon_to(agent, beacon, agent.rounds.tree.neighbours)


def _beacon_to(agent: Agent, beacon: Beacon, neighbours: Iterable[int]) -> list[Effect]:
    payload = messages.encode(beacon)
    return [Send(neighbour, Traffic.BEACONS, payload) for neighbour in neighbours]
