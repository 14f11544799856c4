"""Showing a mission while it runs: pictures in a terminal, plain lines elsewhere, nothing when quiet."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from types import TracebackType
from typing import Generic, TypeVar

from rich.console import Console, RenderableType
from rich.live import Live

from vedette.record.log import Timed

_REFRESH = 0.1  # least wall time between two pictures [s]
_DRAWING_SHARE = 0.1  # of the wall time that drawing may take
LINE_PERIOD = 10.0  # simulated time between two plain lines [s]


SnapshotT = TypeVar("SnapshotT", bound=Timed)


class Display(Generic[SnapshotT]):
    """Show each snapshot of any kind of mission: a context manager, and a sink.

    In a terminal a picture, at most ten a second; elsewhere one line every ten simulated seconds.
    """

    def __init__(
        self,
        picture: Callable[[Console, SnapshotT], RenderableType],
        line: Callable[[SnapshotT], str],
        quiet: bool = False,
        console: Console | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare to show snapshots as a ``picture`` or a ``line``.

        Args:
            picture: fitted to the console.
            line: without a terminal.
            quiet: show nothing.
            console: where to; standard output if none is given.
            clock: [s]; only limits the pictures a second.
        """
        self._picture, self._line, self._quiet = picture, line, quiet
        self._console = console or Console()
        self._clock = clock
        self._live: Live | None = None
        self._last: SnapshotT | None = None
        self._shown: SnapshotT | None = None
        self._next_picture = -math.inf  # wall clock [s]
        self._next_line = -math.inf  # simulated time [s]

    def update(self, snapshot: SnapshotT) -> None:
        """Show a snapshot, or not if one was shown just before."""
        self._last = snapshot
        if self._quiet:
            return
        if self._live is None:
            if snapshot.t >= self._next_line:
                self._next_line = snapshot.t + LINE_PERIOD
                self._show(snapshot)
        elif (begin := self._clock()) >= self._next_picture:
            self._show(snapshot)
            end = self._clock()
            self._next_picture = max(begin + _REFRESH, end + (end - begin) * (1 / _DRAWING_SHARE - 1))

    def say(self, text: str) -> None:
        """Print a line of its own, unless quiet."""
        if not self._quiet:
            self._console.print(text, markup=False, highlight=False, soft_wrap=True)

    def __enter__(self) -> Display[SnapshotT]:
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

    def _show(self, snapshot: SnapshotT) -> None:
        self._shown = snapshot
        if self._live is None:
            self.say(self._line(snapshot))
        else:
            self._live.update(self._picture(self._console, snapshot), refresh=True)
