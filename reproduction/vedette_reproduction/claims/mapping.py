"""Claims C11 and C12: three posteriors a cell, and missions that end."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.layers import plain as plain_layers
from vedette.domains.mapping.sightings import empty_counts
from vedette_reproduction.content import Section, Value, Verdict, judge, table
from vedette_reproduction.figures.figure_2 import MOST, NOISY, PERFECT, posteriors
from vedette_reproduction.frontiers import frozen, reachable, robot_at
from vedette_reproduction.missions import ReproducedMission, specs
from vedette_reproduction.run import ReproductionRun
from vedette_reproduction.scans import scan, spaced

NAT = 0.2  # of a unit of a robot's log-odds
HOW = {
    "rate": "with negotiated single frontiers (`rate`)",
    "tours": "with negotiated tours",
    "nearest": "with the nearest frontier for everybody",
}
Float = NDArray[np.float64]


def c11(run: ReproductionRun) -> Section:
    """Count posteriors of ideal sensors, and ask how near a real grid's cells come to the three."""
    ideal = {len(posteriors(PERFECT, n)) for n in range(1, MOST + 1)}
    noisy = [len(posteriors(NOISY, n)) for n in range(1, MOST + 1)]
    mission = run.mission()
    poses = mission.report.log.poses
    way = np.concatenate([spaced(poses[:, i], 0.1) for i in range(poses.shape[1])])
    run.tell("scanning along the mission's ways")
    log_odds = scan(mission.world, way, specs()[0], run.rng(111)).log_odds
    known = log_odds[log_odds != 0]
    share = 1.0 / (1.0 + np.exp(NAT * np.abs(known.astype(np.float64))))  # probability of the other class
    rows: list[tuple[Value, ...]] = [
        ("posteriors of a deterministic sensor, n = 1 … 6", "/".join(map(str, sorted(ideal)))),
        ("posteriors of a noisy sensor, n = 1 … 6", ", ".join(map(str, noisy))),
        ("distinct log-odds in the simulated mission's grid", len(np.unique(log_odds))),
        ("known cells within 0.1 of certainty", float(np.mean(share < 0.1))),
        ("mean entropy left in a known cell [nat]", float(np.mean(_entropy(share)))),
        ("known cells on the wrong side of a wall", mission.report.summary.map_error_share),
    ]
    return Section(
        "c11",
        "C11: with a deterministic sensor a cell's posterior is one of three, for any number of platforms",
        "The posterior of each cell after all platforms' observations is known occupied, known empty, or "
        "the prior.",
        (
            "As a statement about the model it is exact (Fig. 2): three values for 1 to 6 sensors by "
            "Bayes' rule, while a sensor that errs leaves (n + 1)(n + 2)/2.",
            f"A real grid is not like that: the log-odds of the simulated lidars take {rows[2][1]} values, "
            f"and a known cell keeps {float(rows[4][1] or 0):.3f} nat on average. The three-valued model is "
            "a good stand-in only if known cells are counted as fully known; otherwise “no action reduces "
            f"the uncertainty” would never be true. This code does so; {100 * float(rows[3][1] or 0):.1f} % "
            "of the known cells are within 0.1 of certainty.",
        ),
        Verdict.HOLDS if ideal == {3} else Verdict.FAILS,
        f"{rows[0][1]} posteriors for n = 1 … 6 (noisy sensor: {noisy[0]} → {noisy[-1]}); a real grid: "
        f"{rows[2][1]} values",
        (table("c11_posteriors", "Posteriors", ("what", "value"), rows),),
    )


def _entropy(p: Float) -> Float:
    return np.asarray(-p * np.log(p) - (1.0 - p) * np.log1p(-p))


def c12(run: ReproductionRun) -> Section:
    """Run missions to their end, look for anything worth doing that is left, and for work done twice."""
    rows: list[tuple[Value, ...]] = []
    for seed in run.scale.mission_seeds:
        for planner in run.scale.mission_planners:
            mission = run.mission(planner, seed)
            s = mission.report.summary
            left, stops = left_to_do(mission)
            rows.append(
                (
                    planner,
                    seed,
                    s.outcome.value,
                    s.time_s,
                    s.coverage,
                    left,
                    stops,
                    s.overlap,
                    sum(s.path_m.values()),
                    s.t90_s,
                )
            )
    complete = sum(row[2] == "complete" for row in rows)
    least = min(float(row[4] or 0) for row in rows)
    left = sum(int(row[6] or 0) for row in rows)

    def mean(planner: str, column: int) -> float:
        return float(np.mean([float(row[column] or 0) for row in rows if row[0] == planner]))

    return Section(
        "c12",
        "C12: behaviour is consistent across the group; the mission ends when no action reduces the "
        "uncertainty",
        "Each vehicle's strategy takes into account the strategies of all the others. The task is complete "
        "when no available action will reduce the map uncertainty.",
        (
            f"{complete} of {len(rows)} missions of three robots end by themselves, with at least "
            f"{100 * least:.2f} % of what can be covered. After the end each final map was searched once "
            f"more for frontiers that a robot can reach and that promise 0.08 m² or more: {left} are left "
            "in all. Such a frontier was visited and given up because nothing there changed; without "
            "giving up, slivers that no scan resolves would keep missions alive for ever. Some entropy "
            "always stays: cells inside walls, and what no robot can see.",
            "Consistency, measured by what it is for: "
            + "; ".join(
                f"{HOW[planner]}, the three drive {mean(planner, 8):.0f} m in all, "
                f"{100 * mean(planner, 7):.0f} % of the map is seen by two or more, 90 % of it is known "
                f"after {mean(planner, 9):.0f} s, and all after {mean(planner, 3):.0f} s"
                for planner in run.scale.mission_planners
            )
            + ".",
        ),
        judge(complete > 0, complete == len(rows) and left == 0),
        f"{complete} of {len(rows)} missions end by themselves, coverage ≥ {100 * least:.2f} %; {left} "
        "promising frontiers left",
        (
            table(
                "c12_missions",
                f"Missions of three robots in offices of {run.scale.office[0]:g} × {run.scale.office[1]:g} m",
                (
                    "planner", "seed", "outcome", "end [s]", "coverage", "frontiers left",
                    "of these reachable", "seen by two or more", "all ways [m]", "90 % [s]",
                ),
                rows,
            ),
        ),
        but=f"{len(rows) - complete} of {len(rows)} missions do not end, {left} promising frontiers are left",
    )  # fmt: skip


def left_to_do(mission: ReproducedMission) -> tuple[int, int]:
    """Count the frontiers of the final map, and those that any robot could go to and see 0.08 m^2 from."""
    spec = specs()[0]
    belief = frozen(mission.report.classes, mission.world.frame, spec, plain_layers(), empty_counts())
    found: set[tuple[float, float]] = set()
    for x, y, _ in mission.report.log.poses[-1].tolist():
        platform = robot_at(x, y, spec, belief)
        assert platform.stops is not None
        targets = platform.stops.targets[reachable(platform)].tolist()
        found |= {(round(a, 2), round(b, 2)) for a, b in targets}
    return len(belief.frontier_starts) - 1, len(found)
