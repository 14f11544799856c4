"""What is worked out beside a search: runs in which nobody reports, and many targets to be found."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from vedette.missions.search.case import SearchCase
from vedette.missions.search.options import COORDINATIONS
from vedette.outcome import Outcome
from vedette.record.search.curves import CountedCurve
from vedette.record.search.summary import Counted, Quality, SearchOutcome
from vedette.sim.search.curves import Looks, detected_at, dkw, predicted, wilson
from vedette.sim.search.run import SearchReport, ended_as
from vedette.sim.search.simulation import SearchSetup, SearchSimulation

LOOKED_AT, RUNS = 1000, 20  # trials by default: without and with false alarms
_NORMAL = 1.959963984540054  # 97.5 % quantile


@dataclass
class Running:
    """Whichever simulation is running: Ctrl-C stops it, and all that would come after it."""

    say: Callable[[str], None] = lambda text: None
    stopped: bool = False
    current: SearchSimulation | None = None

    def stop(self) -> None:
        """End the present simulation in good order, and begin no other."""
        self.stopped = True
        if self.current is not None:
            self.current.stop()

    def run(self, simulation: SearchSimulation) -> bool:
        """Run a simulation that nobody follows; tell whether it came to its own end."""
        self.current = simulation
        return not self.stopped and simulation.run(lambda: None) is not Outcome.INTERRUPTED


@dataclass(frozen=True, eq=False)
class Trials:
    """When each of many targets was found."""

    steps: NDArray[np.int64]  # (n,) at whose end; K + 1: never, or the team was mistaken
    of: str  # "looks": at which the vehicles looked as they would; "runs": each looked for in earnest
    mistaken: int = 0


def assessed(
    report: SearchReport, simulation: SearchSimulation, running: Running, trials: int | None, compare: bool
) -> SearchReport:
    """Return the report with the predicted curves of all ways of coordination, and what trials say of them.

    When it is interrupted the rest is left out, and the search as a whole counts as interrupted.

    Args:
        report: of the search itself.
        simulation: that it was made in.
        running: says what is going on, and when to stop.
        trials: how many; None: 1000, or 20 where there are false alarms; 0: none.
        compare: whether to run the other ways of coordination too.
    """
    case, setup = simulation.case, simulation.setup
    names = [setup.coordination, *(n for n in COORDINATIONS if compare and n != setup.coordination)]
    detection, counted = {}, None
    for name in names:
        own = name == setup.coordination
        running.say("to the end, as if nobody reported" if own else f"to compare: {name}")
        blind = SearchSimulation(case, replace(setup, coordination=name, blind=True))
        if not running.run(blind):
            break
        looks = blind.vehicles.looks
        detection[name] = predicted(case.pdf, case.detectors, looks, blind.steps)
        if own:
            counted = _trials(case, setup, looks, blind.steps, trials, running)
    return _joined(report, detection, counted, running.stopped)


def _trials(
    case: SearchCase, setup: SearchSetup, looks: Looks, steps: int, trials: int | None, running: Running
) -> Trials | None:
    """Draw targets and see when they are found."""
    wanted = (RUNS if case.false_alarms else LOOKED_AT) if trials is None else trials
    if wanted == 0:
        return None
    if case.false_alarms:
        running.say(f"{wanted} searches with other chance")
        return _runs(case, setup, steps, wanted, running)
    rng = np.random.default_rng([setup.seed, 4])
    return Trials(detected_at(case.pdf, case.detectors, looks, steps, wanted, rng), "looks")


def _runs(case: SearchCase, setup: SearchSetup, steps: int, trials: int, running: Running) -> Trials | None:
    """Search in earnest, each time with other chance: where vehicles go depends on false alarms."""
    hidden = structs.replace(case.scenario.target, start=None)
    other = replace(case, scenario=structs.replace(case.scenario, target=hidden))
    seeds = np.random.SeedSequence([setup.seed, 4]).generate_state(trials).tolist()
    setups = [replace(setup, seed=seed) for seed in seeds]
    cores = min(trials, os.cpu_count() or 1)
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(cores, context, signal.signal, (signal.SIGINT, signal.SIG_IGN)) as pool:
        tasks = [pool.submit(search_once, other, each) for each in setups]
        ended = []
        for task in tasks:
            if running.stopped:
                pool.shutdown(cancel_futures=True)
                return None
            ended.append(task.result())
    at = [
        ceil(time / case.pdf.dt - 1e-6) if outcome is SearchOutcome.FOUND else steps + 1
        for outcome, time in ended
    ]
    return Trials(np.array(at), "runs", sum(outcome is SearchOutcome.MISTAKEN for outcome, _ in ended))


def search_once(case: SearchCase, setup: SearchSetup) -> tuple[SearchOutcome, float]:
    """Run one search that nobody follows; return how it ended and when [s]."""
    simulation = SearchSimulation(case, setup)
    outcome = simulation.run(lambda: None)
    return ended_as(simulation, outcome), simulation.now


def _joined(
    report: SearchReport, detection: dict[str, NDArray[np.float64]], trials: Trials | None, interrupted: bool
) -> SearchReport:
    times = report.curves.times
    comparison = {name: Quality.of(times, detection[name]) for name in COORDINATIONS if name in detection}
    outcome = SearchOutcome.INTERRUPTED if interrupted else report.summary.outcome
    summary = replace(
        report.summary,
        outcome=outcome,
        completed=outcome is SearchOutcome.FOUND,
        quality=comparison.get(report.summary.coordination),
        counted=None if trials is None else _counted(times, trials),
        comparison=comparison,
    )
    curve = None if trials is None else _curve(len(times) - 1, trials)
    curves = replace(report.curves, detection=detection, counted=curve)
    return replace(report, summary=summary, curves=curves)


def _curve(steps: int, trials: Trials) -> CountedCurve:
    count = len(trials.steps)
    share = np.bincount(trials.steps, minlength=steps + 2)[: steps + 1].cumsum() / count
    return CountedCurve(share, dkw(count), count, trials.of)


def _counted(times: NDArray[np.float64], trials: Trials) -> Counted:
    steps, count = len(times) - 1, len(trials.steps)
    found = int(np.count_nonzero(trials.steps <= steps))
    low, high = wilson(found, count)
    spent = times[np.minimum(trials.steps, steps)]
    half = _NORMAL * float(spent.std(ddof=1)) / np.sqrt(count) if count > 1 else float("nan")
    mean = float(spent.mean())
    return Counted(
        count,
        trials.of,
        found / count,
        low,
        high,
        mean,
        mean - half,
        mean + half,
        dkw(count),
        trials.mistaken,
    )
