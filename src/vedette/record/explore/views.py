"""What can be told of an exploring robot from outside, simulated in this process or on a network."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.leftovers import Leftover
from vedette.maps import UNKNOWN
from vedette.maps.bounds import EVERYWHERE, Extent
from vedette.record.explore.log import RobotSample
from vedette.record.explore.summary import LeftOut
from vedette.record.figures import RobotFigures


@dataclass(frozen=True)
class GroundFigures(RobotFigures):
    """What one robot on the ground has counted up to now."""

    collisions: int = 0  # steps in which a contact stopped it
    min_clearance_m: float = 0.5  # from its edge to a wall or to another robot, so far; measured up to 0.5 m


@dataclass(frozen=True, eq=False)
class RobotView:
    """All that can be told of one robot from outside; nothing in it changes after it is made."""

    sample: RobotSample  # where it is, what it does, where it goes
    classes: NDArray[np.uint8]  # (R, C) the map as it holds it, its own cells included: see ``held_map``
    seen: NDArray[np.bool_]  # (R, C) what its own sensor has observed
    impact: Impact | None  # of its last decision, over planning cells; None: it has not decided yet
    figures: GroundFigures
    left_out: tuple[LeftOut, ...] = ()


def held_map(
    fused: NDArray[np.uint8], own: NDArray[np.int8], known: Extent = EVERYWHERE
) -> NDArray[np.uint8]:
    """Return a robot's fused ``(R, C)`` classes, and where they are unknown the class of its own log-odds.

    The log-odds differ from the map until the robot publishes them. Outside ``known`` there is nothing.
    """
    whole = np.zeros(fused.shape, np.uint8)  # costs no more than what is written to it
    held = whole[known]
    held += own[known] != 0  # UNKNOWN, FREE, OCCUPIED are 0, 1, 2
    held += own[known] > 0
    held *= fused[known] == UNKNOWN
    held += fused[known]
    return whole


def seen_by(own: NDArray[np.int8], known: Extent = EVERYWHERE) -> NDArray[np.bool_]:
    """Return ``(R, C)`` where a robot has evidence of its own; outside ``known`` it has none."""
    whole = np.zeros(own.shape, np.bool_)
    whole[known] = own[known] != 0
    return whole


def union_map(views: Sequence[RobotView]) -> NDArray[np.uint8]:
    """Return ``(R, C)``: what the living robots hold together, told or not; if none lives, what all held.

    Where they differ, occupied wins over free, and free over unknown.
    """
    living = [view for view in views if view.sample.alive] or views
    union = living[0].classes.copy()
    for view in living[1:]:
        np.maximum(union, view.classes, out=union)  # UNKNOWN < FREE < OCCUPIED
    return union


def left_out(left: Sequence[Leftover], by: str) -> tuple[LeftOut, ...]:
    """Return what a robot leaves, to be told."""
    return tuple(LeftOut(spot.x, spot.y, spot.unknown, spot.why, by) for spot in left)
