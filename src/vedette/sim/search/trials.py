"""What is worked out beside a search: runs in which nobody reports, and many targets to be found."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.detectors import Detector
from vedette.domains.search.prediction import Looks, Prediction, predicted
from vedette.missions.search.case import SearchCase
from vedette.missions.search.options import COORDINATIONS
from vedette.outcome import Outcome
from vedette.record.search.counting import Trials
from vedette.record.search.observer import SearchReport, ended_as
from vedette.record.search.summary import SearchQuality
from vedette.sim.search.hidden import draw_places
from vedette.sim.search.simulation import SearchSetup, SearchSimulation

LOOKED_AT, RUNS = 1000, 20  # trials by default: without and with false alarms


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
    predictions: dict[str, Prediction] = {}
    counted = None
    for name in names:
        own = name == setup.coordination
        running.say("to the end, as if nobody reported" if own else f"to compare: {name}")
        blind = SearchSimulation(case, replace(setup, coordination=name, blind=True))
        if not running.run(blind):
            break
        looks = blind.vehicles.looks
        predictions[name] = predicted(case.pdf, case.detectors, looks, blind.steps)
        if own:
            counted = _trials(case, setup, looks, blind.steps, trials, running)
    return _joined(report, predictions, counted, running.stopped)


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
    first = detected_at(case.pdf, case.detectors, looks, steps, wanted, rng)
    return Trials(first, "looks", np.zeros(wanted, bool))


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
    wrong = np.array([outcome is Outcome.MISTAKEN for outcome, _ in ended])
    declared = wrong | [outcome is Outcome.FOUND for outcome, _ in ended]
    at = [ceil(time / case.pdf.dt - 1e-6) for _, time in ended]
    return Trials(np.where(declared, at, steps + 1), "runs", wrong)


def search_once(case: SearchCase, setup: SearchSetup) -> tuple[Outcome, float]:
    """Run one search that nobody follows; return how it ended and when [s]."""
    simulation = SearchSimulation(case, setup)
    outcome = simulation.run(lambda: None)
    found = None if simulation.declared is None else simulation.declared[1]
    return ended_as(outcome, found, simulation.plan, simulation.hidden.at), simulation.now


def _joined(
    report: SearchReport, predictions: dict[str, Prediction], trials: Trials | None, interrupted: bool
) -> SearchReport:
    times, coordination = report.curves.times, report.summary.coordination
    detection = {name: predictions[name].detection for name in COORDINATIONS if name in predictions}
    comparison = {name: SearchQuality.of(times, curve) for name, curve in detection.items()}
    outcome = Outcome.INTERRUPTED if interrupted else report.summary.outcome
    own, outside = comparison.get(coordination), None
    if coordination in predictions and report.summary.outside_then is not None:
        outside = predictions[coordination].outside
    summary = replace(
        report.summary,
        outcome=outcome,
        completed=outcome.completed,
        **({} if own is None else vars(own)),
        outside=None if outside is None else float(outside[-1]),
        counted=None if trials is None else trials.figures(times, detection[coordination]),
        comparison=comparison,
    )
    curves = replace(report.curves, detection=detection, outside=outside)
    if trials is not None:
        curves = replace(curves, counted=trials.curve(len(times) - 1))
        if report.summary.declare is not None:
            curves = replace(curves, mistaken=trials.curve(len(times) - 1, wrong=True))
    return replace(report, summary=summary, curves=curves)


def detected_at(
    pdf: TargetPdf,
    detectors: Sequence[Detector],
    looks: Looks,
    steps: int,
    trials: int,
    rng: np.random.Generator,
) -> NDArray[np.int64]:
    """Draw targets from the prior, move them by the model, and look at them as the vehicles did.

    Returns:
        ``(trials,)`` the step at whose end each was first detected; ``steps + 1`` for those that never were.
    """
    places = draw_places(pdf, trials, rng)
    first = np.full(trials, steps + 1)
    for step in range(1, steps + 1):
        places = pdf.motion.move(rng, places, pdf.frame, pdf.dt)
        here = pdf.frame.holds(places) | (not pdf.motion.leaves)
        for detector, made in zip(detectors, looks, strict=True):
            for pose in made.get(step, ()):
                found = here & (rng.random(trials) < detector.chance(pose, places))
                first[found] = np.minimum(first[found], step)
    return first
