"""A kernel at work stops no other thread: a robot that plans goes on to hear and to answer."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from vedette import _kernels as kernels  # NumPy, about them, lets other threads run now and then

OPEN = np.ones((1000, 1000), dtype=np.uint8)
WALLS = np.zeros_like(OPEN)
HALF = np.where(np.arange(1000) < 500, OPEN, 0).astype(np.uint8)
POSES = WALLS.copy()
POSES[500, ::10] = 1
KEYS = np.arange(400_000, dtype=np.uint32)
MISSES = np.full(len(KEYS), 5, np.uint8)
BAND = np.tile([0.0] * 50 + [2.0], (4000, 1))  # a diagonal matrix, kept as a band
NO_ROWS = np.zeros(1, np.int64), np.empty(0, np.int64), np.empty(0)


@pytest.fixture
def beats() -> Iterator[Callable[[], int]]:
    """How often a thread has had its turn that others' threads must give way to: none is interrupted."""
    turns, ended = [0], threading.Event()

    def count() -> None:
        while not ended.is_set():
            turns[0] += 1
            time.sleep(0.0)

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000.0)
    thread = threading.Thread(target=count)
    thread.start()
    yield lambda: turns[0]
    ended.set()
    thread.join()
    sys.setswitchinterval(interval)


@pytest.mark.parametrize(
    "kernel",
    [
        lambda: kernels.distance_field(OPEN, 500_500, 0.1),
        lambda: kernels.traversable(HALF, 0.5, 0.1),
        lambda: kernels.find_frontiers(HALF, 1, 20),
        lambda: kernels.visible_cells(WALLS, POSES, 40.0),
        lambda: kernels.combine(KEYS, MISSES, KEYS, MISSES, 32),
        lambda: kernels.field_factor(BAND, *NO_ROWS, np.empty(0)),
        lambda: kernels.field_variances(BAND),
    ],
    ids=[
        "distance_field",
        "traversable",
        "find_frontiers",
        "visible_cells",
        "combine",
        "field_factor",
        "field_variances",
    ],
)
def test_another_thread_has_its_turn_while_a_kernel_runs(
    kernel: Callable[[], object], beats: Callable[[], int]
) -> None:
    for _ in range(50):  # a busy host may let nobody else run for a while
        before = beats()
        kernel()
        if beats() > before:
            return
    pytest.fail("no other thread has had a turn")
