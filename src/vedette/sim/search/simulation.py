"""Searching put together for the simulator: a hidden target, vehicles with sensors, and an agent for each."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor
from typing import cast

from vedette.errors import check_word
from vedette.missions.search.assemble import SearchTeam
from vedette.missions.search.case import SearchCase
from vedette.missions.search.options import COORDINATIONS, FUSIONS, SearchOptions
from vedette.missions.search.searching import Declared, Searching
from vedette.outcome import Outcome
from vedette.record.search.observer import first_declared
from vedette.sim.flights import FlightSetup
from vedette.sim.search.hidden import Hidden, Searchers
from vedette.sim.simulation import Simulation


@dataclass(frozen=True)
class SearchSetup(FlightSetup):
    """What to simulate, beside the scenario."""

    fusion: str = "replicated"
    blind: bool = False  # nobody ever reports anything: the run that plans are made for

    def __post_init__(self) -> None:
        super().__post_init__()
        check_word("coordination", self.coordination, COORDINATIONS)
        check_word("fusion", self.fusion, FUSIONS)

    @property
    def options(self) -> SearchOptions:
        """How the team searches."""
        return SearchOptions(self.coordination, self.scheme, self.fusion)


class SearchSimulation(Simulation):
    """A team of vehicles that look for a target; ``run`` lets it, until one declares it found."""

    setup: SearchSetup

    def __init__(self, case: SearchCase, setup: SearchSetup) -> None:
        """Put the vehicles at their starts and the target somewhere.

        Raises:
            InputError: rounds take longer over these links than plans reach ahead.
        """
        self.case, self.names = case, case.names
        team = self.team = SearchTeam(case, setup.options, setup.times)
        self.plan = team.plan
        self.hidden = Hidden.of(case, setup.seed)
        self.vehicles = Searchers.of(case, None if setup.blind else self.hidden, self._found)
        super().__init__(team.assemble, self.vehicles, setup)

    def _found(self, now: float) -> Outcome | None:
        return None if self.declared is None else Outcome.COMPLETE

    @property
    def missions(self) -> list[Searching]:
        """Everybody's share of the mission, by index."""
        return [cast(Searching, agent.mission) for agent in self.network.agents]

    @property
    def steps(self) -> int:
        """Number of whole steps that the search may take."""
        return floor(self.setup.max_time / self.case.scenario.step + 1e-6)

    @property
    def declared(self) -> tuple[int, Declared] | None:
        """Who declared the target found, and where."""
        return first_declared([mission.declared for mission in self.missions])
