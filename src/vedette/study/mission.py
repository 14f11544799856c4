"""Carry out one run and measure it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

from vedette.outcome import Outcome
from vedette.record.explore.log import ExploreLog
from vedette.record.explore.summary import ExploreSummary
from vedette.record.plain import plain
from vedette.record.summary import Timing, Traffic
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSimulation
from vedette.study.bounds import Limit, limit
from vedette.study.run import Run, Value
from vedette.study.starts import spread, team

LEVELS = (0.50, 0.90, 0.95, 0.99)
FAILED = "failed"  # outcome of a run that broke


@dataclass(frozen=True)
class RunResult:
    """What one run left: figures in simulated time, wall-clock figures apart, and the curve of coverage."""

    figures: Mapping[str, Value]
    timing: Mapping[str, Value]
    times: tuple[float, ...]  # at which the unknown share changed [s]
    unknown: tuple[float, ...]  # share of the coverable cells from then on, 0..1
    limit_times: tuple[float, ...]  # the same for what no team can pass
    limit_unknown: tuple[float, ...]

    @property
    def error(self) -> str:
        """Why it broke; empty if it did not."""
        return str(self.figures.get("error", ""))


def carry_out(run: Run) -> RunResult:
    """Run a mission to its end; one that breaks is a result too.

    Raises:
        KeyboardInterrupt: it was interrupted: half a mission is no result.
    """
    try:
        simulation = prepared(run)
        report = explore(simulation, curves_only=True)
    except Exception as error:  # whatever it is, the other runs of the study go on
        return broken(error)
    if report.summary.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    best = limit(simulation.world, simulation.specs, simulation.starts)
    figures = _figures(report.summary, simulation) | _limits(best)
    return RunResult(plain(figures), plain(_timing(report.timing)), *_curve(report.log), *_limit_curve(best))


def prepared(run: Run) -> ExploreSimulation:
    """Return the simulation of a run, robots at their starts."""
    world = run.world.build()
    specs = team(run.platform, run.robots)
    if run.starts == "apart":
        specs = spread(world, specs, np.random.default_rng([run.setup.seed, 2]))
    return prepare(world, specs, run.setup)


def broken(error: BaseException) -> RunResult:
    """Return the result of a run that did not come to an end."""
    text = " ".join(f"{type(error).__name__}: {error}".split())
    return RunResult({"outcome": FAILED, "completed": False, "error": text[:500]}, {}, (), (), (), ())


def _figures(summary: ExploreSummary, simulation: ExploreSimulation) -> dict[str, Value]:
    """Return what is told of a mission; ``docs/how-to/study.md`` explains the names."""
    resolution = simulation.world.frame.resolution
    seen = [np.count_nonzero(mission.own.log_odds.blocks) * resolution**2 for mission in simulation.missions]
    paths = list(summary.path_m.values())

    def told(*names: str) -> dict[str, Value]:
        return {name: getattr(summary, name) for name in names}

    return {
        **told("outcome", "completed"),
        "error": "",
        **told("coverage", "t50_s", "t90_s", "t95_s", "t99_s", "time_s", "auc_s"),
        "path_m": float(np.mean(paths)),
        "path_max_m": max(paths),
        **told("overlap"),
        "seen_mean_m2": float(np.mean(seen)),
        "seen_std_m2": float(np.std(seen)),
        **told("map_error_share", "collisions", "min_clearance_m", "rounds", "sweeps", "bound_ratio"),
        **_sent("messages", summary.messages),
        **_sent("bytes", summary.bytes),
    }


def _sent(what: str, by_robot: Mapping[str, Traffic]) -> dict[str, Value]:
    """Return what the whole team sent, by kind."""
    kinds = [field.name for field in fields(Traffic)]
    return {f"{what}_{kind}": sum(getattr(sent, kind) for sent in by_robot.values()) for kind in kinds}


def _limits(best: Limit) -> dict[str, Value]:
    levels = {f"bound_t{100 * level:.0f}_s": best.time(level) for level in LEVELS}
    return {**levels, "bound_s": best.time(), "bound_auc_s": best.auc(), "coverable_m2": best.coverable}


def _timing(timing: Timing) -> dict[str, Value]:
    return {
        **{f"planning_{name}_ms": getattr(timing.planning_ms, name, None) for name in ("p50", "p95", "max")},
        "answer_p95_ms": None if timing.answer_ms is None else timing.answer_ms.p95,
        "real_time_factor": timing.real_time_factor,
        "wall_s": timing.wall_s,
    }


def _curve(log: ExploreLog) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return when the unknown share changed, and to what."""
    unknown = np.round(1.0 - log.coverage, 5)
    changed = np.append(True, np.diff(unknown) != 0.0)
    return tuple(np.round(log.times[changed], 3).tolist()), tuple(unknown[changed].tolist())


def _limit_curve(best: Limit) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the least unknown share, a second apart, until it is none."""
    times = np.arange(0.0, np.ceil(best.time()) + 1.0)
    unknown = np.round(1.0 - best.coverage(times), 5)
    return tuple(times.tolist()), tuple(unknown.tolist())
