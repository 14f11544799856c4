"""Run one search in an unknown building in simulation and say how it went."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import cast

from vedette.maps.world import World
from vedette.outcome import Outcome
from vedette.record.explore.observer import ExploreReport
from vedette.record.seek.summary import SeekSummary
from vedette.sim.explore.run import ExploreRun, placed
from vedette.sim.seek.simulation import SeekSetup, SeekSimulation
from vedette.team import PlatformSpec


def prepare(world: World, specs: Sequence[PlatformSpec], setup: SeekSetup) -> SeekSimulation:
    """Put a team at its starts, and somebody where the seed says.

    Raises:
        InputError: as ``vedette.sim.explore.run.placed``.
    """
    return SeekSimulation(world, *placed(world, specs, setup), setup)


class SeekRun(ExploreRun):
    """One search, measured as an exploration is."""

    def _report(self, outcome: Outcome) -> ExploreReport:
        report, simulation = super()._report(outcome), cast(SeekSimulation, self.simulation)
        robots, seek = simulation.robots, simulation.setup.seek
        by = None if robots.found_by is None else simulation.specs[robots.found_by].name
        summary = SeekSummary(
            **vars(report.summary),
            order=seek.order,
            reach_m=seek.reach,
            detection=seek.detection,
            found_s=robots.found_s,
            found_by=by,
            somebody=robots.somebody,
        )
        return replace(report, summary=summary)
