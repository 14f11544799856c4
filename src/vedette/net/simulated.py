"""A robot's simulated body, from its file: the one place where a process knows the simulator."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import radians
from pathlib import Path
from typing import Any

import numpy as np

from vedette.align import FramePose
from vedette.maps.area import Area
from vedette.maps.world import World
from vedette.missions.flights import FlightCase
from vedette.missions.search.case import SearchCase
from vedette.missions.track.assemble import TrackTeam
from vedette.net.clock import MissionClock
from vedette.net.config import AgentConfig
from vedette.net.names import robot_name
from vedette.sim.domain import Domain as Domain
from vedette.sim.domains import domain_of as domain_of
from vedette.sim.faults import StagedLinks, Timeline, load_faults
from vedette.sim.framed import as_meant as as_meant
from vedette.sim.framed import as_told as as_told
from vedette.sim.framed import frames_of as frames_of
from vedette.sim.own_body import OwnBody
from vedette.sim.own_vehicle import OwnVehicle
from vedette.sim.search.hidden import Hidden, Searchers
from vedette.sim.starts import choose_starts
from vedette.sim.track.targets import Targets, trackers

MOST_BODIES = 64  # of others that a simulated robot can see


def simulated_robot(config: AgentConfig, world: World, area: Area | None) -> OwnBody:
    """Return the disc robot that a file describes, at its start in a world.

    Raises:
        InputError: the start cannot be.
    """
    robot = config.robot - 1
    spec = config.body.spec(robot_name(robot))
    start = choose_starts(world, [spec], np.random.default_rng(0), area)[0]
    rng = np.random.default_rng([config.body.seed, robot])
    frame = None
    if config.body.frame is not None:
        x, y, heading = config.body.frame
        frame = FramePose.of(x, y, radians(heading))
    return OwnBody.put(world, spec, start, robot, max(MOST_BODIES, robot + 1), rng, frame)


def simulated_tracker(config: AgentConfig, team: TrackTeam) -> OwnVehicle:
    """Return the vehicle of a tracking team that a file describes; all of one seed see the same targets."""
    robot, targets = config.robot - 1, Targets.of(team, config.body.seed)
    vehicle = OwnVehicle(team.scenario.vehicles[robot], robot, trackers(team.scenario, targets))
    return _put(vehicle, config)


def simulated_searcher(config: AgentConfig, case: SearchCase) -> OwnVehicle:
    """Return the vehicle of a searching team that a file describes; all of one seed hide the same target."""
    robot, hidden = config.robot - 1, Hidden.of(case, config.body.seed)
    return _put(OwnVehicle(case.scenario.vehicles[robot], robot, Searchers.of(case, hidden)), config)


def simulated_vehicle(
    config: AgentConfig, domain: Domain[Any, Any, Any, Any, Any], case: FlightCase
) -> OwnVehicle:
    """Return the vehicle that a file describes; all of one seed meet the same truth."""
    robot, vehicles = config.robot - 1, domain.vehicles(case, config.body.seed, lambda now: None)
    return _put(OwnVehicle(case.scenario.vehicles[robot], robot, vehicles), config)


def _put(vehicle: OwnVehicle, config: AgentConfig) -> OwnVehicle:
    if config.body.start is not None:
        x, y, heading = config.body.start
        vehicle.put((x, y, radians(heading)))
    return vehicle


@dataclass(frozen=True, eq=False)
class StagedFaults:
    """Faults of links, in the schedule's time; ``vedette.net.process.Staged``."""

    links: StagedLinks
    clock: MissionClock  # that shows the schedule's time

    def put(self, to: int, payload: bytes, now: float) -> None:
        """Take a datagram; it may get lost."""
        self.links.put(to, payload, self._time(now))

    def take(self, now: float) -> Iterator[tuple[int, bytes]]:
        """Yield what is to be sent by now."""
        return self.links.take(self._time(now))

    def _time(self, now: float) -> float:
        assert self.clock.begins is not None
        return (now - self.clock.begins) * self.clock.speed


def staged_faults(config: AgentConfig, folder: Path, clock: MissionClock) -> StagedFaults | None:
    """Return what befalls a robot's links by its file; None: nothing. ``clock`` tells the faults' time.

    Raises:
        InputError: the schedule cannot be used.
    """
    if config.faults is None:
        return None
    robots = max(config.robots, config.robot)
    timeline = Timeline(load_faults(str(folder / config.faults), robots), robots)
    rng = np.random.default_rng([config.body.seed, config.robot, 1])
    return StagedFaults(StagedLinks(timeline, config.robot - 1, rng), clock)
