"""A seeking robot's agent, put together: mapping and searching as one objective, driving."""

from __future__ import annotations

from dataclasses import replace

from vedette.agent import Agent, GroundBehaviour
from vedette.agent.driving import Driver
from vedette.agent.relay import Relay, nearby
from vedette.domains.mapping.belief import planning_factor
from vedette.domains.mapping.planners import DEFAULT, planner
from vedette.domains.mapping.price import FREE
from vedette.domains.mapping.sightings import BINS, ROWS
from vedette.fusion import ReplicatedEvidence
from vedette.maps.lattice import Lattice
from vedette.missions.explore.options import ExploreOptions
from vedette.missions.seek.options import SeekOptions
from vedette.missions.seek.platform import SeekingPlatform
from vedette.missions.seek.seeking import Seeking
from vedette.team import Most, PlatformSpec


def assemble(
    lattice: Lattice,
    spec: PlatformSpec,
    options: ExploreOptions,
    seek: SeekOptions,
    robot: int,
    boot: int,
    *,
    most: Most,
) -> Agent:
    """Return a fresh agent of a team; ``most``: what none of its robots exceeds."""
    frame = lattice.frame
    how = replace(
        planner(DEFAULT),
        alone=None,
        platform=lambda spec: SeekingPlatform(spec, max_stops=6),
        end_price=FREE,  # it may end at any stop, with somebody found
    )
    counts = ROWS * BINS + frame.coarse(planning_factor(frame.resolution)).size
    fusion = ReplicatedEvidence(robot, boot, frame.shape, counts, mark=lattice.mark)
    mission = Seeking(lattice, spec, how, fusion, most=most, seek=seek)
    behaviour = GroundBehaviour(mission, Driver(robot, spec), False, 1)
    relay = Relay(nearby(most.range, most.speed))
    return Agent(robot, boot, spec, behaviour, options.negotiates_by, forks=True, relay=relay)
