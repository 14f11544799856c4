"""What a robot does with its strategy: drives on, arrives, gets stuck, makes room, goes home."""

from __future__ import annotations

from math import hypot

from vedette.agent.driving import YIELD_LIMIT
from vedette.agent.effects import Drive, Effect
from vedette.agent.events import Pose
from vedette.agent.state import Agent, State

HOME = 0.3  # from its start a robot is at home [m]
HOME_AGAIN = 3.0  # a robot whose way home is blocked tries again after so long [s]
HOME_TRIES = 10  # then it stays where it is


def follow_decision(agent: Agent, pose: Pose, now: float) -> list[Effect]:
    """Drive where the latest decision wants the robot; after the last one, home or nowhere."""
    if not agent.finished:
        return _drive_on(agent, pose, now)
    if agent.done or agent.state is State.RETURNING:
        return []
    if not agent.return_home or agent.home is None:
        agent.state = State.DONE
        return [agent.driver.go(None)]
    return go_home(agent, pose, now, blocked=False)


def go_home(agent: Agent, pose: Pose, now: float, *, blocked: bool) -> list[Effect]:
    """Drive to where the robot started."""
    assert agent.home
    route = agent.mission.route(pose, agent.home, agent.mates.all(), blocked, now)
    if route is None:
        return _wait_for_home(agent, now)
    agent.state = State.RETURNING
    return [agent.driver.go(route)]


def _wait_for_home(agent: Agent, now: float) -> list[Effect]:
    """Stand for a while where the way home, or home itself, is taken; in the end stay here."""
    agent.home_tries += 1
    agent.due["home"] = now + HOME_AGAIN
    agent.state = State.RETURNING if agent.home_tries <= HOME_TRIES else State.DONE
    return [agent.driver.go(None)]


def _at_home(agent: Agent, pose: Pose) -> bool:
    return agent.home is None or hypot(pose.x - agent.home[0], pose.y - agent.home[1]) <= HOME


def _strayed(agent: Agent, pose: Pose) -> bool:
    """Tell whether the robot, done, had to make room and could go home again."""
    return agent.return_home and agent.home_tries <= HOME_TRIES and not _at_home(agent, pose)


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


def arrived(agent: Agent, now: float) -> list[Effect]:
    """Go on to the next stop; at home, be done."""
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


def stuck(agent: Agent, now: float) -> list[Effect]:
    """Release the work at once, so that others can take it, and plan round what is in the way."""
    if agent.pose is None:
        return []
    if agent.state is State.RETURNING:
        return go_home(agent, agent.pose, now, blocked=True)
    if agent.done:
        return [agent.driver.go(None)]
    if agent.state is not State.DRIVING and not agent.driver.yielding:
        return []
    agent.mission.release(now)
    agent.state = State.STUCK
    agent.rounds.blocked = True
    agent.rounds.want()
    return [agent.driver.go(None)]


def look_out(agent: Agent, pose: Pose, now: float) -> list[Effect]:
    """Make room for a mate that has the right of way, and go on when it has passed."""
    mates = agent.mates.all()
    if not mates:
        return []
    if agent.driver.yielding and now > agent.driver.yielding_since + YIELD_LIMIT:
        return stuck(agent, now)
    standing = agent.driver.wanted or agent.mission.route(pose, (pose.x, pose.y), mates, False, now)
    if standing is None:
        return []
    drive: Drive | None = agent.driver.look_out(pose, mates, standing, now)
    if agent.driver.yielding and agent.state is State.DRIVING:
        agent.state = State.YIELDING
    elif not agent.driver.yielding and agent.state is State.YIELDING:
        return _drive_on(agent, pose, now)
    elif agent.done and agent.driver.standing and _strayed(agent, pose):
        return go_home(agent, pose, now, blocked=False)
    return [] if drive is None else [drive]
