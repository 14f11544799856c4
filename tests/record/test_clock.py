"""Planning is counted by CPU time."""

from __future__ import annotations

import threading
import time

from vedette.agent.effects import Job
from vedette.record.clock import Clock


def spin(seconds: float) -> None:
    """Keep this thread's core busy for so much CPU time [s]."""
    until = time.thread_time() + seconds
    while time.thread_time() < until:
        pass


def test_planning_counts_what_its_thread_computes_and_neither_waiting_nor_others_work() -> None:
    clock = Clock()
    other = threading.Thread(target=spin, args=(0.2,))
    other.start()
    clock.run(0, Job((1, 1), lambda: spin(0.02)))
    clock.run(0, Job((1, 2), other.join))
    first, second = clock.planning[0, 1, 1], clock.planning[0, 1, 2]
    assert 0.02 <= first < 0.1
    assert second < 0.02
