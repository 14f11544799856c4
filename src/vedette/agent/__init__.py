"""The agent: one state machine a robot, run alike by the simulator and by a network process."""

from vedette.agent.agent import step
from vedette.agent.state import Agent, State

__all__ = ["Agent", "State", "step"]
