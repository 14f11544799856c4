"""The agent: one state machine a robot, the same in the simulator and on a network.

``step(agent, events, now) -> effects`` has no I/O, no clock and no randomness of its own. One turn of the
loop is observation -> evidence -> belief -> strategies -> impact -> negotiation -> decision -> goal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from enum import Enum
from functools import partial
from math import ceil, hypot

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
LISTEN = 3.0  # a robot waits at most so long for its mates' first beacons before it maps [s]
QUIET_ROUNDS = 2  # so many rounds in a row with nothing to gain for anybody end the mission
HOME = 0.3  # from its start a robot is at home [m]
HOME_AGAIN = 3.0  # a robot whose way home is blocked tries again after so long [s]
HOME_TRIES = 10  # then it stays where it is


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
    _home_tries: int = 0
    _beacons: int = 0
    _listening: bool = True  # until all mates have been heard, or for a while: they are not to be mapped
    _held: Scan | None = None  # the latest scan while listening
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
        everything = not decision.approximate and not decision.blocked
        everything &= not self.mission.postponed(decision.time)
        nothing_to_gain = decision.outcome.value <= 0.0 and everything
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
            return _guarded(agent, lambda: _hear(agent, sender, messages.decode(payload), now))
        case Pose():
            agent.pose = event
            agent.home = agent.home or (event.x, event.y)
        case Scan() if agent._listening:
            agent._held = event
        case Scan() if agent.pose is not None:
            agent.mission.observe(event, agent.pose, agent.mates.all(), now)
        case Arrived():
            return _arrived(agent, now)
        case Stuck():
            return _stuck(agent, now)
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
    if agent._listening:
        _listen(agent, pose, now)
    wakeful = not agent._listening and not agent.finished
    effects = agent.rounds.tick(now) if wakeful or agent.rounds.busy else []
    if agent._redirect:
        agent._redirect = False
        effects += _follow_decision(agent, pose, now)
    if agent.rounds.frozen:
        effects.append(agent.rounds.preparation(pose, agent.mates.all(), now))
    if agent.state is State.RETURNING and agent.driver.standing and _is_due(agent, "home", HOME_AGAIN, now):
        effects += _go_home(agent, pose, now, blocked=False)
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


def _listen(agent: Agent, pose: Pose, now: float) -> None:
    """Begin to map once the mates' places are known, so that they are not taken for obstacles."""
    until = agent._due.setdefault("listen", now + LISTEN)
    if len(agent.mates.all()) < agent.rounds.tree.size - 1 and now < until:
        return
    agent._listening = False
    if agent._held is not None:
        agent.mission.observe(agent._held, pose, agent.mates.all(), now)
        agent._held = None


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
    route = agent.mission.route(pose, agent.home, agent.mates.all(), blocked, now)
    if route is None:
        return _wait_for_home(agent, now)
    agent.state = State.RETURNING
    return [agent.driver.go(route)]


def _wait_for_home(agent: Agent, now: float) -> list[Effect]:
    """Stand for a while where the way home, or home itself, is taken; in the end stay here."""
    agent._home_tries += 1
    agent._due["home"] = now + HOME_AGAIN
    agent.state = State.RETURNING if agent._home_tries <= HOME_TRIES else State.DONE
    return [agent.driver.go(None)]


def _at_home(agent: Agent, pose: Pose) -> bool:
    return agent.home is None or hypot(pose.x - agent.home[0], pose.y - agent.home[1]) <= HOME


def _strayed(agent: Agent, pose: Pose) -> bool:
    """Tell whether the robot, done, had to make room and could go home again."""
    return agent.return_home and agent._home_tries <= HOME_TRIES and not _at_home(agent, pose)


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
        if not _at_home(agent, agent.pose):
            return _wait_for_home(agent, now)
        agent.state = State.DONE
        return [agent.driver.go(None)]
    if agent.state is not State.DRIVING:
        return []
    agent.mission.reached(agent.pose, agent.mates.all(), now)
    agent.rounds.want()
    return _drive_on(agent, agent.pose, now)


def _stuck(agent: Agent, now: float) -> list[Effect]:
    """Release the work at once, so that others can take it, and plan round what is in the way."""
    if agent.pose is None:
        return []
    if agent.state is State.RETURNING:
        return _go_home(agent, agent.pose, now, blocked=True)
    if agent.done:
        return [agent.driver.go(None)]
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
    elif agent.done and agent.driver.standing and _strayed(agent, pose):
        return _go_home(agent, pose, now, blocked=False)
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
        ceil(agent.spec.radius * 100),
        ceil(agent.spec.speed * 100),
        tuple(offsets.ravel().tolist()),
    )
    return _beacon_to(agent, beacon, agent.rounds.tree.neighbours)


def _beacon_to(agent: Agent, beacon: Beacon, neighbours: Iterable[int]) -> list[Effect]:
    payload = messages.encode(beacon)
    return [Send(neighbour, Traffic.BEACONS, payload) for neighbour in neighbours]
