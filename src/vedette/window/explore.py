"""An exploration in the operator's window: a sink that shows what it is given, no faster than asked."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from math import inf
from pathlib import Path

from vedette.agent.orders import Order
from vedette.record.explore.log import ExploreScene, ExploreSnapshot
from vedette.record.explore.read import read_scene, read_snapshots
from vedette.window.hub import Hub
from vedette.window.picture import Beside, ordered, picture


class Shower:
    """A sink of snapshots."""

    def __init__(
        self,
        hub: Hub,
        scene: ExploreScene,
        held: Callable[[], Iterable[tuple[str, Iterable[Order]]]] = lambda: (),
        pace: float = inf,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Show in a hub.

        Args:
            hub: that shows.
            scene: of the mission.
            held: the orders that each robot holds, by its name.
            pace: the mission's seconds a second, at most: who gives snapshots has to wait.
            clock, sleep: [s].
        """
        self._hub, self._scene, self._held = hub, scene, held
        self._pace, self._clock, self._sleep = pace, clock, sleep
        self._began: float | None = None

    def update(self, snapshot: ExploreSnapshot) -> None:
        """Show a snapshot, and let others wait until it is time for it."""
        now = self._clock()
        self._began = now - snapshot.t / self._pace if self._began is None else self._began
        if (early := self._began + snapshot.t / self._pace - now) > 0.0:
            self._sleep(early)
        orders, areas = ordered(self._held())
        self._hub.show(picture(self._scene, snapshot, Beside(orders=orders, areas=areas)))


def recorded(path: Path) -> Hub:
    """Return a hub with all that an exploration's record holds.

    Raises:
        InputError: it cannot be read, or is of another kind of mission.
    """
    scene = read_scene(path)
    hub = Hub(scene.name, live=False)
    for snapshot in read_snapshots(path, scene):
        hub.show(picture(scene, snapshot))
    return hub
