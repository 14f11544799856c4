"""What missions of vehicles share in simulation."""

from __future__ import annotations

from dataclasses import dataclass

from vedette.errors import InputError
from vedette.missions.flying import RoundTimes
from vedette.sim.faults.kinds import Skew
from vedette.sim.setup import Setup
from vedette.sim.simulation import JOB_TIME


@dataclass(frozen=True)
class FlightSetup(Setup):
    """What to simulate, beside the scenario.

    Raises:
        InputError: as `Setup`, or clocks go wrong.
    """

    coordination: str = "negotiated"  # "none": nobody tells anybody anything

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.faults is not None and any(isinstance(fault, Skew) for fault in self.faults.faults):
            raise InputError("faults: fault skew: vehicles plan by a common clock; leave it out")

    @property
    def apart(self) -> bool:
        """Without coordination each vehicle is a team of one."""
        return self.coordination == "none"

    @property
    def times(self) -> RoundTimes:
        """What rounds take on these links."""
        return RoundTimes(self.link_delay, JOB_TIME)
