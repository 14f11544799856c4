"""An exploring robot, from its file."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from vedette.agent import Agent
from vedette.agent.body import Body, Shown
from vedette.agent.terms import fingerprint_of
from vedette.errors import InputError
from vedette.maps.lattice import Lattice
from vedette.maps.world import World
from vedette.missions.explore.assemble import assemble, terms_of
from vedette.missions.explore.old_map import read_prior
from vedette.missions.explore.options import ExploreOptions
from vedette.net.config import RESOLUTION, AgentConfig, BodySettings
from vedette.net.explore.content import ExploreTeller
from vedette.net.names import robot_name
from vedette.net.notary import notary_of
from vedette.net.orders import explorer_judge, gate_of
from vedette.net.own import OwnSettings
from vedette.net.real import real_robot, shows
from vedette.net.robot import Robot
from vedette.net.simulated import simulated_robot
from vedette.team import Most, PlatformSpec


class _Place(NamedTuple):
    """A body, and where it is."""

    lattice: Lattice  # of the team
    hull: PlatformSpec
    body: Body
    shown: Shown | None
    terms: dict[str, str]  # what its team has to agree on beside how it explores
    time: Callable[[], float | None] | None = None  # its own clock [s]
    showing: Callable[[Agent], Callable[[float], None]] | None = None  # it to those beside it


def explorer(config: AgentConfig, folder: Path, boot: int, speed: float) -> Robot:
    """Return the robot; ``folder``: what paths in its file are relative to.

    Raises:
        InputError: the map or the start cannot be used, or the robot does not tell what is needed.
    """
    best, options = config.best, config.explore or ExploreOptions()
    if config.body.ros2 is not None:
        place = _real(config, options)
    elif config.body.own is not None:
        place = _own(config.body, config.body.own, robot_name(config.robot - 1), folder, options)
    else:
        place = _simulated(config, folder, options)
    prior = None if options.prior is None else read_prior(folder / options.prior, place.lattice)
    agreed = {**terms_of(place.lattice, options, prior), **place.terms}
    notary, terms = notary_of(config, folder, agreed, speed)
    gate = gate_of(config, f"{fingerprint_of(agreed):x}", notary)
    agent = assemble(
        place.lattice,
        place.hull,
        options,
        config.robot - 1,
        boot,
        robots=config.robots,
        most=Most.of([place.hull]) if best is None else Most(best.range, best.speed),
        waits_for=config.robots,
        notary=notary,
        prior=prior,
    )
    agent.check_order = gate.check
    show = None if place.showing is None else place.showing(agent)
    teller, judge = ExploreTeller(agent), explorer_judge(agent, gate)
    return Robot(agent, place.body, place.shown, teller, terms, show, place.time, judge)


def _simulated(config: AgentConfig, folder: Path, options: ExploreOptions) -> _Place:
    assert config.body.map is not None
    world = World.from_map(folder / config.body.map, config.body.resolution)
    lattice = options.lattice_on(world.frame)
    body = simulated_robot(config, world, lattice.area)
    return _Place(lattice, body.hull, body, body, {"map.content": _fingerprint(world)})


def _real(config: AgentConfig, options: ExploreOptions) -> _Place:
    lattice = options.lattice(config.body.resolution or RESOLUTION)
    body = real_robot(config)
    _check_place(body, body.hull, lattice)
    return _Place(lattice, body.hull, body, None, {}, body.time, shows(config, body))


def _own(body: BodySettings, own: OwnSettings, name: str, folder: Path, options: ExploreOptions) -> _Place:
    spec, lattice = body.spec(name), options.lattice(body.resolution or RESOLUTION)
    made = own.body(spec, folder)
    _check_place(made, spec, lattice)
    return _Place(lattice, spec, made, None, {})


def _check_place(body: Body, spec: PlatformSpec, lattice: Lattice) -> None:
    """Refuse a robot that sees nothing of the team's ground from where it is."""
    (x, y, _), (x_min, x_max, y_min, y_max) = body.pose, lattice.frame.extent
    if max(x_min - x, x - x_max, y_min - y, y - y_max) > spec.range:
        raise InputError(
            f"body: the robot stands at {x:.1f}, {y:.1f} m, and the team's ground is {lattice.room}; mend "
            "where it starts in the team's frame, or explore.area"
        )


def _fingerprint(world: World) -> str:
    """Return a number for the world that a body is simulated in: its mates' bodies have to be in the same."""
    return hashlib.blake2b(np.packbits(world.solid).tobytes(), digest_size=4).hexdigest()
