"""Two robots of a mission that may get in each other's way, and where they could go."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.layers import rate
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.platform import MappingPlatform
from vedette.problem import exhaustive
from vedette_reproduction.frontiers import frozen, reachable, robot_at
from vedette_reproduction.missions import ReproducedMission, specs
from vedette_reproduction.run import ReproductionRun
from vedette_reproduction.scans import scan, spaced

MOMENTS = np.linspace(0.15, 0.60, 16)  # that are tried: shares of the mission's coverage
OBJECTIVE = MappingObjective()


@dataclass(frozen=True, eq=False)
class ContestScene:
    """Two robots of a mission, the map as they and their mate know it, and where they could go."""

    belief: MapBelief
    classes: NDArray[np.uint8]
    mission: ReproducedMission
    platforms: list[MappingPlatform]
    candidates: list[list[Impact]]  # one a reachable stop
    stops: list[NDArray[np.int64]]  # the stop of each candidate


def make_scenes(run: ReproductionRun) -> Iterator[ContestScene]:
    """Yield two robots' situations at moments of a mission."""
    mission = run.mission()
    reached = np.maximum.accumulate(mission.report.log.coverage)
    for share in MOMENTS:
        run.tell(f"when {100 * share:.0f} % were covered")
        yield make_scene(mission, int(np.searchsorted(reached, share)), run)


def make_scene(mission: ReproducedMission, moment: int, run: ReproductionRun) -> ContestScene:
    """Scan along the ways of a mission's robots up to a moment, and list where two of them could go."""
    poses = mission.report.log.poses[: moment + 1]
    way = np.concatenate([spaced(poses[:, i], 0.5) for i in range(poses.shape[1])])
    team = specs()[:2]
    scanned = scan(mission.world, way, team[0], run.rng(4))
    belief = frozen(scanned.classes, mission.world.frame, team[0], rate(), scanned.counts)
    platforms, candidates, stops = [], [], []
    for i, spec in enumerate(team):
        x, y, _ = poses[-1, i].tolist()
        platform = robot_at(x, y, spec, belief)
        platforms.append(platform)
        stops.append(reachable(platform))
        candidates.append([platform.impact(belief, platform.tour(np.array([stop]))) for stop in stops[-1]])
    return ContestScene(belief, scanned.classes, mission, platforms, candidates, stops)


def selfish_choice(scene: ContestScene) -> tuple[list[int], float]:
    """Return what each would choose if it were alone, and what that is worth together."""
    nothing = OBJECTIVE.nothing(scene.belief)
    alone = [int(np.argmax(OBJECTIVE.values(scene.belief, nothing, own))) for own in scene.candidates]
    together = OBJECTIVE.combine(*(own[k] for own, k in zip(scene.candidates, alone, strict=True)))
    return alone, OBJECTIVE.value(scene.belief, together)


def share_of_selfish(scene: ContestScene) -> float:
    """Return the value of two choices made alone, as a share of the optimum."""
    return selfish_choice(scene)[1] / exhaustive(OBJECTIVE, scene.belief, scene.candidates).value
