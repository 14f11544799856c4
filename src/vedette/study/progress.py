"""How far a study is: a bar in a terminal, a line a run elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from vedette.study.mission import RunResult
from vedette.study.run import Run


def weight(run: Run) -> float:
    """Return about how much work a run is, so that the time left is not far off: by its team's size alone."""
    return 2.0 + run.robots


def in_words(seconds: float) -> str:
    """Return a duration as people say it."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


class StudyProgress(AbstractContextManager["StudyProgress"]):
    """Tells of each run as it ends, and how much time is left."""

    def __init__(
        self,
        runs: Sequence[Run],
        console: Console | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare to tell of ``runs``, in any order.

        Args:
            runs: those that are still to be done.
            console: where to; standard output if none is given.
            clock: [s].
        """
        self._console = console or Console()
        self._clock = clock
        self._count, self._done = len(runs), 0
        self._work = sum(map(weight, runs))  # in all, and done so far
        self._work_done = 0.0
        self._began = clock()
        drawable = self._console.is_terminal and not self._console.is_dumb_terminal
        self._bar = _bar(self._console) if drawable else None
        self._task = None if self._bar is None else self._bar.add_task("", total=self._count, left="")

    def __enter__(self) -> StudyProgress:
        """Start."""
        self._began = self._clock()
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Leave the bar as it is."""
        if self._bar is not None:
            self._bar.stop()

    def ended(self, run: Run, result: RunResult) -> None:
        """Tell how a run ended; one that broke gets a line in a terminal too."""
        self._done += 1
        self._work_done += weight(run)
        left = f"{in_words(self.time_left())} left"
        told = f"{run}: {_outcome(result)}"
        if self._bar is None or self._task is None:
            self._say(f"{self._done}/{self._count}, {left}: {told}")
        else:
            if result.error:
                self._say(told)
            self._bar.update(self._task, completed=self._done, description=told, left=left)

    def time_left(self) -> float:
        """Return about how long the rest will take [s]."""
        share = self._work_done / self._work if self._work else 1.0
        return (self._clock() - self._began) * (1.0 / share - 1.0) if share else 0.0

    def _say(self, text: str) -> None:
        self._console.print(text, markup=False, highlight=False, soft_wrap=True)


def _bar(console: Console) -> Progress:
    return Progress(
        BarColumn(24),
        MofNCompleteColumn(),
        TextColumn("{task.fields[left]}"),
        TextColumn("{task.description}", markup=False),
        console=console,
    )


def _outcome(result: RunResult) -> str:
    if result.error:
        return f"broke: {result.error}"
    outcome = str(result.figures["outcome"]).replace("_", " ")
    return f"{outcome} after {result.figures['time_s']:.0f} s"
