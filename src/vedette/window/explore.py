"""Missions in the operator's window: a sink that shows what it is given, no faster than asked."""

from __future__ import annotations

import time
from collections.abc import Callable
from math import inf
from typing import Generic, TypeVar

from vedette.record.log import Timed
from vedette.window.hub import Hub
from vedette.window.picture import Picture

SnapshotT = TypeVar("SnapshotT", bound=Timed)


class Shower(Generic[SnapshotT]):
    """A sink of snapshots."""

    def __init__(
        self,
        hub: Hub,
        draw: Callable[[SnapshotT], Picture],
        pace: float = inf,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Show in a hub.

        Args:
            hub: that shows.
            draw: a snapshot as a picture.
            pace: the mission's seconds a second, at most: who gives snapshots has to wait.
            clock, sleep: [s].
        """
        self._hub, self._draw = hub, draw
        self._pace, self._clock, self._sleep = pace, clock, sleep
        self._began: float | None = None

    def update(self, snapshot: SnapshotT) -> None:
        """Show a snapshot, and let others wait until it is time for it."""
        now = self._clock()
        self._began = now - snapshot.t / self._pace if self._began is None else self._began
        if (early := self._began + snapshot.t / self._pace - now) > 0.0:
            self._sleep(early)
        self._hub.show(self._draw(snapshot))
