"""The exhaustive optimum of every round: what nobody in the team could work out, to compare with."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TypeAlias

from vedette.domains.tracking import impact as impacts
from vedette.domains.tracking.belief import Tracks
from vedette.domains.tracking.courses import CHOICES, Course
from vedette.domains.tracking.impact import Impact
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.problem import exhaustive

Joint: TypeAlias = tuple[tuple[Course, ...], Impact]  # some vehicles' courses and what they bring together

MOST_JOINT = 20_000  # joint choices tried a round: some 0.1 s


def joint_choices(decisions: int, horizon: int, vehicles: int, others: int = 0) -> int:
    """Return how many joint choices a round has, the present courses and ways to others included."""
    return int((CHOICES ** min(decisions, horizon) + 1 + others) ** vehicles)


class Oracle:
    """Looks into all vehicles at once and tries every joint choice, once a round."""

    def __init__(self) -> None:
        """Know nobody yet."""
        self.vehicles: list[TrackingPlatform] = []
        self._round: tuple[int, list[TrackingPlatform], tuple[Course, ...]] | None = None

    def course(self, vehicle: TrackingPlatform, belief: Tracks) -> Course:
        """Return a vehicle's part of the best joint choice on the belief.

        Where it has nothing to gain within the horizon, it heads for a target as it would on its own.
        """
        if self._round is None or self._round[0] != belief.k0 or vehicle not in self._round[1]:
            self._round = (belief.k0, *self._best(belief))
        _, team, choice = self._round
        place = team.index(vehicle)
        objective = vehicle.objective
        rest = [
            other.impact(belief, course)
            for k, (other, course) in enumerate(zip(team, choice, strict=True))
            if k != place
        ]
        others = reduce(objective.combine, rest, objective.nothing(belief))
        return vehicle.reply(belief, others, choice[place])

    def _best(self, belief: Tracks) -> tuple[list[TrackingPlatform], tuple[Course, ...]]:
        """Return who takes part in the round, and everybody's course."""
        team = [
            vehicle for vehicle in self.vehicles if vehicle.courses and vehicle.courses[0].k0 == belief.k0
        ]
        choice = [vehicle.courses[0] for vehicle in team]
        for group in _interacting(team):
            lists = [_distinct(team[i]) for i in group]
            middle = len(group) // 2  # two halves, each as one platform: the kernel takes many at a time
            halves = [_together(belief, half) for half in (lists[:middle], lists[middle:])]
            each = [[impact for _, impact in half] for half in halves]
            best = exhaustive(team[0].objective, belief, each)
            found = [course for half, k in zip(halves, best.choice, strict=True) for course in half[k][0]]
            for i, course in zip(group, found, strict=True):
                choice[i] = course
        return team, tuple(choice)


def _together(belief: Tracks, lists: Sequence[Sequence[Joint]]) -> list[Joint]:
    """Return every joint choice out of some lists, as if one platform made it."""
    joint: list[Joint] = [((), impacts.nothing(belief.blocks))]
    for each in lists:
        joint = [(a + b, impacts.combine(one, other)) for a, one in joint for b, other in each]
    return joint


def _distinct(vehicle: TrackingPlatform) -> list[Joint]:
    """Return the courses with their impacts; of those that see nothing, the first one only."""
    assert vehicle.candidates is not None
    pairs: list[Joint] = [
        ((course,), impact) for course, impact in zip(vehicle.courses, vehicle.candidates, strict=True)
    ]
    blind = [k for k, (_, impact) in enumerate(pairs) if not len(impact.targets)]
    return [pair for k, pair in enumerate(pairs) if k not in blind[1:]]


def _interacting(vehicles: Sequence[TrackingPlatform]) -> list[list[int]]:
    """Group the vehicles that can see the same targets, directly or by way of others.

    The value is a sum over targets: so the best joint choices of the groups make up that of the team.
    """
    groups: list[tuple[list[int], set[int]]] = []
    for i, vehicle in enumerate(vehicles):
        assert vehicle.candidates is not None
        members, seen = [i], set(vehicle.candidates.targets.tolist())
        apart = []
        for group in groups:
            if group[1] & seen:
                members, seen = group[0] + members, group[1] | seen
            else:
                apart.append(group)
        groups = [*apart, (members, seen)]
    return [members for members, _ in groups]


@dataclass(frozen=True, eq=False)
class Dictated:
    """A vehicle that does what the oracle says; ``vedette.agent.mission.RoundPlatform``."""

    vehicle: TrackingPlatform
    oracle: Oracle

    def impact(self, belief: Tracks, strategy: Course) -> Impact:
        """Return the information that a course would bring."""
        return self.vehicle.impact(belief, strategy)

    def reply(self, belief: Tracks, others: Impact, current: Course) -> Course:
        """Return this vehicle's part of the best joint choice."""
        return self.oracle.course(self.vehicle, belief)

    def slack(self, belief: Tracks, base: Impact) -> float:
        """Promise nothing: replies are not this vehicle's own."""
        return math.inf
