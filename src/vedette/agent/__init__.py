"""The agent: one state machine a robot, run alike by the simulator and by a network process."""

from vedette.agent.agent import step
from vedette.agent.flying import FlightBehaviour
from vedette.agent.ground import GroundBehaviour
from vedette.agent.networked import Datagram, NetworkedAgent
from vedette.agent.pace import Pace
from vedette.agent.state import Agent, Behaviour, State

__all__ = [
    "Agent",
    "Behaviour",
    "Datagram",
    "FlightBehaviour",
    "GroundBehaviour",
    "NetworkedAgent",
    "Pace",
    "State",
    "step",
]
