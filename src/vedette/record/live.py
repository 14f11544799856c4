"""The live view: a map that fills in, or plain lines where there is no terminal."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from types import TracebackType

from rich.console import Console
from rich.live import Live

from vedette.maps import GridFrame
from vedette.record.log import Snapshot
from vedette.record.screen import screen

_REFRESH = 0.1  # least wall time between two pictures [s]
_DRAWING_SHARE = 0.1  # of the wall time that drawing may take
_LINE_PERIOD = 10.0  # simulated time between two plain lines [s]


class LiveView:
    """Show each snapshot while the mission runs: a context manager, and a `vedette.record.log.Sink`.

    In a terminal a picture, at most ten a second; elsewhere one line every ten simulated seconds; when
    ``quiet``, nothing.
    """

    def __init__(
        self,
        world: str,
        frame: GridFrame,
        planning: GridFrame,
        quiet: bool = False,
        console: Console | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare a view of a mission in ``world``; the ``clock`` [s] only limits the pictures a second."""
        self._world = world
        self._frame = frame
        self._planning = planning
        self._quiet = quiet
        self._console = console or Console()
        self._clock = clock
        self._live: Live | None = None
        self._travelled: list[float] = []
        self._last: Snapshot | None = None
        self._shown: Snapshot | None = None
        self._next_picture = -math.inf  # wall clock [s]
        self._next_line = -math.inf  # simulated time [s]

    def update(self, snapshot: Snapshot) -> None:
        """Show a snapshot, or not if one was shown just before."""
        self._measure(snapshot)
        self._last = snapshot
        if self._quiet:
            return
        if self._live is None:
            if snapshot.t >= self._next_line:
                self._next_line = snapshot.t + _LINE_PERIOD
                self._show(snapshot)
        elif (begin := self._clock()) >= self._next_picture:
            self._show(snapshot)
            end = self._clock()
            self._next_picture = max(begin + _REFRESH, end + (end - begin) * (1 / _DRAWING_SHARE - 1))

    def __enter__(self) -> LiveView:
        """Start; only a terminal that can draw block characters gets pictures."""
        drawable = self._console.is_terminal and not self._console.options.ascii_only
        if drawable and not self._quiet and not self._console.is_dumb_terminal:
            self._live = Live(console=self._console, auto_refresh=False)
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Show the last snapshot and leave it on the screen."""
        if self._last is not None and self._last is not self._shown and not self._quiet:
            self._show(self._last)
        if self._live is not None:
            self._live.stop()
            self._live = None

    def _measure(self, snapshot: Snapshot) -> None:
        """Add up what each robot travelled since the last snapshot."""
        if self._last is None:
            self._travelled = [0.0] * len(snapshot.robots)
            return
        for i, (before, now) in enumerate(zip(self._last.robots, snapshot.robots, strict=True)):
            self._travelled[i] += math.hypot(now.x - before.x, now.y - before.y)

    def _show(self, snapshot: Snapshot) -> None:
        self._shown = snapshot
        if self._live is None:
            self._console.print(_line(snapshot), markup=False, highlight=False, soft_wrap=True)
            return
        picture = screen(self._console, self._world, self._frame, self._planning, snapshot, self._travelled)
        self._live.update(picture, refresh=True)


def _line(snapshot: Snapshot) -> str:
    """Return a snapshot in one line."""
    robots = "  ".join(f"{robot.name} {robot.state}" for robot in snapshot.robots)
    known, covered = 100 * snapshot.known_fraction, 100 * snapshot.coverage
    entropy = f"entropy {snapshot.entropy:.0f} nat"
    return f"{snapshot.t:7.1f} s  known {known:5.1f} %  covered {covered:5.1f} %  {entropy}  {robots}"
