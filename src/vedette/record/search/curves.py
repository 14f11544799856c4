"""The probability that a search has found its target, against time: at best, predicted, counted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from vedette.domains.search import bounds
from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.detectors import Detector
from vedette.kernels.search import propagate
from vedette.missions.search.case import SearchCase
from vedette.record.log import Floats

Looks: TypeAlias = Sequence[Mapping[int, Floats]]
"""By vehicle: the poses (L, 3) that it looked from, by the step at whose end they count."""


@dataclass(frozen=True, eq=False)
class Curves:
    """By the end of each step; (K + 1,) each."""

    times: Floats  # [s]
    bound: Floats  # no team can do better, docs/search.md (V52)
    koopman: Floats  # the swept area allocated at best, (V51): no bound for definite-range sensors
    detection: Mapping[str, Floats] = field(default_factory=dict)  # predicted, by coordination
    counted: Floats | None = None  # share of the trials that had found their target


def predicted(pdf: TargetPdf, detectors: Sequence[Detector], looks: Looks, steps: int) -> Floats:
    """``C_k = 1 - sum_x q_k(x)``, ``q_0 = P``, ``q_k = (T q_{k-1}) m_k``: (steps + 1,); docs/search.md (V43).

    The probability that the looks made by step k have detected the target, whatever anybody knew of them.
    """
    left, detection = pdf.mass, [0.0]
    for step in range(1, steps + 1):
        left = missed(left, pdf, detectors, looks, step)
        detection.append(1.0 - float(left.sum()))
    return np.array(detection)


def missed(left: Floats, pdf: TargetPdf, detectors: Sequence[Detector], looks: Looks, step: int) -> Floats:
    """Return ``q_k`` (R, C) of ``q_{k-1}``: what everybody's looks of a step leave after the target moved."""
    left = propagate(left, pdf.stencil)
    for detector, made in zip(detectors, looks, strict=True):
        if step in made:
            _, cells, detection = detector.footprints(pdf.frame, made[step][None])
            left.ravel()[cells] *= 1.0 - detection
    return left


def ideal(case: SearchCase, steps: int) -> Curves:
    """Return the ideal searches of a case, as if no target ever came to the area's border."""
    pdf, time = case.pdf, np.arange(steps + 1, dtype=np.float64) * case.scenario.step
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
    return Curves(time, np.minimum(bound, 1.0), bounds.allocation(pdf.mass, cell, swept))
