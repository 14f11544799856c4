"""The probability that a search has found its target, against time: at best, predicted, counted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from vedette.domains.search import bounds
from vedette.missions.search.case import SearchCase
from vedette.record.log import Floats


@dataclass(frozen=True, eq=False)
class Curves:
    """By the end of each step; (K + 1,) each."""

    times: Floats  # [s]
    bound: Floats  # no team can do better, docs/search.md (V52)
    koopman: Floats  # the swept area allocated at best, (V51): no bound for definite-range sensors
    detection: Mapping[str, Floats] = field(default_factory=dict)  # predicted, by coordination
    outside: Floats | None = None  # predicted to have left undetected; None: the target cannot leave
    counted: Floats | None = None  # share of the trials that had found their target
    mistaken: Floats | None = None  # share that had declared another place; None: there are no false alarms


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
