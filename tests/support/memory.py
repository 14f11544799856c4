"""How much memory the processes have that this one has started, while something goes on."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread


def resident(pid: int) -> float:
    """Return what a process holds [MB]; 0 if it is gone."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0.0
    return sum(int(line.split()[1]) / 1e3 for line in lines if line.startswith("VmRSS"))


def children() -> list[int]:
    """Return this process's children."""
    tasks = Path(f"/proc/{os.getpid()}/task")
    return sorted({int(pid) for task in tasks.iterdir() for pid in (task / "children").read_text().split()})


@contextmanager
def watched(period: float) -> Iterator[list[list[float]]]:
    """Yield what all children hold [MB], each ``period`` [s]; it is filled while the block runs."""
    samples: list[list[float]] = []
    over = Event()

    def sample() -> None:
        while not over.wait(period):
            samples.append([resident(pid) for pid in children()])

    thread = Thread(target=sample, daemon=True)
    thread.start()
    try:
        yield samples
    finally:
        over.set()
        thread.join()
