"""All runs of a study: every combination of what its spec lists."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from vedette.domains.mapping.planners import planner
from vedette.errors import InputError, check_limits, check_word
from vedette.missions.explore.assemble import FUSIONS
from vedette.missions.pairs import scheme_of, tell_unheeded
from vedette.scenario import as_scenario
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.faults import Schedule, load_faults
from vedette.sim.radio import Radio, parse_radio
from vedette.sim.worlds import WORLD
from vedette.sim.worlds.size import world_frame
from vedette.study.run import OF_PLATFORM, OF_SETUP, GeneratedWorld, MapWorld, Run
from vedette.study.spec import Spec
from vedette.team import PlatformSpec

MOST_RUNS = 100_000
_LIMITS = {"link_loss": (0.0, 0.9, ""), "link_delay": (0.0, 0.3, "s"), "max_time": (1.0, math.inf, "s")}


def runs_of(spec: Spec, path: Path) -> list[Run]:
    """Return all runs of a spec, each once, those that differ in their planner alone next to each other.

    Args:
        spec: what to combine.
        path: its file, for messages and for the folder that other files are relative to.

    Raises:
        InputError: a planner, world, map or field that cannot be, or too many runs.
    """
    for name in spec.planners:
        _known_planner(name, path)
    worlds = list(_worlds(spec, path))
    platforms = list(_platforms(spec.platform, path))
    choices = list(_each(spec.setup, f"{path}: setup"))
    axes = worlds, spec.robots, spec.starts, spec.seeds, platforms, choices, spec.planners
    count = math.prod(len(axis) for axis in axes)
    if count > MOST_RUNS:
        raise InputError(f"{path}: {count} runs are too many, at most {MOST_RUNS}; shorten a list")
    for setup, name in itertools.product(choices, spec.planners):
        _check_scheme(setup.get("scheme"), name, path)
    setups = {robots: [_setup(fields, path, robots) for fields in choices] for robots in spec.robots}
    runs = (
        Run(world, robots, starts, platform, replace(setup, planner=name, seed=seed))
        for world, robots in itertools.product(worlds, spec.robots)
        for starts, seed, platform in itertools.product(spec.starts, spec.seeds, platforms)
        for setup, name in itertools.product(setups[robots], spec.planners)
    )
    return list(dict.fromkeys(runs))


def _check_scheme(scheme: Any, name: str, path: Path) -> None:
    """Refuse a scheme that is not the planner's; say so where the planner negotiates by none."""
    try:
        scheme_of(name, scheme)
    except InputError as error:
        raise InputError(f"{path}: setup: {error}") from None
    tell_unheeded(name, 0, scheme)


def _known_planner(name: str, path: Path) -> None:
    try:
        planner(name)
    except InputError as error:
        raise InputError(f"{path}: planners: {error}") from None


def _worlds(spec: Spec, path: Path) -> Iterator[GeneratedWorld | MapWorld]:
    for number, worlds in enumerate(spec.worlds):
        try:
            WORLD.find(worlds.kind)
        except InputError as error:
            raise InputError(f"{path}: worlds[{number}].kind: {error}") from None
        try:
            world_frame(worlds.width, worlds.height, worlds.resolution)
        except InputError as error:
            raise InputError(f"{path}: worlds[{number}]: {error}") from None
        for seed in worlds.seeds:
            yield GeneratedWorld(worlds.kind, seed, worlds.width, worlds.height, worlds.resolution)
    for number, entry in enumerate(spec.maps):
        try:
            yield MapWorld.read(path.parent / entry.file, entry.resolution)
        except InputError as error:
            raise InputError(f"{path}: maps[{number}]: {error}") from None


def _each(fields: Mapping[str, Any], where: str) -> Iterator[dict[str, Any]]:
    """Yield every combination of the values of fields; a list holds several values, anything else is one."""
    for name, value in fields.items():
        if value == []:
            raise InputError(f"{where}: {name} lists nothing; give a value, or leave it out")
    values = [value if isinstance(value, list) else [value] for value in fields.values()]
    for combination in itertools.product(*values):
        yield dict(zip(fields, combination, strict=True))


def _platforms(given: Mapping[str, Any] | Sequence[Mapping[str, Any]], path: Path) -> Iterator[PlatformSpec]:
    """Yield every combination of each set of fields."""
    where = f"{path}: platform"
    if not given and not isinstance(given, Mapping):
        raise InputError(f"{where}: lists nothing; give a mapping, or leave it out")
    sets = (
        {where: given}
        if isinstance(given, Mapping)
        else {f"{where}[{k}]": one for k, one in enumerate(given)}
    )
    for place, fields in sets.items():
        for combination in _each(fields, place):
            yield as_scenario(combination, PlatformSpec, place, OF_PLATFORM)


def _setup(fields: Mapping[str, Any], path: Path, robots: int) -> ExploreSetup:
    """Return a setup that a team of so many robots can have."""
    where = f"{path}: setup"
    written = {name: value for name, value in fields.items() if name not in _READ}
    setup = as_scenario(written, ExploreSetup, where, OF_SETUP)
    try:
        check_word("fusion", setup.fusion, FUSIONS)
        check_limits(setup, _LIMITS)
        read = {name: _READ[name](fields[name], path, robots) for name in _READ if name in fields}
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    named = None if read.get("faults") is None else str(fields["faults"])
    return replace(setup, **read, faults_from=named)


def _kills(value: Any, path: Path, robots: int) -> tuple[tuple[int, float], ...]:
    """Return robot indexes and times of ``{robot: time}``, robots from 1."""
    if not isinstance(value, dict):
        raise InputError(
            f"kills must be {{robot: seconds}}, such as {{1: 60}}, or a list of such; got {value!r}"
        )
    for robot, time in value.items():
        if isinstance(robot, bool) or not isinstance(robot, int) or not 1 <= robot <= robots:
            raise InputError(f"kills: there is no robot {robot!r} in a team of {robots}; they count from 1")
        if isinstance(time, bool) or not isinstance(time, int | float) or not time >= 0:
            raise InputError(f"kills: robot {robot} must die at 0 s or later; got {time!r}")
    return tuple((robot - 1, float(time)) for robot, time in value.items())


def _radio(value: Any, path: Path, robots: int) -> Radio | None:
    """Return the radio of ``range``, ``"range,wall_db"``, or none."""
    return None if value is None else parse_radio(str(value))


def _faults(value: Any, path: Path, robots: int) -> Schedule | None:
    """Return the schedule in a file, or that of a seed."""
    if value is None:
        return None
    seed = isinstance(value, int) or str(value).strip().isdecimal()
    return load_faults(str(value) if seed else str(path.parent / str(value)), robots)


# Fields that a spec gives in another form than ``ExploreSetup`` has them in.
_READ: Mapping[str, Callable[[Any, Path, int], Any]] = {
    "kills": _kills, "radio": _radio, "faults": _faults,
}  # fmt: skip
