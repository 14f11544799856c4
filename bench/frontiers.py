"""Frontier extraction with clustering, on half-known maps, beside its twin."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from bench.criteria import Criterion, Measurement
from bench.half_known import half_known
from vedette.domains.mapping.belief import frontier_limits, longest_frontier
from vedette.kernels import frontier
from vedette.kernels.reference import frontier as reference_frontier
from vedette.sim.worlds import office
from vedette.team import PlatformSpec


@dataclass(frozen=True)
class Effort:
    """How much is measured."""

    maps: int  # worlds, seeds from 0
    repeats: int  # of the kernel on each map
    twin_repeats: int


def measure_frontiers(criterion: Criterion, width: float, height: float, effort: Effort) -> Measurement:
    """Time the kernel on half-known offices of this size [m]; the 95th percentile of the CPU time counts."""
    kernel: list[float] = []
    twin: list[float] = []
    clusters: list[int] = []
    for seed in range(effort.maps):
        rng = np.random.default_rng(seed)
        world = office(rng, width, height)
        spec = PlatformSpec()
        classes = half_known(world, spec, rng)
        limits = frontier_limits(longest_frontier(spec.range), world.frame.resolution)
        kernel += cpu_times(partial(frontier.find_frontiers, classes, *limits), effort.repeats)
        twin += cpu_times(partial(reference_frontier.find_frontiers, classes, *limits), effort.twin_repeats)
        clusters.append(len(frontier.find_frontiers(classes, *limits)[1]) - 1)
    p50, p95 = np.percentile(kernel, (50, 95)).tolist()
    slow = float(np.median(twin))
    note = (
        f"p95 of {len(kernel)}, median {p50:.3f} ms; {min(clusters)}-{max(clusters)} clusters; "
        f"twin {slow:.0f} ms, {slow / p50:.0f} times as long"
    )
    return Measurement(criterion, p95, note)


def cpu_times(call: Callable[[], object], repeats: int) -> list[float]:
    """Return the CPU time of each of ``repeats`` calls, after one that warms the caches [ms]."""
    call()
    times: list[float] = []
    for _ in range(repeats):
        began = time.process_time()
        call()
        times.append(1e3 * (time.process_time() - began))
    return times
