"""One vehicle in a process of its own flies, sees and counts as it would in the whole team's simulation."""

from __future__ import annotations

import numpy as np

from tests.support.track_scenes import scenario
from vedette.agent.body import TICK
from vedette.agent.effects import Fly
from vedette.agent.events import Event, Pose, Sensed
from vedette.agent.flight import FlightPlan
from vedette.missions.flying import RoundTimes
from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.options import TrackOptions
from vedette.sim.own_vehicle import OwnVehicle
from vedette.sim.track.targets import Targets, trackers

TEAM = TrackTeam(scenario(), TrackOptions(), RoundTimes(0.02, 0.03))
STEPS = 6


def own(robot: int) -> OwnVehicle:
    """A vehicle alone, with its own copy of the truth."""
    return OwnVehicle(TEAM.scenario.vehicles[robot], robot, trackers(TEAM.scenario, Targets.of(TEAM, 3)))


def plan() -> Fly:
    """A turn, from the second step on."""
    dt = TEAM.scenario.step
    return Fly(FlightPlan(dt, dt, np.array([0.1, -0.1, 0.05])))


def seen(events: list[Event]) -> list[tuple[float, dict[int, list[float]]]]:
    """What a sensor told, by time."""
    return [
        (round(event.time, 6), {k: z.tolist() for k, z in event.data.items()})  # type: ignore[attr-defined]
        for event in events
        if isinstance(event, Sensed)
    ]


def test_it_sees_what_it_would_see_in_the_teams_simulation() -> None:
    targets = Targets.of(TEAM, 3)
    team, alone = trackers(TEAM.scenario, targets), own(1)
    team.carry_out(1, plan(), 0.0)
    alone.carry_out(plan(), 0.0)
    told: list[Event] = []
    together: list[Event] = []
    for tick in range(1, round(STEPS * TEAM.scenario.step / TICK) + 1):
        now = tick * TICK
        team.advance(now, TICK)
        for i in range(len(TEAM.scenario.vehicles)):
            events = team.sense(i, now)
            together += events if i == 1 else []
        told += alone.sense(now)
    assert len(seen(told)) >= STEPS
    assert seen(told) == seen(together)
    assert alone.pose == team.pose(1)
    assert alone.figures.travelled == team.travelled[1]


def test_one_that_starts_late_begins_where_it_is_put_and_looks_once_a_step() -> None:
    late = own(0)
    late.put((120.0, 80.0, 0.5))
    now = 20 * TEAM.scenario.step + 0.3
    events = late.sense(now)
    pose = next(event for event in events if isinstance(event, Pose))
    assert np.hypot(pose.x - 120.0, pose.y - 80.0) <= late.hull.speed * TICK + 1e-9
    again = [event for k in range(1, 4) for event in late.sense(now + k * TICK) if isinstance(event, Sensed)]
    assert again == []
    assert late.figures.travelled <= late.hull.speed * 4 * TICK + 1e-9
