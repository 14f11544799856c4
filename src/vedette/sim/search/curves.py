"""How likely a search has found its target by when: predicted, counted over trials, and at best."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search import bounds
from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.detectors import Detector
from vedette.kernels.search import propagate
from vedette.missions.search.case import SearchCase
from vedette.sim.search.hidden import draw_places

Floats = NDArray[np.float64]
Looks = Sequence[Mapping[int, Floats]]  # by vehicle: poses (L, 3) by the step at whose end they count


def predicted(pdf: TargetPdf, detectors: Sequence[Detector], looks: Looks, steps: int) -> Floats:
    """``C_k = 1 - sum_x q_k(x)``, ``q_0 = P``, ``q_k = (T q_{k-1}) m_k``: (steps + 1,); docs/search.md (V43).

    The probability that the looks made by step k have detected the target, whatever anybody knew of them.
    """
    left, detection = pdf.mass, [0.0]
    for step in range(1, steps + 1):
        left = missed(propagate(left, pdf.stencil), pdf, detectors, looks, step)
        detection.append(1.0 - float(left.sum()))
    return np.array(detection)


def missed(left: Floats, pdf: TargetPdf, detectors: Sequence[Detector], looks: Looks, step: int) -> Floats:
    """Return what everybody's looks of a step leave of the probability in each cell, (R, C)."""
    left = left.copy()
    for detector, made in zip(detectors, looks, strict=True):
        if step in made:
            _, cells, detection = detector.footprints(pdf.frame, made[step][None])
            left.ravel()[cells] *= 1.0 - detection
    return left


def detected_at(
    pdf: TargetPdf,
    detectors: Sequence[Detector],
    looks: Looks,
    steps: int,
    trials: int,
    rng: np.random.Generator,
) -> NDArray[np.int64]:
    """Draw targets from the prior, move them by the model, and look at them as the vehicles did.

    Returns:
        ``(trials,)`` the step at whose end each was first detected; ``steps + 1`` for those that never were.
    """
    places = draw_places(pdf, trials, rng)
    first = np.full(trials, steps + 1)
    for step in range(1, steps + 1):
        places = pdf.motion.move(rng, places, pdf.frame, pdf.dt)
        for detector, made in zip(detectors, looks, strict=True):
            for pose in made.get(step, ()):
                found = rng.random(trials) < detector.chance(pose, places)
                first[found] = np.minimum(first[found], step)
    return first


@dataclass(frozen=True, eq=False)
class Ideal:
    """What no team can exceed, and what it is usually compared with; (steps + 1,) each."""

    bound: Floats  # docs/search.md (V52)
    koopman: Floats  # best allocation of the swept area, (V51): no bound for definite-range sensors


def ideal(case: SearchCase, steps: int) -> Ideal:
    """Return the ideal searches of a case at each step, as if no target ever came to the area's border."""
    pdf, time = case.pdf, np.arange(steps + 1) * case.scenario.step
    cell = pdf.frame.resolution**2
    effort, covered, swept = (np.zeros(steps + 1) for _ in range(3))
    wander = bounds.wander(pdf.motion, pdf.dt)
    for i, (vehicle, detector) in enumerate(zip(case.scenario.vehicles, case.detectors, strict=True)):
        looks = case.looks(i)
        effort[1:] += bounds.search_effort(detector) * looks * np.arange(1, steps + 1)
        covered[1:] += bounds.covered_area(detector, vehicle.speed + wander, time[1:], 1)
        width = bounds.sweep_width(detector, vehicle.speed, pdf.dt / looks)
        swept += width * vehicle.speed * time
    finite = np.isfinite(effort)
    by_effort = np.ones(steps + 1)
    by_effort[finite] = bounds.allocation(pdf.mass, cell, effort[finite])
    bound = np.minimum(by_effort, bounds.top_mass(pdf.mass, cell, covered))
    return Ideal(np.minimum(bound, 1.0), bounds.allocation(pdf.mass, cell, swept))


def dkw(trials: int, confidence: float = 0.95) -> float:
    """``sqrt(ln(2 / (1 - c)) / (2 n))``: half width of a band that holds a whole distribution function.

    Dvoretzky, Kiefer, Wolfowitz; Massart's constant.
    """
    return math.sqrt(math.log(2.0 / (1.0 - confidence)) / (2.0 * trials))


def wilson(found: int, trials: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a probability from ``found`` of ``trials``."""
    z, share = 1.959963984540054, found / trials
    middle = (share + z * z / (2.0 * trials)) / (1.0 + z * z / trials)
    half = z * math.sqrt(share * (1.0 - share) / trials + (z / (2.0 * trials)) ** 2) / (1.0 + z * z / trials)
    return max(0.0, middle - half), min(1.0, middle + half)
