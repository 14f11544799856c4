"""Visits in vain, as robots sign them: whom to believe."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from math import dist

from vedette.domains.mapping.left_alone import GivenUp
from vedette.domains.mapping.stops import LEFT_ALONE


def given_up(x: int, y: int, unknown: int) -> GivenUp:
    """Return what a note tells of; x, y [cm]."""
    return GivenUp(x / 100, y / 100, unknown)


def sifted(notes: Iterable[Collection[tuple[int, ...]]]) -> tuple[list[GivenUp], list[GivenUp]]:
    """Return what two robots have told of, and what one alone has; ``notes`` of each robot.

    Nobody's word alone ends a mission: what one robot alone has told of is left alone only while there is
    other work.
    """
    told = [[given_up(*note[:3]) for note in sorted(own)] for own in notes]
    sure, alone = list[GivenUp](), list[GivenUp]()
    for robot, spots in enumerate(told):
        others = [spot for k, theirs in enumerate(told) if k != robot for spot in theirs]
        for spot in spots:
            again = any(dist((spot.x, spot.y), (other.x, other.y)) < LEFT_ALONE for other in others)
            (sure if again else alone).append(spot)
    return sure, alone
