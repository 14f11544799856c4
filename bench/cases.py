"""Which missions the table is made of, and how one of them is run."""

from __future__ import annotations

import re
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from vedette.errors import InputError
from vedette.maps.world import World
from vedette.record.summary import SCHEMA_VERSION
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import office
from vedette.team import PlatformSpec

OFFICE = "office"
MAP_ROBOTS = 4
COARSE = 0.3  # maps from this resolution on [m] are large: a longer range and more time
COARSE_RANGE = 20.0  # [m]
MAX_TIME, COARSE_MAX_TIME = 3600.0, 3 * 3600.0  # [s]

Key = tuple[str, int, str, int]  # world, robots, planner, seed


@dataclass(frozen=True)
class Case:
    """One mission: a generated office, or the map in a file."""

    robots: int
    planner: str
    seed: int = 0
    map: Path | None = None  # None: an office, made from the seed

    @property
    def key(self) -> Key:
        """What tells the mission from all others, whatever the commit."""
        return (OFFICE if self.map is None else self.map.stem), self.robots, self.planner, self.seed

    def __str__(self) -> str:
        """Name the mission in a line of progress."""
        world, robots, planner, seed = self.key
        return f"{world}{f' {seed}' if self.map is None else ''}, {robots} robots, {planner}"


@dataclass(frozen=True)
class Result:
    """What the table needs to know of a mission; one line of the results file."""

    world: str
    robots: int
    planner: str
    seed: int
    outcome: str
    completed: bool
    coverage: float
    map_error_share: float
    collisions: int
    t90_s: float | None
    t99_s: float | None
    time_s: float
    path_m: float  # of a robot, on average
    wall_s: float
    commit: str
    schema_version: Literal[3] = SCHEMA_VERSION

    @property
    def key(self) -> Key:
        """The case's."""
        return self.world, self.robots, self.planner, self.seed


def office_cases(seeds: Sequence[int], robots: Sequence[int], planners: Sequence[str]) -> list[Case]:
    """Return the missions in default offices."""
    return [Case(team, planner, seed) for team in robots for planner in planners for seed in seeds]


def map_cases(folder: Path, planners: Sequence[str]) -> list[Case]:
    """Return the missions on every map of a folder, ``dungeon-2`` before ``dungeon-10``.

    Raises:
        InputError: it holds no map_server pair.
    """
    maps = sorted(folder.glob("*.yaml"), key=_natural)
    if not maps:
        raise InputError(f"--maps {folder} has no maps; give a folder with .yaml files and their images")
    return [Case(MAP_ROBOTS, planner, map=path) for path in maps for planner in planners]


def run_case(case: Case, commit: str) -> Result:
    """Run one mission to its end."""
    began = time.perf_counter()
    world = office(np.random.default_rng(case.seed)) if case.map is None else World.from_map(case.map)
    coarse = world.frame.resolution >= COARSE
    reach = COARSE_RANGE if coarse else PlatformSpec.range
    specs = [PlatformSpec(name=f"robot-{number}", range=reach) for number in range(1, case.robots + 1)]
    max_time = COARSE_MAX_TIME if coarse else MAX_TIME
    setup = ExploreSetup(planner=case.planner, seed=case.seed, max_time=max_time)
    summary = explore(prepare(world, specs, setup)).summary
    assert summary.coverage is not None, "the ground is known"
    return Result(
        *case.key,
        outcome=summary.outcome.value,
        completed=summary.completed,
        coverage=summary.coverage,
        map_error_share=summary.map_error_share,
        collisions=summary.collisions,
        t90_s=summary.t90_s,
        t99_s=summary.t99_s,
        time_s=summary.time_s,
        path_m=sum(summary.path_m.values()) / case.robots,
        wall_s=time.perf_counter() - began,
        commit=commit,
    )


def _natural(path: Path) -> list[str | int]:
    """Split a name into words and numbers, words at the even places."""
    return [int(part) if part.isdecimal() else part for part in re.split(r"(\d+)", path.stem)]
