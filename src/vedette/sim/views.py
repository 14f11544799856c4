"""What can be told of any simulated robot from outside."""

from __future__ import annotations

from typing import cast

import numpy as np

from vedette.agent import FlightBehaviour
from vedette.agent.flight import Itinerary
from vedette.record.figures import RobotFigures, RoundFigures, traffic_of
from vedette.record.log import DEAD
from vedette.record.summary import Setting
from vedette.sim.setup import Setup
from vedette.sim.simulation import Simulation

NOWHERE = np.empty((0, 2))  # the path of one that goes nowhere


def figures(simulation: Simulation, i: int, travelled: float) -> RobotFigures:
    """Return what a robot has counted that has come so far [m]."""
    network = simulation.network
    return RobotFigures(
        travelled_m=travelled,
        rounds=RoundFigures.of(network.agents[i].rounds),
        messages=traffic_of(network.messages_sent, i),
        bytes=traffic_of(network.bytes_sent, i),
    )


def state(simulation: Simulation, i: int) -> str:
    """Return a robot's word for what it does."""
    return simulation.network.agents[i].state.value if simulation.field.alive[i] else DEAD


def flight(simulation: Simulation, i: int) -> Itinerary:
    """Return what a vehicle means to fly."""
    return cast(FlightBehaviour, simulation.network.agents[i].behaviour).flight


def setting(setup: Setup) -> Setting:
    """Return how a mission was set up."""
    radio = None if setup.radio is None else str(setup.radio)
    return Setting(seed=setup.seed, radio=radio, faults=setup.faults_from)
