"""What missions of vehicles share in simulation."""

from __future__ import annotations

from dataclasses import dataclass

from vedette.missions.flying import RoundTimes
from vedette.sim.simulation import JOB_TIME, Setup


@dataclass(frozen=True)
class FlightSetup(Setup):
    """What to simulate, beside the scenario."""

    coordination: str = "negotiated"  # "none": nobody tells anybody anything

    @property
    def apart(self) -> bool:
        """Without coordination each vehicle is a team of one."""
        return self.coordination == "none"

    @property
    def times(self) -> RoundTimes:
        """What rounds take on these links."""
        return RoundTimes(self.link_delay, JOB_TIME)
