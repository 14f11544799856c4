"""What is known of how contributors' frames lie in each other, as each tells it behind its counts."""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.link import BOOT_BITS, Key
from vedette.maps.transform import TURN, Transform

NUMBERS = 6  # that an edge takes
MOST_ROBOTS = 1 << 16
MOST_AWAY = 1 << 30  # [mm]


class EdgeKind(IntEnum):
    """What speaks for an edge."""

    MATCH = 0  # walls of both maps
    MEETING = 1  # a robot has seen the other move
    GUESS = 2  # walls, but not enough: it joins nobody


class FrameEdge(NamedTuple):
    """``T_a_b`` between two contributors' frames: where b's lies in a's."""

    a: Key
    b: Key
    there: Transform
    weight: int  # walls in common [cm], or as many as leave a meeting so uncertain; a guess's chance [%]
    kind: EdgeKind = EdgeKind.MATCH

    @property
    def met(self) -> bool:
        """Whether it is a meeting."""
        return self.kind is EdgeKind.MEETING

    @property
    def inverse(self) -> FrameEdge:
        """The same as it is seen from b."""
        return FrameEdge(self.b, self.a, self.there.inverse(), self.weight, self.kind)

    @property
    def upwards(self) -> FrameEdge:
        """The same as it is seen from the lower contributor."""
        return self if self.a < self.b else self.inverse


def room_for(robots: int) -> int:
    """Return how many numbers one contributor has for its edges, in a team of so many."""
    return NUMBERS * 2 * max(robots - 1, 1)


def packed(edges: Iterable[FrameEdge], room: int) -> NDArray[np.int64]:
    """Return the heaviest edges as so many numbers; 0 where there are no more."""
    numbers = np.zeros(room, np.int64)
    kept = sorted(edges, key=lambda edge: (-edge.weight, edge))[: room // NUMBERS]
    for at, edge in enumerate(sorted(kept)):
        a, b = (robot << BOOT_BITS | boot for robot, boot in (edge.a, edge.b))
        told = 1 + len(EdgeKind) * edge.weight + edge.kind
        numbers[NUMBERS * at : NUMBERS * (at + 1)] = told, a, b, *edge.there
    return numbers


def unpacked(numbers: NDArray[np.int64]) -> list[FrameEdge]:
    """Return the edges that a contributor tells; what can be none is left out, for anything may be told."""
    edges = []
    for told, a, b, x, y, angle in numbers.reshape(-1, NUMBERS).tolist():
        most = MOST_ROBOTS << BOOT_BITS
        fits = told > 0 and 0 <= a < most and 0 <= b < most and a != b and 0 <= angle < TURN
        if fits and max(abs(x), abs(y)) <= MOST_AWAY:
            weight, kind = divmod(told - 1, len(EdgeKind))
            edges.append(FrameEdge(_key(a), _key(b), Transform(x, y, angle), weight, EdgeKind(kind)))
    return edges


def _key(number: int) -> Key:
    return number >> BOOT_BITS, number & (1 << BOOT_BITS) - 1
