"""Claim C13: search is partially separable too."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search import worth
from vedette.domains.search.belief import SearchBelief, TargetPdf
from vedette.domains.search.belief import freeze as freeze_pdf
from vedette.domains.search.detectors import DefiniteRange
from vedette.domains.search.flights import Flight
from vedette.domains.search.impact import Impact
from vedette.domains.search.motion import STILL, TargetMotion
from vedette.domains.search.objective import SearchObjective
from vedette.domains.search.platform import SearchPlatform
from vedette.domains.search.priors import GaussianPart, gaussians
from vedette.maps import GridFrame
from vedette.negotiation import Tree, negotiate
from vedette.testing import LawBroken, check_objective
from vedette_reproduction.content import Section, Value, Verdict, table
from vedette_reproduction.run import ReproductionRun

SEA = GridFrame(20.0, 60, 70, -300.0, 100.0)  # 1400 m x 1200 m
HORIZON, DT = 8, 2.0  # steps, and the length of one [s]
VEHICLES = 3
Float = NDArray[np.float64]


def c13(run: ReproductionRun) -> Section:
    """Try the laws on search, and compare the value of combined impacts with draws of targets that move."""
    rows: list[tuple[Value, ...]] = []
    lawful = True
    for name, motion in (("stays", STILL), ("drifts and diffuses", TargetMotion((4.0, -2.0), 30.0))):
        run.tell(f"search for a target that {name}")
        belief, platforms = search_scene(motion)
        candidates = [[one.impact(belief, flight) for flight in _flights(one)] for one in platforms]
        lawful &= _is_lawful(belief, candidates)
        agreed = negotiate(SearchObjective(), belief, candidates, Tree.chain(VEHICLES))
        flights = [_flights(one)[k] for one, k in zip(platforms, agreed.choice, strict=True)]
        drawn, deviation = detected_share(belief, platforms, [f.turn_rates for f in flights], motion, run)
        bound = agreed.bound if agreed.bound is not None else np.nan
        rows.append(
            (name, agreed.value, drawn, deviation, agreed.value / bound, agreed.sweeps, agreed.messages)
        )
    worst = max(abs(float(row[1] or 0) - float(row[2] or 0)) for row in rows)
    return Section(
        "c13",
        "C13: cooperative search has a partially separable objective too",
        "The cooperative search problem of Bourgault et al. is believed to have a partially separable "
        "objective.",
        (
            "It has. For a target that stays, the probability that all looks miss it is Σ P(x) Π mᵢ(x): "
            "eq. (41) with P(x) for the entropy, and miss probabilities multiply over platforms. For one "
            "that moves it is no longer a product over cells, but with an impact a step (a layer each) a "
            "forward filter of the combined misses gives it exactly (docs/search.md, (V45)).",
            f"The objective passed `check_objective`: {'yes' if lawful else 'no'}. Three vehicles "
            f"negotiated over their flights; {run.scale.targets:,} targets were then drawn, moved and "
            "looked at one by one, without impacts or grid: the share detected differs from the value by "
            f"at most {worst:.4f}, which cells of 20 m and log-misses rounded to sixteenths of a nat leave.",
        ),
        Verdict.HOLDS if lawful and worst < 0.02 else Verdict.FAILS,
        f"laws {'hold' if lawful else 'are broken'}; value against {run.scale.targets:,} drawn targets: "
        + ", ".join(f"{float(row[1] or 0):.3f} / {float(row[2] or 0):.3f}" for row in rows),
        (
            table(
                "c13_search",
                "Probability of detection: value of the combined impact, and share of drawn targets",
                ("target", "value", "drawn", "its standard deviation", "value / bound", "sweeps", "messages"),
                rows,
            ),
        ),
    )


def search_scene(motion: TargetMotion) -> tuple[SearchBelief, list[SearchPlatform]]:
    """Return a belief of two places, and three vehicles south of the nearer one, prepared."""
    parts = [GaussianPart((0.0, 500.0), 90.0, 1.0), GaussianPart((500.0, 700.0), 120.0, 2.0)]
    pdf = TargetPdf(SEA, gaussians(SEA, parts), motion, DT)
    belief = freeze_pdf(pdf, worth.plain(HORIZON, tail=0.0))
    platforms = []
    for i in range(VEHICLES):
        eye = DefiniteRange(detection=0.8, range=80.0)
        platform = SearchPlatform(speed=30.0, turn_rate=0.4, detector=eye, controls=4)
        platform.place((-60.0 + 60.0 * i, 400.0, np.pi / 2), None)
        platform.prepare(belief)
        platforms.append(platform)
    return belief, platforms


def _flights(platform: SearchPlatform) -> Sequence[Flight]:
    assert platform.options is not None
    return platform.options.flights


def _is_lawful(belief: SearchBelief, candidates: Sequence[Sequence[Impact]]) -> bool:
    some = [own[k] for own in candidates for k in (0, len(own) // 2)]
    some.append(reduce(SearchObjective().combine, some[:3]))
    try:
        check_objective(SearchObjective(), belief, some)
    except LawBroken:
        return False
    return True


def detected_share(
    belief: SearchBelief,
    platforms: Sequence[SearchPlatform],
    turn_rates: Sequence[Float],
    motion: TargetMotion,
    run: ReproductionRun,
) -> tuple[float, float]:
    """Return the mean probability that looks along the flights detect a drawn target, and its deviation.

    Targets are drawn from the prior, anywhere in their cells, and moved step by step.
    """
    rng = run.rng(113)
    cells = rng.choice(belief.frame.size, run.scale.targets, p=belief.mass.ravel())
    spread = rng.uniform(-0.5, 0.5, (len(cells), 2)) * belief.frame.resolution
    places = belief.frame.centres(cells) + spread
    missed = np.ones(len(places))
    poses = [platform.pose for platform in platforms]
    for step in range(HORIZON):
        places = motion.move(rng, places, belief.frame, DT)
        for i, platform in enumerate(platforms):
            looks = platform.look_poses(poses[i], float(turn_rates[i][step]), DT)
            for look in looks:
                missed *= 1.0 - platform.detector.chance(look, places)
            poses[i] = looks[-1]
    return float(1.0 - missed.mean()), float(missed.std() / np.sqrt(len(missed)))
