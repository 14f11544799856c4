"""Monitoring as a domain: where its parts are."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import nan
from pathlib import Path
from typing import Any, cast

import numpy as np

from vedette.agent.mission import FlightMission
from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.case import MonitorCase, default_case, made, read_case
from vedette.domains.monitoring.content import FieldContent, belief_of, check_content, content_of
from vedette.domains.monitoring.scenario import MonitorScenario
from vedette.errors import InputError
from vedette.missions.flights import FlightTeam, TeamOptions
from vedette.missions.flying import RoundTimes
from vedette.missions.monitor.assemble import MonitorTeam
from vedette.missions.monitor.monitoring import Monitoring
from vedette.outcome import Outcome
from vedette.record.display import Display
from vedette.record.folder import OutputFolder
from vedette.record.log import Sink, VehicleSample
from vedette.record.mcap import McapFile, Medium, Place
from vedette.record.monitor.live import monitor_display
from vedette.record.monitor.log import MonitorScene, MonitorSnapshot
from vedette.record.monitor.mcap import MonitorMcapWriter
from vedette.record.monitor.observer import MonitorObserver, MonitorReport, compared
from vedette.record.monitor.summary import MonitorSummary, closing
from vedette.record.summary import Setting
from vedette.scenario import as_scenario
from vedette.sim.domain import Domain
from vedette.sim.monitor.oracle import FieldOracle, check_optimum
from vedette.sim.monitor.world import measurers
from vedette.sim.network import Spawn
from vedette.sim.vehicles import Vehicles


class Monitor(Domain[MonitorCase, FieldContent, MonitorScene, MonitorSnapshot, MonitorReport]):
    """A team keeps a field known."""

    content = FieldContent
    leaves = ("run.mcap", "summary.json", "timing.json", "field.png", "curves.png")

    def case(self, scenario: Path | Mapping[str, Any] | None) -> MonitorCase:
        """Return what a scenario comes to."""
        match scenario:
            case None:
                return default_case()
            case Path():
                return read_case(scenario)
            case _:
                return made(as_scenario(scenario, MonitorScenario, "scenario"), Path("scenario"))

    def team(self, case: MonitorCase, options: TeamOptions, times: RoundTimes) -> FlightTeam[MonitorCase]:
        """Return what all vehicles know beforehand."""
        return MonitorTeam(case, options, times)

    def spawn(self, team: FlightTeam[MonitorCase]) -> Spawn:
        """Return who makes agents: an oracle, if the optimum is asked for."""
        if team.options.coordination != "optimum":
            return team.assemble
        check_optimum(team.case)
        return partial(FieldOracle().assemble, cast(MonitorTeam, team))

    def others(self, case: MonitorCase, coordination: str) -> Sequence[str]:
        """Return all others, the optimum only where it can be had."""
        names = super().others(case, coordination)
        try:
            check_optimum(case)
        except InputError:
            return [name for name in names if name != "optimum"]
        return names

    def vehicles(self, case: MonitorCase, seed: int, over: Callable[[float], Outcome | None]) -> Vehicles:
        """Return the vehicles at their starts."""
        return measurers(case, seed, over)

    def tell(self, mission: FlightMission[Any, Any, Any], step: int) -> FieldContent:
        """Return what is known of the field."""
        return content_of(cast(Monitoring, mission).known(step))

    def check(self, content: FieldContent, case: MonitorCase) -> None:
        """Raise ValueError for what is no evidence of this field."""
        check_content(content, case.spots.count)

    def known(self, content: FieldContent, case: MonitorCase) -> FieldBelief:
        """Return what is known of the field."""
        return belief_of(content, FieldBelief.prior(case.model, case.spots, case.scenario.step))

    def seen(self, t: float, vehicles: Sequence[VehicleSample], known: FieldBelief) -> MonitorSnapshot:
        """Return the field as it is taken to be."""
        mean = known.mean.astype(np.float32)
        return MonitorSnapshot(t, tuple(vehicles), nan, nan, nan, mean, entropy=known.entropy)

    def scene(self, case: MonitorCase) -> MonitorScene:
        """Return what stays the same."""
        return MonitorScene.of(case)

    def observer(
        self, team: FlightTeam[MonitorCase], setting: Setting, sinks: Sequence[Sink[MonitorSnapshot]]
    ) -> MonitorObserver:
        """Return who measures a mission against the truth."""
        return MonitorObserver(team, setting, sinks)

    def display(self, scene: MonitorScene, quiet: bool) -> Display[MonitorSnapshot]:
        """Return the live view."""
        return monitor_display(scene, quiet)

    def recorder(self, place: Place | Medium, scene: MonitorScene) -> McapFile[Any]:
        """Open the run record."""
        return MonitorMcapWriter(place, scene)

    def write(self, report: MonitorReport, folder: OutputFolder, animate: bool) -> None:
        """Write figures and pictures."""
        from vedette.record.monitor.outputs import write_outputs  # draws: takes a second to import

        write_outputs(report, folder, animate)

    def closing(self, summary: MonitorSummary, folder: Path) -> list[str]:
        """Say how it went."""
        return closing(summary, folder)

    def compared(
        self, report: MonitorReport, others: Mapping[str, MonitorReport], outcome: Outcome
    ) -> MonitorReport:
        """Return the report with the others beside it."""
        return compared(report, others, outcome)
