"""What a vehicle would observe that winds may carry off its way: draws of it, course by course."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vedette.domains.tracking.belief import Tracks
from vedette.domains.tracking.courses import Course
from vedette.domains.tracking.impact import Impact
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.vehicle import Gust, check_gusts


def drawn_courses(
    platform: TrackingPlatform,
    belief: Tracks,
    gusts: Sequence[Gust],
    samples: int,
    rng: np.random.Generator,
) -> tuple[list[Course], list[tuple[Impact, ...]]]:
    """Return a platform's courses, and for each what it would observe in ``samples`` draws of its motion.

    They are candidates for ``problem.sampled.Sampled`` over the platform's objective: information does not
    stand for its mean, as psi is concave in it. All courses share the draws, so that they are compared in the
    same wind. docs/theory.md (V108)

    Args:
        platform: placed.
        belief: of the round.
        gusts: with their probabilities.
        samples: how many draws.
        rng: of the draws; another for each platform.
    """
    check_gusts(tuple(gusts))
    picks = rng.choice(len(gusts), size=samples, p=[gust.chance for gust in gusts])
    found = {}
    for pick in np.unique(picks).tolist():
        one = replace(platform, wind=gusts[pick].wind)
        one.prepare(belief)
        assert one.candidates is not None
        found[pick] = one
    courses = next(iter(found.values())).courses
    draws = [found[pick].candidates for pick in picks.tolist()]
    return courses, [tuple(own[c] for own in draws if own is not None) for c in range(len(courses))]
