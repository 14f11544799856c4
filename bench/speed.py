"""Replans, answers, real-time factor and traffic, taken from whole missions."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vedette.maps import UNKNOWN
from vedette.maps.world import World
from vedette.record.explore.summary import ExploreSummary
from vedette.record.summary import Spread
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import office
from vedette.team import PlatformSpec


@dataclass(frozen=True)
class Run:
    """What one mission took."""

    seed: int
    summary: ExploreSummary
    planning: Spread  # CPU time of one robot's replan, all sweeps [ms]
    answer: Spread  # CPU time of one visit of the token [ms]
    real_time: float  # simulated over wall time of the mission's loop
    cpu_time: float  # simulated over CPU time of the same
    known: float  # share of the grid's cells known in the end

    def negotiation(self) -> float:
        """Return what the robot that negotiated most has sent [kB]."""
        return max(sent.negotiation for sent in self.summary.bytes.values()) / 1e3

    def fusion(self) -> float:
        """Return what the robot that shared most evidence has sent [kB]."""
        return max(sent.fusion for sent in self.summary.bytes.values()) / 1e3


def run_mission(seed: int, width: float, height: float, robots: int, max_time: float) -> Run:
    """Run the default planner in a generated office of this size [m], all agents in this process."""
    return run_in(office(np.random.default_rng(seed), width, height), team(robots), seed, max_time)


def team(robots: int) -> list[PlatformSpec]:
    """Return so many default robots."""
    return [PlatformSpec(name=f"robot-{number}") for number in range(1, robots + 1)]


def run_in(world: World, specs: Sequence[PlatformSpec], seed: int, max_time: float) -> Run:
    """Run the default planner in a world, all agents in this process."""
    simulation = prepare(world, specs, ExploreSetup(seed=seed, max_time=max_time))
    began = time.process_time()
    report = explore(simulation)
    cpu = time.process_time() - began
    timing = report.timing
    if timing.planning_ms is None or timing.answer_ms is None:
        raise RuntimeError(f"{world.name} {seed}: nothing was negotiated within {max_time:g} s")
    return Run(
        seed,
        report.summary,
        timing.planning_ms,
        timing.answer_ms,
        timing.real_time_factor,
        report.summary.time_s / cpu,
        float(np.mean(report.classes != UNKNOWN)),
    )
