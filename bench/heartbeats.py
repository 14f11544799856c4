"""How late a robot's heartbeat comes while the robot plans on a large map, in a thread beside it."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from itertools import islice

import numpy as np

from bench.criteria import Criterion, Measurement
from vedette.kernels import distance, frontier
from vedette.maps import FREE, OCCUPIED

SIDE = 2000  # of the map [cells]
PERIOD = 0.02  # of the heartbeats [s]


def measure_heartbeats(asked: float, beats: int) -> Measurement:
    """Judge how late 19 of 20 heartbeats are, at most, while another thread plans without a pause [ms]."""
    ended = threading.Event()
    planner = threading.Thread(target=_plan, args=(ended,))
    planner.start()
    try:
        late = list(islice(_lateness(), beats))
    finally:
        ended.set()
        planner.join()
    median, p95, longest = np.percentile(late, (50.0, 95.0, 100.0))
    note = f"p95, median {median:.1f} ms, longest {longest:.1f} ms; wall time, {beats} beats on one core"
    return Measurement(Criterion(f"heartbeat beside planning, {SIDE}x{SIDE}", asked, "ms"), float(p95), note)


def _lateness() -> Iterator[float]:
    """Sleep from beat to beat, and yield by how much each is missed [ms]."""
    due = time.perf_counter()
    while True:
        due = max(due + PERIOD, time.perf_counter())
        time.sleep(max(due - time.perf_counter(), 0.0))
        yield 1e3 * (time.perf_counter() - due)


def _plan(ended: threading.Event) -> None:
    """Find the ways of a robot on a large map again and again."""
    classes = np.full((SIDE, SIDE), FREE, np.uint8)
    classes[:: SIDE // 10] = OCCUPIED
    classes[:, SIDE // 2] = FREE
    while not ended.is_set():
        distance.distance_field(frontier.traversable(classes, 0.3, 0.1), SIDE // 2, 0.1)
