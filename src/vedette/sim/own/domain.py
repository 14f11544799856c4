"""A domain of somebody's own as the simulator, processes and commands take domains."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from vedette.agent.mission import FlightMission
from vedette.missions.flights import FlightTeam, TeamOptions
from vedette.missions.flying import RoundTimes
from vedette.missions.own.assemble import OwnTeam
from vedette.missions.own.case import OwnCase
from vedette.missions.own.mission import OwnMission, OwnReading
from vedette.missions.own.theory import MISSION
from vedette.outcome import Outcome
from vedette.record.display import Display
from vedette.record.folder import OutputFolder
from vedette.record.log import Sink, VehicleSample
from vedette.record.mcap import McapFile, Medium, Place
from vedette.record.own.live import OwnMcapWriter, own_display
from vedette.record.own.observer import (
    OwnContent,
    OwnObserver,
    OwnReport,
    OwnScene,
    OwnSnapshot,
    compared,
    content_of,
    total_of,
)
from vedette.record.own.summary import OwnSummary, closing
from vedette.record.summary import Setting, write_figures
from vedette.sim.domain import Domain
from vedette.sim.simulation import random_streams
from vedette.sim.vehicles import Vehicles


class OwnDomain(Domain[OwnCase, OwnContent, OwnScene, OwnSnapshot, OwnReport]):
    """Everything of a domain but its theory, which its name says."""

    content = OwnContent
    leaves = ("run.mcap", "summary.json", "timing.json", "ways.png", "curves.png")

    def case(self, scenario: Path | Mapping[str, Any] | None) -> OwnCase:
        """Return what a scenario comes to."""
        return OwnCase.of(self.name, MISSION.find(self.name), scenario)

    def team(self, case: OwnCase, options: TeamOptions, times: RoundTimes) -> FlightTeam[OwnCase]:
        """Return what all vehicles know beforehand."""
        return OwnTeam(case, options, times, self.name)

    def vehicles(self, case: OwnCase, seed: int, over: Callable[[float], Outcome | None]) -> Vehicles:
        """Return the vehicles at their starts; each sensor has chance of its own."""
        truth, streams = case.truth(seed), random_streams(seed, len(case.scenario.vehicles))

        def look(i: int, pose: NDArray[np.float64], now: float) -> OwnReading | None:
            reading = case.theory.sense(truth, i, pose.copy(), streams[i])
            return None if reading is None else OwnReading(pose.copy(), reading)

        vehicles = case.scenario.vehicles
        return Vehicles(
            [each.pose for each in vehicles],
            [each.speed for each in vehicles],
            [each.turn_rate for each in vehicles],
            case.scenario.step,
            look,
            over,
        )

    def tell(self, mission: FlightMission[Any, Any, Any], step: int) -> OwnContent:
        """Return what its evidence adds up to."""
        return content_of(cast(OwnMission, mission).total(step))

    def check(self, content: OwnContent, case: OwnCase) -> None:
        """Raise ValueError for what is no sum of evidence."""
        total_of(content, case.theory.size)

    def seen(self, t: float, vehicles: Sequence[VehicleSample], known: Any) -> OwnSnapshot:
        """Return who moves where: the theory's figures are against the truth."""
        return OwnSnapshot(t, tuple(vehicles), {})

    def scene(self, case: OwnCase) -> OwnScene:
        """Return what stays the same."""
        return OwnScene.of(case)

    def observer(
        self, team: FlightTeam[OwnCase], setting: Setting, sinks: Sequence[Sink[OwnSnapshot]]
    ) -> OwnObserver:
        """Return who measures a mission by the theory's figures."""
        return OwnObserver(team, setting, sinks)

    def display(self, scene: OwnScene, quiet: bool) -> Display[OwnSnapshot]:
        """Return the live view."""
        return own_display(scene, quiet)

    def recorder(self, place: Place | Medium, scene: OwnScene) -> McapFile[Any]:
        """Open the run record."""
        return OwnMcapWriter(place, scene)

    def write(self, report: OwnReport, folder: OutputFolder, animate: bool) -> None:
        """Write figures and pictures."""
        from vedette.record.own.pictures import curves_png, film, ways_png  # takes a second to import

        write_figures(report.summary, report.timing, folder)
        ways_png(report, folder / "ways.png")
        curves_png({**report.others, report.summary.coordination: report.log}, folder / "curves.png")
        if animate:
            film(report.log, report.image, folder / "mission.gif")

    def closing(self, summary: OwnSummary, folder: Path) -> list[str]:
        """Say how it went."""
        return closing(summary, folder)

    def compared(self, report: OwnReport, others: Mapping[str, OwnReport], outcome: Outcome) -> OwnReport:
        """Return the report with the others beside it."""
        return compared(report, others, outcome)
