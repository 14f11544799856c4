"""What missions of vehicles share in simulation: how they coordinate, and how far ahead plans must start."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vedette.agent.events import TreeChanged
from vedette.sim.simulation import JOB_TIME, Setup, Simulation

_SWEEPS = 3  # of the token that a round mostly takes, at most
_MARGIN = 0.1  # [s]


@dataclass(frozen=True)
class FlightSetup(Setup):
    """What to simulate, beside the scenario."""

    coordination: str = "negotiated"  # "none": nobody tells anybody anything

    def team(self, vehicles: int) -> int:
        """Return how many vehicles plan together."""
        return 1 if self.coordination == "none" else vehicles


class FlightSimulation(Simulation):
    """A team of vehicles, or without coordination so many teams of one."""

    setup: FlightSetup

    def _plant_tree(self) -> None:
        """Give the living a tree; without coordination, each a tree of its own."""
        if self.setup.coordination != "none":
            super()._plant_tree()
            return
        self._epoch += 1
        for i in self.living:
            self._step(i, [TreeChanged(self._epoch, None, (), 1)])


def lead(vehicles: int, delay: float) -> float:
    """Return how long a round takes from freezing to its end, on a balanced tree [s].

    Freeze, Gather and Stop each go from end to end of the tree, and the token round it in every sweep.
    """
    depth = math.ceil(math.log2(vehicles + 1)) - 1
    hops = 3 * depth + 2 * (vehicles - 1) * _SWEEPS
    return JOB_TIME + _MARGIN + delay * hops
