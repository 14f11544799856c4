"""What missions of vehicles share in simulation: how they coordinate, and how far ahead plans must start."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vedette.sim.simulation import JOB_TIME, Setup

_SWEEPS = 3  # of the token that a round mostly takes, at most
_MARGIN = 0.1  # [s]


@dataclass(frozen=True)
class FlightSetup(Setup):
    """What to simulate, beside the scenario."""

    coordination: str = "negotiated"  # "none": nobody tells anybody anything

    @property
    def apart(self) -> bool:
        """Without coordination each vehicle is a team of one."""
        return self.coordination == "none"

    def team(self, vehicles: int) -> int:
        """Return how many vehicles plan together."""
        return 1 if self.apart else vehicles


def lead(vehicles: int, delay: float) -> float:
    """Return how long a round takes from freezing to its end, on a balanced tree [s].

    Freeze, Gather and Stop each go from end to end of the tree, and the token round it in every sweep.
    """
    depth = math.ceil(math.log2(vehicles + 1)) - 1
    hops = 3 * depth + 2 * (vehicles - 1) * _SWEEPS
    return JOB_TIME + _MARGIN + delay * hops
