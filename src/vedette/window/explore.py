"""Missions in the operator's window: a sink that shows what it is given, no faster than asked; a record."""

from __future__ import annotations

import time
from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Generic, TypeVar

from vedette.record.explore.read import read_scene, read_snapshots
from vedette.record.flown import scene_of, snapshots_of
from vedette.record.log import Timed
from vedette.window.declared import pictures
from vedette.window.hub import Hub
from vedette.window.picture import Picture, picture

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


def recorded(path: Path) -> Hub:
    """Return a hub with all that a mission's record holds.

    Raises:
        InputError: it cannot be read, or is of no mission that can be shown.
    """
    flown = scene_of(path)
    if flown is not None:
        hub, draw = Hub(flown.name, live=False), pictures(flown)
        for snapshot in snapshots_of(path, flown):
            hub.show(draw(snapshot))
        return hub
    scene = read_scene(path)
    hub = Hub(scene.name, live=False)
    for each in read_snapshots(path, scene):
        hub.show(picture(scene, each))
    return hub
