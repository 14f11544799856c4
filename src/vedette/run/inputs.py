"""What a mission is made of, as a caller may say it: each thing checked, and put into its own type."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias, TypedDict, TypeVar, cast

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from vedette.errors import InputError, brief
from vedette.maps import GridFrame, map_files
from vedette.maps.world import World
from vedette.missions.pairs import tell_too_late
from vedette.number import is_number, is_whole
from vedette.parts import is_reference
from vedette.scenario import as_scenario
from vedette.sim.faults import Schedule, load_faults
from vedette.sim.faults.kinds import Skew
from vedette.sim.orders import OrderAt, load_orders
from vedette.sim.radio import Radio, parse_radio
from vedette.sim.setup import Setup
from vedette.sim.worlds import WORLD, generated, office
from vedette.team import PlatformSpec, check_team, load_team

ROBOTS = 3

AnyPath: TypeAlias = str | Path
AnyWorld: TypeAlias = World | AnyPath | tuple[AnyPath | ArrayLike, float | None] | None
AnyTeam: TypeAlias = int | AnyPath | Sequence[PlatformSpec]
ScenarioT = TypeVar("ScenarioT", bound=msgspec.Struct)


class Conditions(TypedDict, total=False):
    """What a simulated mission may have to put up with; without any of it, all links and robots are sound."""

    radio: Radio | float | str | None  # range [m], or "RANGE,WALL_DB"; None: everybody reaches everybody
    faults: int | AnyPath | None  # a seed, or a schedule's file
    link_delay: float  # of a message [s]; 0.02
    link_loss: float  # share of messages lost; 0
    kills: Sequence[tuple[int, float]]  # robot, from 1, and when it dies [s]
    orders: AnyPath | Sequence[OrderAt]  # of the operator, each with its time; or a file of them


def setup_of(
    robots: int,
    *,
    scheme: str | None,
    seed: int,
    max_time: float,
    clocks: bool = False,
    radio: Radio | float | str | None = None,
    faults: int | AnyPath | None = None,
    link_delay: float = Setup.link_delay,
    link_loss: float = Setup.link_loss,
    kills: Sequence[tuple[int, float]] = (),
    orders: AnyPath | Sequence[OrderAt] = (),
) -> Setup:
    """Return what all simulated missions share; ``clocks``: they may go wrong.

    Raises:
        InputError: as `Setup`, or no radio or no faults can be made of what is given.
    """
    text = None if faults is None else str(faults)
    setup = Setup(
        scheme=scheme,
        seed=seed,
        max_time=max_time,
        link_delay=link_delay,
        link_loss=link_loss,
        kills=tuple(_kill(kill, robots) for kill in kills),
        radio=radio if radio is None or isinstance(radio, Radio) else parse_radio(str(radio)),
        faults=schedule_of(text, robots, clocks),
        faults_from=text,
        orders=orders_in(orders),
    )
    if faults is None:
        _check_deaths(setup.kills)
    tell_too_late(setup.kills, setup.max_time)
    return setup


def orders_in(orders: AnyPath | Sequence[OrderAt] | None) -> tuple[OrderAt, ...]:
    """Return the operator's orders, each with its time, in order: of a file, as they are given, or none.

    Raises:
        InputError: the file cannot be read, or is none of orders.
    """
    if isinstance(orders, str | Path):
        return load_orders(orders)
    return tuple(sorted(orders or (), key=lambda each: each.at))


def order_file(orders: object) -> str:
    """Return what orders are called where something is wrong with them: by their file, if they have one."""
    return str(orders) if isinstance(orders, str | Path) else "orders"


def links_of(setup: Setup) -> dict[str, Any]:
    """Return how a mission's robots tell each other anything, by the names of a caller's options."""
    return {name: getattr(setup, name) for name in ("scheme", "fusion", "radio", "link_delay", "link_loss")}


def schedule_of(text: str | None, robots: int, clocks: bool) -> Schedule | None:
    """Return the schedule of a file or a seed for a team; ``clocks``: they may go wrong.

    Raises:
        InputError: as :func:`vedette.sim.faults.load_faults`, or clocks go wrong that may not.
    """
    if text is None:
        return None
    schedule = load_faults(text, robots)
    right = [fault for fault in schedule.faults if not isinstance(fault, Skew)]
    if clocks or len(right) == len(schedule.faults):
        return schedule
    if text.strip().isdecimal():  # a seed asks for chance, within what can be
        return Schedule(tuple(right))
    raise InputError(f"{text}: fault skew: vehicles plan by a common clock; leave it out")


def _check_deaths(kills: Sequence[tuple[int, float]]) -> None:
    """Refuse to kill a robot that is dead; only a schedule of faults starts one anew."""
    robots = [robot for robot, _ in kills]
    for robot in robots:
        if robots.count(robot) > 1:
            raise InputError(f"kills: robot {robot + 1} dies twice; keep one")


def _kill(kill: tuple[int, float], robots: int) -> tuple[int, float]:
    """Return a robot's index, by its number from 1, and the time."""
    match kill:
        case (int() as robot, time) if 1 <= robot <= robots:
            return robot - 1, time
        case (int() as robot, _):
            raise InputError(f"kills: there is no robot {robot} in a team of {robots}")
    raise InputError(f"kills: must be pairs of a robot's number and a time [s]; got {brief(kill)}")


