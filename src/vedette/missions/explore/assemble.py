"""An exploring robot's agent, put together: the mapping domain, a planner, a way of fusing, driving."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf

from vedette.agent import Agent, GroundBehaviour
from vedette.agent.driving import Driver
from vedette.agent.relay import Relay, nearby
from vedette.agent.terms import Terms, flat
from vedette.domains.mapping.belief import planning_factor
from vedette.domains.mapping.planners import Planner, planner
from vedette.domains.mapping.prior import PriorMap
from vedette.domains.mapping.sightings import BINS, ROWS
from vedette.errors import InputError, check_word
from vedette.fusion import ChannelFilter, Fusion, ReplicatedEvidence
from vedette.fusion.framed import FramedEvidence
from vedette.fusion.particulars import Capabilities
from vedette.fusion.seals import Notary
from vedette.fusion.signed import SignedEvidence
from vedette.fusion.signed_framed import SignedFramedEvidence
from vedette.kernels.coverage import LAYERS
from vedette.maps.lattice import Lattice
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.frames.exploring import FramedExploring
from vedette.missions.explore.options import ExploreOptions
from vedette.team import Most, PlatformSpec

FUSIONS: Mapping[str, type[ReplicatedEvidence] | type[ChannelFilter]] = {
    "replicated": ReplicatedEvidence,
    "channel": ChannelFilter,
}


def terms_of(lattice: Lattice, options: ExploreOptions, prior: PriorMap | None = None) -> Terms:
    """Return what all of a team have to agree on: not the search behind a planner, nor anybody's body."""
    how, resolution = planner(options.planner), lattice.frame.resolution
    objective = {
        "worth after 5 s": float(how.layers.weights.sum()),
        "worth in the end": float(how.layers.weights[-1]),
        "hidden": how.hidden,
        "return_price": how.return_price,
        "turn": how.turn,
    }
    return {
        "mission": "explore",
        **dict(flat("map", lattice.frame)),
        **({} if lattice.area is None else dict(flat("area", lattice.area))),
        **({} if prior is None else {"prior": f"{prior.identity:016x}"}),
        **({} if how.worlds == 1 else {"worlds": f"{how.worlds}"}),
        "planning cell": f"{resolution * planning_factor(resolution):g}",
        **{f"objective.{name}": f"{value:g}" for name, value in objective.items()},
        "scheme": options.negotiates_by,
        "fusion": options.fusion,
        **(
            {}
            if options.frames == "known"
            else {"frames": options.frames, "rendezvous": f"{options.rendezvous}"}
        ),
    }


def assemble(
    lattice: Lattice,
    spec: PlatformSpec,
    options: ExploreOptions,
    robot: int,
    boot: int,
    *,
    robots: int,
    most: Most,
    waits_for: int = 1,
    explorer: type[Exploring] | None = None,
    notary: Notary | None = None,
    prior: PriorMap | None = None,
) -> Agent:
    """Return a fresh agent of a team.

    Args:
        lattice: that the team agrees on.
        spec: its body.
        options: how the team explores.
        robot: its number, from 0.
        boot: of its start.
        robots: in the team.
        most: what none of them exceeds.
        waits_for: so many robots, itself included, before it begins; for a while.
        explorer: its share of the mission; None: what the frames ask for.
        notary: signs its evidence, if that is replicated, and checks everybody's; None: nobody does.
        prior: an old map of the building, the same for the whole team; None: there is none.

    Raises:
        InputError: the planner or the way of fusing is unknown, or cannot serve such a team.
    """
    check_word("fusion", options.fusion, FUSIONS)
    options.check()
    unknown = options.frames == "unknown"
    fusion: Fusion
    if unknown:
        fusion = _framed_fusion(lattice, robot, boot, robots, most, notary)
    else:
        fusion = _fusion(lattice, options, robot, boot, most, notary)
    how = planner(options.planner, robots)
    _check_room(lattice, how)
    kind = explorer or (FramedExploring if unknown else Exploring)
    mission = kind(lattice, spec, how, fusion, most=most, prior=prior)
    if isinstance(mission, FramedExploring):
        mission.rendezvous = options.rendezvous
    behaviour = GroundBehaviour(mission, Driver(robot, spec), options.return_home, waits_for)
    places = how.negotiates and not unknown  # of mates tell how near they are, and nobody plans by them
    relay = Relay(nearby(most.range, most.speed) if places else inf)
    forks = how.negotiates and how.scheme is None  # where the order of turns is no part of the planner
    agent = Agent(robot, boot, spec, behaviour, options.negotiates_by, forks=forks, relay=relay)
    if prior is not None or how.worlds > 1:
        said = (0 if prior is None else prior.identity) ^ (how.worlds - 1)
        agent.rounds.mandate = lambda: agent.orders.digest ^ said
    return agent


def _check_room(lattice: Lattice, how: Planner) -> None:
    """Raise InputError where planning cells in all worlds and layers cannot be numbered in 32 bits."""
    cells = lattice.frame.coarse(planning_factor(lattice.frame.resolution)).size
    if cells * how.worlds * LAYERS > 1 << 32:
        raise InputError(
            f"planner: {cells} planning cells in {how.worlds} worlds are too many; give an area, or choose "
            "a planner that does not predict"
        )


def _fusion(
    lattice: Lattice, options: ExploreOptions, robot: int, boot: int, most: Most, notary: Notary | None
) -> Fusion:
    """Return how the robot shares what it sees: signed, where there are keys and sums do not forbid it."""
    shape, mark = lattice.frame.shape, lattice.mark
    if notary is None or options.fusion != "replicated":
        return FUSIONS[options.fusion](robot, boot, shape, ROWS * BINS, mark=mark)
    limits = _limits(lattice, most)
    return SignedEvidence(robot, boot, shape, ROWS * BINS, notary=notary, limits=limits, mark=mark)


def _framed_fusion(
    lattice: Lattice, robot: int, boot: int, robots: int, most: Most, notary: Notary | None
) -> Fusion:
    """Return how a robot shares what it sees in a frame of its own: signed, where there are keys."""
    about = robot, boot, lattice.frame, ROWS * BINS, robots
    if notary is None:
        return FramedEvidence(*about, mark=lattice.mark)
    return SignedFramedEvidence(*about, notary=notary, limits=_limits(lattice, most), mark=lattice.mark)


def _limits(lattice: Lattice, most: Most) -> Capabilities:
    frame = lattice.frame
    return Capabilities(frame.resolution, most.range, most.speed, (frame.origin_x, frame.origin_y))
