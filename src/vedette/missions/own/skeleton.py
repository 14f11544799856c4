"""Skeleton: sites that somebody has to look at. Replace what is between the lines by your own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar

import numpy as np
from msgspec import Meta

from vedette.missions.own.codec import FloatsCodec
from vedette.missions.own.scenario import OwnScenario
from vedette.missions.own.theory import Evidence, Floats, Theory
from vedette.problem import Coverage
from vedette.scenario import Metre

SEES = 0.8  # probability that a look at a site in range tells of it


class SkeletonScenario(OwnScenario, frozen=True, kw_only=True):
    """What a scenario file says beside area, vehicles and times."""

    sites: Annotated[tuple[tuple[Metre, Metre], ...], Meta(min_length=1)]  # x, y [m]
    range: Annotated[float, Meta(gt=0.0)] = 40.0  # of the sensors [m]


class Skeleton(Theory[Floats, Floats]):
    """Let a team look at sites of which each hides a number. It is a skeleton, to make a domain of."""

    scenario_type = SkeletonScenario
    example: ClassVar[Mapping[str, Any]] = {
        "area": (0.0, 0.0, 400.0, 300.0),
        "vehicles": [{"start": (20.0, 20.0, 45.0)}, {"start": (380.0, 20.0, 135.0)}],
        "duration": 90.0,
        "step": 2.0,
        "horizon": 12,
        "sites": [(60.0, 200.0), (150.0, 90.0), (200.0, 260.0), (260.0, 120.0), (340.0, 220.0)],
    }

    # -- what there is, and what sensors tell of it ---------------------------------------------------

    def truth(self, rng: np.random.Generator) -> Floats:
        """Return the number that each site hides, (S,)."""
        return rng.normal(size=len(self.scenario.sites))

    def sense(self, truth: Floats, i: int, pose: Floats, rng: np.random.Generator) -> Any:
        """Return which sites in range told of themselves; None: none of them."""
        seen = np.flatnonzero(self._in_range(pose[None, None])[0, 0] & (rng.random(len(truth)) < SEES))
        return seen if len(seen) else None

    # -- what that says: whole numbers that add up over vehicles and time ----------------------------

    @property
    def size(self) -> int:
        """A number for each site: how often it has been seen."""
        return len(self.scenario.sites)

    def evidence(self, i: int, pose: Floats, told: Any) -> Evidence:
        """Count each site once more."""
        return told, np.ones(len(told), np.int64)

    # -- what looks are worth ------------------------------------------------------------------------

    objective = Coverage()  # a site that somebody sees already adds nothing
    codec = property(lambda self: FloatsCodec((self.size,), 0.0, 1.0))

    def belief(self, total: Any) -> Floats:
        """Return what each site is worth yet, (S,)."""
        return np.where(total == 0, 1.0, 0.0)

    def impacts(self, belief: Floats, i: int, poses: Floats) -> Sequence[Floats]:
        """Return how likely each course misses each site, (S,) each."""
        return list((1.0 - SEES) ** self._in_range(poses).sum(axis=1))

    def figures(self, belief: Floats, truth: Floats) -> Mapping[str, float]:
        """Return how many sites nobody has seen yet."""
        return {"unseen": float(belief.sum())}

    # ------------------------------------------------------------------------------------------------

    def _in_range(self, poses: Floats) -> Any:
        """Tell which sites are in range of poses (N, K, 3), (N, K, S)."""
        away = poses[..., None, :2] - np.array(self.scenario.sites)
        return np.hypot(away[..., 0], away[..., 1]) <= self.scenario.range
