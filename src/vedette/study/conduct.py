"""Conduct a study: carry out what has not been carried out yet, keep every result, and report on all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rich.console import Console

from vedette.number import many
from vedette.study.mission import RunResult
from vedette.study.progress import StudyProgress
from vedette.study.run import Run
from vedette.study.store import Store
from vedette.study.workers import Workers


@dataclass(frozen=True, eq=False)
class Conducted:
    """How far a study has come."""

    results: Mapping[Run, RunResult]  # in the order of the spec
    missing: Sequence[Run]  # not done, because the study was interrupted or its time was over
    fresh: int  # carried out just now
    interrupted: bool = False

    @property
    def broken(self) -> int:
        """How many runs did not come to an end."""
        return sum(bool(result.error) for result in self.results.values())


def conduct(runs: Sequence[Run], store: Store, workers: Workers, console: Console) -> Conducted:
    """Carry out the runs whose results are not in the store, and those that broke before.

    Every result is stored when it comes. Ctrl-C ends the study with what is there.
    """
    results = {run: result for run in runs if (result := store.read(run)) is not None and not result.error}
    left = [run for run in runs if run not in results]
    _begin(len(runs), len(left), store.others(list(runs)), console)
    fresh, interrupted = 0, False
    try:
        with StudyProgress(left, console) as progress:
            for run, result in workers.results(left):
                store.write(run, result)
                results[run] = result
                fresh += 1
                progress.ended(run, result)
    except KeyboardInterrupt:
        interrupted = True
        console.print("interrupted; what is done is kept", markup=False, highlight=False)
    ordered = {run: results[run] for run in runs if run in results}
    return Conducted(ordered, [run for run in runs if run not in results], fresh, interrupted)


def _begin(runs: int, left: int, others: int, console: Console) -> None:
    text = f"{many(runs, 'run')}, {runs - left} of them done before, {left} to do"
    if others:
        text += f" ({many(others, 'result')} of other runs, or of other code, left alone)"
    console.print(text, markup=False, highlight=False, soft_wrap=True)
