"""The live view of an exploration: a map that fills in, or plain lines where there is no terminal."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from rich.console import Console, RenderableType

from vedette.record.display import Display
from vedette.record.explore.log import ExploreScene, ExploreSnapshot
from vedette.record.explore.screen import screen
from vedette.record.marks import together


class ExploreDisplay(Display[ExploreSnapshot]):
    """Show each snapshot while the mission runs: a context manager, and a ``Sink``."""

    def __init__(
        self,
        scene: ExploreScene,
        quiet: bool = False,
        console: Console | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare a view of a mission; the ``clock`` [s] only limits the pictures a second."""
        travelled = self._travelled = list[float]()

        def picture(console: Console, snapshot: ExploreSnapshot) -> RenderableType:
            return screen(console, scene, snapshot, travelled)

        super().__init__(picture, _line, quiet, console, clock)

    def update(self, snapshot: ExploreSnapshot) -> None:
        """Add up what each robot travelled, and show the snapshot, or not if one was shown just before."""
        before = snapshot if self._last is None else self._last
        self._travelled += [0.0] * (len(snapshot.robots) - len(self._travelled))
        for i, (then, now) in enumerate(zip(before.robots, snapshot.robots, strict=True)):
            self._travelled[i] += math.hypot(now.x - then.x, now.y - then.y)
        super().update(snapshot)


def _line(snapshot: ExploreSnapshot) -> str:
    """Return a snapshot in one line."""
    robots = "  ".join(f"{robot.name} {robot.state}" for robot in snapshot.robots)
    known, covered = 100 * snapshot.known_fraction, 100 * snapshot.coverage
    entropy = f"entropy {snapshot.entropy:.0f} nat"
    team = "" if snapshot.links is None else f"  {together(snapshot.parts)}"
    return f"{snapshot.t:7.1f} s  known {known:5.1f} %  covered {covered:5.1f} %  {entropy}  {robots}{team}"
