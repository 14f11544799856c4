"""Whole missions through faults and out of each other's range: complete in the end, and nobody is touched.

A failing mission replays with ``python -m tests.missions.test_faulty SEED``.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.small_missions import robots, run, small_maze, small_office
from vedette.domains.mapping.stops import CLEARANCES
from vedette.kernels.motion import block_discs
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.maps.world import World
from vedette.record.explore.observer import ExploreReport
from vedette.record.explore.score import Reference
from vedette.record.links import parts
from vedette.sim.explore.simulation import ExploreSimulation
from vedette.sim.faults import Schedule, faults_from_seed
from vedette.sim.radio import Radio
from vedette.team import PlatformSpec

QUICK = 5
ALL = 105
FAULTY = 40.0  # then everything that can heal is healed [s]
TRICKLE = 20  # cells that differ because robots that stand go on to scan, and share every other second
BODY = 0.5  # about a robot where its body may be when others see it: between samples it goes on [m]


@dataclass(frozen=True, eq=False)
class Plan:
    """A team, its building, and what befalls it."""

    world: World
    robots: int
    radio: Radio | None
    faults: Schedule

    @classmethod
    def of(cls, seed: int) -> Plan:
        """Return the plan of a seed."""
        rng = np.random.default_rng((seed, 9))
        n = int(rng.integers(2, 5))
        world = (small_maze if rng.random() < 0.5 else small_office)(int(rng.integers(3)))
        radio = None if rng.random() < 0.5 else Radio(8.0, 3.0)
        return cls(world, n, radio, faults_from_seed(seed, n, FAULTY))


def check_map(world: World, classes: NDArray[np.uint8], poses: NDArray[np.float64]) -> None:
    """Away from walls a map is right, but for robots that were seen when they could not say where they are.

    ``poses``: ``(T, n, 3)`` of all robots at all times.
    """
    edge = _near_edge(world.solid)
    assert not (world.solid & (classes == FREE) & ~edge).any()
    wrong = np.argwhere(~world.solid & (classes == OCCUPIED) & ~edge)
    resolution = world.frame.resolution
    bodies = poses[..., :2].reshape(-1, 2) - (world.frame.origin_x, world.frame.origin_y)
    for row, col in wrong.tolist():
        away = np.hypot(*(bodies - ((col + 0.5) * resolution, (row + 0.5) * resolution)).T)
        assert away.min() < BODY, f"an obstacle at row {row}, column {col}, where nobody has ever been"


def _near_edge(solid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Cells beside one of the other kind: there a range error below a cell decides."""
    padded = np.pad(solid, 1, constant_values=True)
    rows, cols = solid.shape
    around = [padded[r : r + rows, c : c + cols] for r in range(3) for c in range(3)]
    return np.asarray(np.logical_or.reduce(around) & ~np.logical_and.reduce(around))


def covered(simulation: ExploreSimulation, report: ExploreReport) -> float:
    """Return the share known of what those who live can see from where they can go.

    A robot that died in a doorway closes the room behind it. Nobody plans to pass it by less than 1 cm.
    """
    world, bodies = simulation.world, simulation.robots.bodies
    dead = [(x, y, spec.radius + CLEARANCES[-1]) for (x, y, _), spec in _robots(simulation, ~bodies.alive)]
    closed = ~block_discs(~world.solid, world.frame.resolution, dead)
    living = _robots(simulation, bodies.alive)
    left = replace(world, solid=closed)
    seen = [Reference(left, [spec], np.array([pose])).coverable for pose, spec in living]
    return float((report.classes != UNKNOWN)[np.logical_or.reduce(seen)].mean())


def _robots(
    simulation: ExploreSimulation, which: NDArray[np.bool_]
) -> list[tuple[tuple[float, float, float], PlatformSpec]]:
    return [(simulation.pose(i), simulation.specs[i]) for i in np.flatnonzero(which).tolist()]


def check_mission(simulation: ExploreSimulation, report: ExploreReport) -> None:
    """Complete, true, untouched, and the same map wherever robots reach each other."""
    summary = report.summary
    assert summary.outcome.value == "complete"
    assert covered(simulation, report) >= 0.99
    assert summary.collisions == 0
    assert all(agent.dropped == 0 for agent in simulation.agents)
    check_map(simulation.world, report.classes, report.log.poses)
    for part in parts(simulation.field.alive.tolist(), simulation.network.links()):
        maps = [simulation.missions[i].fusion.classes.window() for i in part]
        unlike = max(int((one != maps[0]).sum()) for one in maps)
        assert unlike <= TRICKLE, f"maps of {part} differ in {unlike} cells"


def play(seed: int) -> ExploreReport:
    """Run one mission and check it; a failure names the command that replays it."""
    plan = Plan.of(seed)
    simulation, report = run(
        plan.world, robots(plan.robots), seed=seed, faults=plan.faults, radio=plan.radio, max_time=400.0
    )
    try:
        check_mission(simulation, report)
    except AssertionError as error:
        faults = "\n  ".join(map(str, plan.faults.faults))
        replay = f"replay: python -m tests.missions.test_faulty {seed}\n  {plan.radio}\n  {faults}"
        raise AssertionError(f"{replay}\n{report.summary}\n{error}") from error
    return report


@pytest.mark.parametrize("seed", range(QUICK))
def test_a_mission_goes_through_faults(seed: int) -> None:
    play(seed)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(QUICK, ALL, 10))
def test_a_hundred_missions_go_through_faults(first: int) -> None:
    for seed in range(first, first + 10):
        play(seed)


if __name__ == "__main__":
    print(play(int(sys.argv[1])).summary.to_json())
