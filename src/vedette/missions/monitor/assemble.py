"""A monitoring vehicle's mission, put together: what it measures, how it moves, what it may spend."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from vedette.domains.monitoring.banded import BandedField
from vedette.domains.monitoring.case import MonitorCase
from vedette.domains.monitoring.impact import units_of
from vedette.domains.monitoring.patrols import around, at_random, strip
from vedette.domains.monitoring.planning import Outlook
from vedette.domains.monitoring.platform import MonitoringPlatform
from vedette.domains.monitoring.purse import Purse
from vedette.domains.monitoring.ways import Place, Way
from vedette.domains.monitoring.worth import Patrol
from vedette.fusion.seals import Notary
from vedette.missions.flights import FlightTeam
from vedette.missions.monitor.monitoring import Monitoring, MonitorPlan
from vedette.missions.sense import Grounds

_FINE = 4.0  # units of the weakest sensor's measurement


@dataclass(frozen=True, eq=False)
class MonitorTeam(FlightTeam[MonitorCase]):
    """What all vehicles of a team know beforehand."""

    domain = "monitor"

    def __post_init__(self) -> None:
        """Raise InputError as any team, and for a field that is too large to plan on."""
        super().__post_init__()
        BandedField(self.plan.outlook.of(self.plan.prior))

    @cached_property
    def plan(self) -> MonitorPlan:
        """What they have agreed on."""
        case, scenario = self.case, self.case.scenario
        outlook = Outlook(case.model, case.spots)
        variances = [outlook.sensor(case.sensor(i)).variance for i in range(len(case.scenario.vehicles))]
        unit = 1.0 / (_FINE * max(variances))
        return MonitorPlan(
            case.packing,
            Patrol(scenario.horizon * scenario.step, scenario.layers, scenario.gamma),
            scenario.step,
            self.lead,
            unit,
            max(units_of(variance, unit) for variance in variances),
        )

    @property
    def grounds(self) -> Grounds:
        """What orders can be about."""
        case, scenario = self.case, self.case.scenario
        x0, x1, y0, y1 = scenario.frame.extent
        flies = tuple(each.flies for each in scenario.vehicles)
        fixed = self.options.coordination in ("lawnmower", "random")
        why = "vehicles that follow fixed patrols weigh nothing; leave it out" if fixed else ""
        return Grounds(len(case.names), (x0, y0, x1, y1), why, why, (scenario.frame, case.blocked), flies)

    def mission(self, robot: int, boot: int, notary: Notary | None) -> Monitoring:
        """Return a vehicle's share, by its number from 0."""
        case, vehicle = self.case, self.case.scenario.vehicles[robot]
        platform = MonitoringPlatform(
            vehicle.speed,
            self.plan.outlook.sensor(case.sensor(robot)),
            None if vehicle.flies else case.blocked,
            case.scenario.frame,
            bearings=case.scenario.bearings,
        )
        coordination = self.options.coordination
        return Monitoring(
            platform,
            case.sensor(robot),
            self.plan,
            self.evidence(robot, boot, notary, case.packing.size),
            Purse(vehicle.budget),
            coordination != "shared",
            partial(self._route, robot) if coordination in ("lawnmower", "random") else None,
        )

    def _route(self, robot: int, here: Place) -> Way:
        """Return the patrol of one that follows a fixed one."""
        case, vehicle = self.case, self.case.scenario.vehicles[robot]
        length = min(Purse(vehicle.budget).reach(vehicle.speed), vehicle.speed * case.scenario.duration)
        frame = case.scenario.frame
        if self.options.coordination == "random":
            way = at_random(frame, here, length, np.random.default_rng([robot, 7]))
        else:
            way = strip(frame, here, robot, len(case.scenario.vehicles), length)
        return way if vehicle.flies or not case.blocked.any() else around(way, frame, case.blocked)