def world_of(world: AnyWorld, seed: int) -> World:
    """Return a world: itself, generated, of a map file, of cells that are solid, or else an office.

    A name of ``vedette.sim.worlds.WORLD``, where there is no such file, is that of a generator: the seed's
    world. ``(file, resolution)`` is a plain image, ``(solid, resolution)`` cells (R, C), row 0 the lowest y.

    Raises:
        InputError: it cannot be read or generated, or nothing is free in it.
    """
    place, *rest = world if isinstance(world, tuple) else (world, None)
    if (kind := _generator(place)) is not None:
        return generated(kind, seed, **({} if rest[0] is None else {"resolution": rest[0]}))
    match world:
        case None:
            return office(np.random.default_rng(seed))
        case World():
            return world
        case str() | Path():
            return World.from_map(world)
        case (str() | Path() as path, resolution):
            return World.from_map(path, resolution)
        case (cells, resolution):
            return _drawn(cells, resolution)
    raise InputError(f"a world is a World, a map file or (solid cells, resolution); got {brief(world)}")


def _generator(place: object) -> str | None:
    """Return the name of the generator that a world is of; None: it is none's."""
    if not isinstance(place, str | Path) or Path(place).exists():
        return None
    return str(place) if is_reference(str(place)) or str(place) in WORLD.names else None


def _drawn(cells: object, resolution: object) -> World:
    solid = np.asarray(cells)
    if solid.ndim != 2 or solid.dtype.kind not in "biuf":
        raise InputError(f"solid cells must be a table (R, C) of numbers; got {solid.dtype}{solid.shape}")
    solid = solid != 0
    if solid.all():
        raise InputError("a world must have free space; all cells given are solid")
    if not is_number(resolution) or resolution <= 0.0:
        raise InputError(f"resolution must be above 0 m; got {brief(resolution)}")
    return World(GridFrame(float(resolution), *solid.shape), solid, "cells")


def team_of(team: AnyTeam) -> Sequence[PlatformSpec]:
    """Return the robots of a team: so many alike, those of a file, or the ones given.

    Raises:
        InputError: the file cannot be used, or there are none.
    """
    if isinstance(team, str | Path):
        return load_team(team)
    if is_whole(team):
        return check_team([PlatformSpec(name=f"robot-{number}") for number in range(1, team + 1)])
    return check_team(cast(Sequence[PlatformSpec], team))


def described(scenario: ScenarioT | Mapping[str, Any], kind: type[ScenarioT]) -> ScenarioT:
    """Return a scenario that was made in Python, its fields checked as a file's are."""
    plain = scenario if isinstance(scenario, Mapping) else msgspec.to_builtins(scenario)
    return as_scenario(plain, kind, "scenario")


def files_of(world: object, *others: object) -> tuple[Path, ...]:
    """Return which files a mission has been read from, of a world and of what may be one."""
    place = world[0] if isinstance(world, tuple) else world
    maps = map_files(Path(place)) if isinstance(place, str | Path) and _generator(place) is None else ()
    return (*maps, *(Path(other) for other in others if isinstance(other, str | Path)))
