"""Small seas, random impacts, and teams that search in closed loop, for the tests of the search domain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search import worth
from vedette.domains.search.belief import SearchBelief, TargetPdf, freeze
from vedette.domains.search.detectors import DefiniteRange, Detector
from vedette.domains.search.impact import NOTHING, Impact
from vedette.domains.search.motion import STILL, TargetMotion
from vedette.domains.search.objective import SearchObjective
from vedette.domains.search.platform import SearchPlatform
from vedette.domains.search.priors import GaussianPart, gaussians
from vedette.domains.search.worth import Worth
from vedette.maps import GridFrame

SEA = GridFrame(20.0, 60, 70, -300.0, 100.0)  # 1400 m by 1200 m
MOVING = TargetMotion((4.0, -2.0), 30.0)
OBJECTIVE = SearchObjective()
EYE = DefiniteRange(detection=0.8, range=80.0)


def pdf(motion: TargetMotion = STILL, dt: float = 2.0) -> TargetPdf:
    """Two places where the target may be, the nearer one less likely."""
    parts = [GaussianPart((0.0, 500.0), 90.0, 1.0), GaussianPart((800.0, 900.0), 120.0, 2.0)]
    return TargetPdf(SEA, gaussians(SEA, parts), motion, dt)


def frozen(motion: TargetMotion = STILL, worths: Worth | None = None) -> SearchBelief:
    """Return the belief of a round of four steps."""
    return freeze(pdf(motion), worths or worth.plain(4))


def team(belief: SearchBelief, detector: Detector = EYE, size: int = 3) -> list[SearchPlatform]:
    """Return vehicles side by side south of the nearer place, heading north, prepared."""
    platforms = [
        SearchPlatform(speed=30.0, turn_rate=0.4, detector=detector, controls=4) for _ in range(size)
    ]
    for i, platform in enumerate(platforms):
        platform.place((-60.0 + 60.0 * i, 400.0, np.pi / 2), None)
        platform.prepare(belief)
    return platforms


def random_impact(belief: SearchBelief, rng: np.random.Generator, certain: bool = False) -> Impact:
    """Return log-misses scattered over all layers, near the nearer place so that they overlap."""
    row, col = belief.frame.cell(0.0, 500.0)
    keys = []
    for layer in range(belief.layers):
        r, c = rng.integers((row - 4, col - 4), (row + 5, col + 5), (40, 2)).T
        keys.append((r * belief.frame.cols + c) * belief.layers + layer)
    distinct = np.unique(np.concatenate(keys)).astype(np.uint32)
    levels = np.full(len(distinct), 255) if certain else rng.integers(1, 60, len(distinct))
    return Impact(distinct, levels.astype(np.uint8))


def agree(platforms: Sequence[SearchPlatform], belief: SearchBelief, sweeps: int = 2) -> list[Impact]:
    """Reply in turn against the rest of the team; return everybody's impact and keep the flights."""
    flights = [platform.start for platform in platforms]
    impacts = [NOTHING for _ in platforms]
    for _ in range(sweeps):
        for i, platform in enumerate(platforms):
            others = NOTHING
            for j, impact in enumerate(impacts):
                others = OBJECTIVE.combine(others, impact) if j != i else others
            flights[i] = platform.reply(belief, others, flights[i])
            impacts[i] = platform.impact(belief, flights[i])
    for platform, flight in zip(platforms, flights, strict=True):
        platform.present = flight
    return impacts


def search(
    platforms: Sequence[SearchPlatform], target: TargetPdf, worths: Worth, rounds: int, every: int = 2
) -> tuple[TargetPdf, NDArray[np.float64], NDArray[np.float64]]:
    """Search in closed loop, nobody ever detecting anything; a round every few steps.

    Returns:
        the pdf at the end, the miss probability of each step, and all poses, ``(steps, platforms, 3)``.
    """
    missed, poses = [], []
    for _ in range(rounds):
        belief = freeze(target, worths)
        for platform in platforms:
            platform.prepare(belief)
        agree(platforms, belief)
        for step in range(every):
            target = target.predict()
            left = target.mass.ravel().copy()
            for platform in platforms:
                assert platform.present is not None
                looks = platform.look_poses(platform.pose, platform.present.turn_rates[step], target.dt)
                _, cells, detection = platform.detector.footprints(target.frame, looks[None])
                left[cells] *= 1.0 - detection
                platform.place(looks[-1], platform.present)
            missed.append(left.sum())
            target = TargetPdf(
                target.frame, left.reshape(target.frame.shape), target.motion, target.dt, target.step
            )
            poses.append([platform.pose for platform in platforms])
    return target, np.array(missed), np.array(poses)
