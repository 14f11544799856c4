"""What every part of a reproduction is given: how much to compute, with which seed, and where to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vedette_reproduction.missions import PAPERS, Case, Missions, ReproducedMission


@dataclass(frozen=True)
class RunScale:
    """How much is computed."""

    teams: tuple[int, ...]  # team sizes
    largest_dense: int  # team where everybody's impact covers an area that grows with the team
    trials: int  # random cases of a kind
    scan_offices: int  # offices that Fig. 3 scans
    scans: int  # places in each
    mission_seeds: tuple[int, ...]  # of the missions of claim C12, Fig. 6's first
    mission_planners: tuple[str, ...]  # of the same, Fig. 6's among them
    targets: int  # drawn for claim C13
    office: tuple[float, float]  # width and height of that of the missions [m]

    @property
    def dense_teams(self) -> tuple[int, ...]:
        """Team sizes where everybody's impact covers an area that grows with the team."""
        return tuple(n for n in self.teams if n <= self.largest_dense)


FULL = RunScale(
    teams=(2, 4, 8, 16, 32, 64, 128),
    largest_dense=64,
    trials=40,
    scan_offices=10,
    scans=60,
    mission_seeds=(0, 1, 2, 3),
    mission_planners=("rate", "tours", "nearest"),
    targets=100_000,
    office=(30.0, 20.0),
)
QUICK = RunScale(
    teams=(2, 4, 8, 16, 32),
    largest_dense=32,
    trials=12,
    scan_offices=4,
    scans=30,
    mission_seeds=(0,),
    mission_planners=("rate", "tours"),
    targets=20_000,
    office=(30.0, 20.0),
)


@dataclass(frozen=True, eq=False)
class ReproductionRun:
    """One reproduction."""

    scale: RunScale
    seed: int
    figures: Path  # folder for the pictures
    missions: Missions
    tell: Callable[[str], None]  # what is being computed, for the progress display

    def rng(self, *key: int) -> np.random.Generator:
        """Return a stream of chance of its own for a part; the same whatever else was computed."""
        return np.random.default_rng([self.seed, *key])

    def mission(self, planner: str = PAPERS, seed: int | None = None) -> ReproducedMission:
        """Return the mission of a planner, that of Fig. 6 unless the office's seed says otherwise."""
        seed = self.scale.mission_seeds[0] if seed is None else seed
        return self.missions.get(Case(planner, seed, *self.scale.office))
