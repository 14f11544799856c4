"""What reading an input may cost: processor time and memory."""

from __future__ import annotations

import signal
import tracemalloc
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

SECONDS = 5.0  # of the processor, a whole input: ample on a slow machine that fuzzes with coverage
MEMORY = 1 << 24  # [bytes], and for each byte of the input
MEMORY_PER_BYTE = (
    1 << 14
)  # deflate yields up to 1032 bytes for one, and arrays of 64 bits hold what are 8 there


class Excess(BaseException):
    """An input cost too much; nothing that catches errors takes it for one."""


@contextmanager
def limited_time(seconds: float = SECONDS) -> Iterator[None]:
    """Raise `Excess` in a block that takes more processor time."""
    previous = signal.signal(signal.SIGVTALRM, _too_slow)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, previous)


@contextmanager
def limited_memory(size: int) -> Iterator[None]:
    """Raise `Excess` after a block that took more memory than an input of ``size`` bytes may.

    What counts is the peak of what was asked for, whether or not it was ever touched.
    """
    tracemalloc.start(1)
    try:
        yield
        taken = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    if taken > MEMORY + MEMORY_PER_BYTE * size:
        raise Excess(
            f"{size} bytes took {taken} bytes of memory; {MEMORY + MEMORY_PER_BYTE * size} are allowed"
        )


def _too_slow(number: int, frame: FrameType | None) -> None:
    raise Excess("an input took too long")
