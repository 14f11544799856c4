"""Planning behind walls with holes, and among speckle, beside the same walls whole."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from bench.criteria import Criterion, Measurement
from bench.speed import Run, run_in, team
from vedette.kernels.visibility import visible_cells
from vedette.maps.world import World, reachable_poses
from vedette.sim.explore.run import prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import office

ROBOTS = 3
YARD = 3.0  # free ground around the building, seen through its holes [m]
BESIDE_STARTS = 0.5  # nearer than this to a start nothing is added [m]
MOST_MS, MOST_TIMES = 60.0, 3.0  # asked of the 95th percentile, as it is and against whole walls
MOST_SIGHT_MS = 1000.0  # asked of ``visible_cells``


@dataclass(frozen=True)
class Wear:
    """What became of a building's walls, each one cell thick."""

    name: str
    missing: float  # share of the walls' cells
    speckle: float = 0.0  # share of all cells that are solid for no reason


WHOLE = Wear("whole", 0.0)
WEARS = (
    Wear("2 %", 0.02),
    Wear("5 %", 0.05),
    Wear("10 %", 0.1),
    Wear("20 %", 0.2),
    Wear("speckle", 0.05, 0.001),
)


@dataclass(frozen=True)
class Site:
    """A building, and how long a team explores it."""

    width: float  # [m]
    height: float  # [m]
    resolution: float  # [m]
    max_time: float = 40.0  # [s]


def measure_porous(site: Site, wears: Sequence[Wear], progress: Callable[[str], None]) -> list[Measurement]:
    """Explore the same building with whole and with worn walls, from the same places, in one process."""
    whole = shells(office(np.random.default_rng(1), site.width, site.height, site.resolution))
    starts = prepare(whole, team(ROBOTS), ExploreSetup()).starts
    specs = [
        replace(spec, start=tuple(start[:2]))
        for spec, start in zip(team(ROBOTS), starts.tolist(), strict=True)
    ]
    runs: dict[str, Run] = {}
    sights: dict[str, float] = {}
    for wear in (WHOLE, *wears):
        progress(f"walls with holes at {site.resolution:g} m: {wear.name}")
        world = worn(whole, wear, starts, np.random.default_rng(2))
        runs[wear.name] = run_in(world, specs, 0, site.max_time)
        sights[wear.name] = visible_ms(world, starts[0])
    return judge(f"{site.resolution:g} m", runs, sights)


def judge(where: str, runs: dict[str, Run], sights: dict[str, float]) -> list[Measurement]:
    """Hold the worst of the worn buildings against what is asked, alone and beside the whole one."""
    spreads = {name: run.planning for name, run in runs.items()}
    whole, *worn = spreads
    worst = max(worn, key=lambda name: spreads[name].p95)
    note = "p50/p95 " + ", ".join(f"{name} {each.p50:.1f}/{each.p95:.1f}" for name, each in spreads.items())
    slowest = max(worn, key=lambda name: sights[name])
    return [
        Measurement(
            Criterion(f"replan, worn walls, {where}", MOST_MS, "ms"), spreads[worst].p95, f"{note} ms"
        ),
        Measurement(
            Criterion(f"replan, worn to whole walls, {where}", MOST_TIMES, "x"),
            spreads[worst].p95 / spreads[whole].p95,
            f"p95, worst {worst}; as many robots, from the same places",
        ),
        Measurement(
            Criterion(f"visible_cells, worn walls, {where}", MOST_SIGHT_MS, "ms"),
            sights[slowest],
            f"worst {slowest}; whole {sights[whole]:.1f} ms, its yard out of reach; once a mission",
        ),
    ]


def shells(world: World) -> World:
    """Hollow all walls out until they are one cell thick, and put the building into a yard."""
    hollow = world.solid & ~ndimage.binary_erosion(world.solid, np.ones((3, 3)), border_value=1)
    hollow[[0, -1]] = hollow[:, [0, -1]] = True
    solid = fenced(np.pad(hollow, round(YARD / world.frame.resolution)))
    rows, cols = solid.shape
    return World(replace(world.frame, rows=rows, cols=cols), solid, "office")


def worn(whole: World, wear: Wear, starts: NDArray[np.float64], rng: np.random.Generator) -> World:
    """Let cells of the walls go, and others appear, but none beside the robots' starts."""
    solid = whole.solid & (rng.random(whole.solid.shape) >= wear.missing)
    speckle = rng.random(solid.shape) < wear.speckle
    resolution = whole.frame.resolution
    for x, y in starts[:, :2] - (whole.frame.origin_x, whole.frame.origin_y):
        rows = (np.arange(solid.shape[0])[:, None] + 0.5) * resolution - y
        cols = (np.arange(solid.shape[1]) + 0.5) * resolution - x
        speckle &= np.hypot(rows, cols) > BESIDE_STARTS
    return World(whole.frame, fenced(solid | speckle), whole.name)


def fenced(solid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Close a grid's border."""
    solid[[0, -1]] = solid[:, [0, -1]] = True
    return solid


def visible_ms(world: World, start: NDArray[np.float64]) -> float:
    """Return the CPU time of finding all that a default robot can see [ms]."""
    spec = team(1)[0]
    poses = reachable_poses(world, spec.radius, start[0], start[1])
    began = time.process_time()
    visible_cells(world.solid, poses, spec.range / world.frame.resolution)
    return 1e3 * (time.process_time() - began)
