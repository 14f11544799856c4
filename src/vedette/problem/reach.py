"""Where platforms can make a difference: a few boxes, so that messages can leave out what lies elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import Protocol, TypeAlias, TypeVar, runtime_checkable

ImpactT = TypeVar("ImpactT")
BeliefT_contra = TypeVar("BeliefT_contra", contravariant=True)

Box: TypeAlias = tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y
Reach: TypeAlias = tuple[Box, ...]  # their union

MOST_BOXES = 4  # in a joined reach, so that it is as short for a thousand platforms as for four


@runtime_checkable
class Clippable(Protocol[BeliefT_contra, ImpactT]):
    """An objective whose impacts lie somewhere, so that what is out of reach can be left out."""

    def clip(self, belief: BeliefT_contra, impact: ImpactT, reach: Reach) -> ImpactT:
        """Return what of an impact can matter to platforms that make a difference only within ``reach``.

        For all impacts x of such platforms and all a: ``value(clip(a) * x) - value(clip(a)) == value(a * x) -
        value(a)``.  docs/theory.md (V14)
        """


def join(*reaches: Reach) -> Reach:
    """Return at most `MOST_BOXES` boxes that hold all those given: the nearest are put together."""
    boxes: set[Box] = set()
    for box in (box for reach in reaches for box in reach):
        boxes.add(box)
        if len(boxes) > MOST_BOXES:
            one, other = min(combinations(sorted(boxes), 2), key=lambda pair: _waste(*pair))
            boxes -= {one, other}
            boxes.add(_around(one, other))
    return tuple(sorted(boxes))


def behind(own: Reach, heard: Mapping[int, Reach]) -> dict[int, Reach]:
    """Return for each neighbour what to tell it: the reach of all on this side of the link.

    That is ``own`` and what all the other neighbours told, (V5) with `join` for ``*``; ``heard`` may lack
    neighbours that have told nothing yet.
    """
    neighbours = list(heard)
    before: list[Reach] = [own]
    after: list[Reach] = [()] * (len(neighbours) + 1)
    for neighbour in neighbours:
        before.append(join(before[-1], heard[neighbour]))
    for place in reversed(range(len(neighbours))):
        after[place] = join(after[place + 1], heard[neighbours[place]])
    return {k: join(before[place], after[place + 1]) for place, k in enumerate(neighbours)}


def _around(one: Box, other: Box) -> Box:
    return min(one[0], other[0]), min(one[1], other[1]), max(one[2], other[2]), max(one[3], other[3])


def _area(box: Box) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def _waste(one: Box, other: Box) -> float:
    """Return the area that a common box adds; negative where the two overlap."""
    return _area(_around(one, other)) - _area(one) - _area(other)
