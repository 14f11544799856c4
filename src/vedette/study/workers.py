"""Carry out many runs at once, here or on a cluster; a worker that dies loses at most its own run."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path

from joblib import Parallel, delayed, parallel_config

from vedette.errors import InputError
from vedette.parts import folders, look_in
from vedette.study.backends import Backend
from vedette.study.mission import RunResult, broken, carry_out
from vedette.study.run import Run

IDLE = 20.0  # a worker without work ends after so long, as all do when this process is killed [s]
Work = Callable[[Run], RunResult]


@dataclass
class Workers:
    """Processes that carry out runs."""

    jobs: int
    backend: Backend = "loky"
    work: Work = carry_out
    over: Callable[[], bool] = lambda: False  # once it is, no run is begun
    _given: dict[Run, None] = field(default_factory=dict)  # to the workers, and not yet back

    def results(self, runs: Sequence[Run]) -> Iterator[tuple[Run, RunResult]]:
        """Yield runs and results as they come, in any order."""
        left = dict.fromkeys(runs)
        with self._cluster():
            while left and not self.over():
                try:
                    for run, result in self._together(list(left)):
                        del left[run]
                        yield run, result
                except Exception:  # a worker has died, of memory for instance, and the others with it
                    for run in list(self._given):
                        del left[run]
                        yield run, self._alone(run)

    def _together(self, runs: Sequence[Run]) -> Iterator[tuple[Run, RunResult]]:
        self._given.clear()
        jobs = min(self.jobs, len(runs))
        for run, result in self._parallel(jobs, self._giving(runs)):
            del self._given[run]
            yield run, result

    def _giving(self, runs: Iterable[Run]) -> Iterator[Run]:
        for run in runs:
            if self.over():
                return
            self._given[run] = None
            yield run

    def _alone(self, run: Run) -> RunResult:
        """Try a run that was under way when a worker died once more, in a process of its own."""
        try:
            return next(result for _, result in self._parallel(2, [run]))
        except Exception as error:
            return broken(error)

    def _parallel(self, jobs: int, runs: Iterable[Run]) -> Iterator[tuple[Run, RunResult]]:
        """Yield what comes back; a single job is done in this process, a cluster does as many as it can."""
        local = self.backend == "loky"
        own: dict[str, object] = {}
        if local:  # none is handed out before its worker is free: it would be begun though the time is over
            own = {"backend": "loky", "initializer": ignore_endings, "idle_worker_timeout": IDLE}
            own["pre_dispatch"] = "n_jobs"
        parallel = Parallel(
            n_jobs=jobs if local else -1, return_as="generator_unordered", batch_size=1, **own
        )
        yield from parallel(delayed(_named)(self.work, run, folders()) for run in runs)

    def _cluster(self) -> AbstractContextManager[object]:
        return nullcontext() if self.backend == "loky" else _dask(self.jobs)


def _named(work: Work, run: Run, beside: Sequence[str]) -> tuple[Run, RunResult]:
    """Carry out a run where somebody's own parts are found, which lie ``beside`` the files that name them."""
    for folder in beside:
        look_in(Path(folder))
    return run, work(run)


def ignore_endings() -> None:
    """Leave Ctrl-C, and what else ends a study, to the process that gives out the work."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def _dask(jobs: int) -> Iterator[None]:
    """Work on the cluster that ``DASK_SCHEDULER_ADDRESS`` names; without it, in processes of this machine."""
    client = import_module("distributed").Client
    address = import_module("dask").config.get("scheduler-address", None)
    try:
        cluster = client(address) if address else client(n_workers=jobs, threads_per_worker=1)
    except (OSError, ValueError) as error:
        where = f"the scheduler at {address}" if address else "a Dask cluster of this machine"
        raise InputError(f"cannot reach {where}: {error}; check DASK_SCHEDULER_ADDRESS") from error
    with cluster, parallel_config(backend="dask"):
        yield
