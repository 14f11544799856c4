"""What a mission is made of, as a caller may say it: each thing checked, and put into its own type."""

from __future__ import annotations

import math
import numbers
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias, TypedDict, TypeVar

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from vedette.errors import InputError, nearest_name
from vedette.maps import GridFrame, map_files
from vedette.maps.world import World
from vedette.negotiation import SCHEMES
from vedette.scenario import as_scenario
from vedette.sim.faults import Schedule, load_faults
from vedette.sim.faults.kinds import Skew
from vedette.sim.radio import Radio, parse_radio
from vedette.sim.simulation import Setup
from vedette.sim.worlds import office
from vedette.team import PlatformSpec, load_team

ROBOTS = 3
MOST_DELAY, MOST_LOSS = 0.3, 0.9  # of a link [s], [1]

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


def setup_of(
    robots: int,
    *,
    scheme: str,
    seed: int,
    max_time: float,
    clocks: bool = False,
    radio: Radio | float | str | None = None,
    faults: int | AnyPath | None = None,
    link_delay: float = Setup.link_delay,
    link_loss: float = Setup.link_loss,
    kills: Sequence[tuple[int, float]] = (),
) -> Setup:
    """Return what all simulated missions share, checked; ``clocks``: they may go wrong.

    Raises:
        InputError: a value cannot be.
    """
    if isinstance(seed, bool) or not isinstance(seed, numbers.Integral) or seed < 0:
        raise InputError(f"seed must be a whole number, 0 or more; got {seed!r}")
    if not 0.0 <= link_loss <= MOST_LOSS:
        raise InputError(f"link_loss must be 0 to {MOST_LOSS:g}; got {link_loss!r}")
    text = None if faults is None else str(faults)
    return Setup(
        scheme=word("scheme", scheme, SCHEMES),
        seed=int(seed),
        max_time=positive("max_time", max_time, "s"),
        link_delay=positive("link_delay", link_delay, "s", MOST_DELAY),
        link_loss=link_loss,
        kills=tuple(_kill(robot, time, robots) for robot, time in kills),
        radio=radio if radio is None or isinstance(radio, Radio) else parse_radio(str(radio)),
        faults=schedule_of(text, robots, clocks),
        faults_from=text,
    )


def word(what: str, value: str, words: Sequence[str]) -> str:
    """Return a word of a list; InputError, with the nearest one, for another."""
    if value not in words:
        raise InputError(f"unknown {what} {value!r}: {nearest_name(str(value), words)}")
    return value


def positive(what: str, value: float, unit: str, most: float = math.inf) -> float:
    """Return a finite number above zero; InputError for another, or for one above the most."""
    if not (isinstance(value, numbers.Real) and 0.0 < value <= most and math.isfinite(value)):
        limit = "" if math.isinf(most) else f" and at most {most:g}"
        raise InputError(f"{what} must be above 0{limit} {unit}; got {value!r}")
    return float(value)


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


def _kill(robot: int, time: float, robots: int) -> tuple[int, float]:
    if not 1 <= robot <= robots:
        raise InputError(f"kill {robot}@{time:g}: there is no robot {robot}; they are 1 to {robots}")
    if not 0.0 <= time < math.inf:
        raise InputError(f"kill {robot}@{time:g}: the time must be 0 s or more")
    return robot - 1, float(time)


def world_of(world: AnyWorld, seed: int) -> World:
    """Return a world: itself, of a map file, of cells that are solid with their side, or else an office.

    ``(file, resolution)`` is a plain image; ``(solid, resolution)`` cells (R, C), row 0 the lowest y.

    Raises:
        InputError: it cannot be read, or nothing is free in it.
    """
    match world:
        case None:
            return office(np.random.default_rng(seed))
        case World():
            return world
        case str() | Path():
            return World.from_map(world)
        case (str() | Path() as path, resolution):
            return World.from_map(path, resolution)
        case (cells, float() | int() as resolution):
            return _drawn(cells, resolution)
    raise InputError(
        f"a world is a World, a map file or (solid cells, resolution); got {type(world).__name__}"
    )


def _drawn(cells: ArrayLike, resolution: float) -> World:
    solid = np.asarray(cells)
    if solid.ndim != 2 or solid.dtype.kind not in "biuf":
        raise InputError(f"solid cells must be a table (R, C) of numbers; got {solid.dtype}{solid.shape}")
    solid = solid != 0
    if solid.all():
        raise InputError("a world must have free space; all cells given are solid")
    return World(GridFrame(positive("resolution", resolution, "m"), *solid.shape), solid, "cells")


def team_of(team: AnyTeam) -> list[PlatformSpec]:
    """Return the robots of a team: so many alike, those of a file, or the ones given.

    Raises:
        InputError: there are none, or two have one name.
    """
    if isinstance(team, str | Path):
        return load_team(team)
    if isinstance(team, int | np.integer):
        if team < 1:
            raise InputError(f"a team has at least 1 robot; got {team}")
        return [PlatformSpec(name=f"robot-{number}") for number in range(1, int(team) + 1)]
    specs = list(team)
    names = [spec.name for spec in specs]
    if not specs:
        raise InputError("a team has at least 1 robot; got none")
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise InputError(f"the name {twice!r} is used twice; names must differ")
    return specs


def described(scenario: ScenarioT | Mapping[str, Any], kind: type[ScenarioT]) -> ScenarioT:
    """Return a scenario that was made in Python, its fields checked as a file's are."""
    plain = scenario if isinstance(scenario, Mapping) else msgspec.to_builtins(scenario)
    return as_scenario(plain, kind, "scenario")


def files_of(world: object, *others: object) -> tuple[Path, ...]:
    """Return which files a mission has been read from, of a world and of what may be one."""
    place = world[0] if isinstance(world, tuple) else world
    maps = map_files(Path(place)) if isinstance(place, str | Path) else ()
    return (*maps, *(Path(other) for other in others if isinstance(other, str | Path)))
