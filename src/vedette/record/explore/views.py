"""What can be told of an exploring robot from outside, simulated in this process or on a network."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.leftovers import Leftover
from vedette.kernels.tiles import TiledGrid
from vedette.maps import UNKNOWN, GridFrame
from vedette.maps.bounds import Extent
from vedette.maps.laid import laid, part_laid
from vedette.record.explore.log import RobotSample
from vedette.record.explore.summary import LeftOut
from vedette.record.figures import RobotFigures


@dataclass(frozen=True)
class GroundFigures(RobotFigures):
    """What one robot on the ground has counted up to now."""

    collisions: int = 0  # steps in which a contact stopped it
    min_clearance_m: float = 0.5  # from its edge to a wall or to another robot, so far; measured up to 0.5 m
    pose_error_m: float | None = None  # farthest that it took itself to be from where it was; None: not known


@dataclass(frozen=True, eq=False)
class RobotView:
    """All that can be told of one robot from outside; nothing in it changes after it is made."""

    sample: RobotSample  # where it is, what it does, where it goes
    frame: GridFrame  # of the part of the ground outside of which it knows nothing
    classes: NDArray[np.uint8]  # (R, C) the map there as it holds it, with its own cells: see ``held_map``
    seen: NDArray[np.bool_]  # (R, C) what its own sensor has observed there
    impact: Impact | None  # of its last decision, over planning cells; None: it has not decided yet
    figures: GroundFigures
    digest: int  # of what it holds, equal for two that hold the same
    left_out: tuple[LeftOut, ...] = ()
    frontiers: int | None = None  # of its latest round; None: there has been none
    beyond: int = 0  # beams, or cells of its own map, that told of ground where there is no room for any
    turned_back: bool = False  # lest it does not come home

    def classes_on(self, frame: GridFrame) -> NDArray[np.uint8]:
        """Return its map as ``(R, C)`` of a grid of the observer's."""
        return laid(self.classes, self.frame, frame)

    def seen_on(self, frame: GridFrame) -> NDArray[np.bool_]:
        """Return what its own sensor has observed as ``(R, C)`` of a grid of the observer's."""
        return laid(self.seen, self.frame, frame)


def held_map(fused: NDArray[np.uint8], own: NDArray[np.int8]) -> NDArray[np.uint8]:
    """Return a robot's fused ``(R, C)`` classes, and where they are unknown the class of its own log-odds.

    The log-odds differ from the map until the robot publishes them.
    """
    held: NDArray[np.uint8] = (own != 0).astype(np.uint8)  # UNKNOWN, FREE, OCCUPIED are 0, 1, 2
    held += own > 0
    held *= fused == UNKNOWN
    held += fused
    return held


def held(
    fused: TiledGrid[np.uint8], own: TiledGrid[np.int8], known: Extent
) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """Return what a robot holds of the rows and columns where it knows anything, and what it saw itself."""
    evidence = own.window(*known)
    return held_map(fused.window(*known), evidence), evidence != 0


def union_map(views: Sequence[RobotView], frame: GridFrame) -> NDArray[np.uint8]:
    """Return ``(R, C)``: what the living robots hold together, told or not; if none lives, what all held.

    Where they differ, occupied wins over free, and free over unknown.
    """
    living = [view for view in views if view.sample.alive] or views
    union = living[0].classes_on(frame)
    for view in living[1:]:
        there, classes = part_laid(view.classes, view.frame, frame)
        union[there] = np.maximum(union[there], classes)  # UNKNOWN < FREE < OCCUPIED
    return union


def by_map(views: Sequence[RobotView]) -> tuple[tuple[str, ...], ...]:
    """Return the names of the living robots by the map that they hold, those that hold most robots' first."""
    holders: dict[int, list[str]] = {}
    for view in views:
        if view.sample.alive:
            holders.setdefault(view.digest, []).append(view.sample.name)
    return tuple(map(tuple, sorted(holders.values(), key=len, reverse=True)))


def frontiers_left(views: Sequence[RobotView]) -> int | None:
    """Return how many frontiers the living robots have left, as of the rounds that they were in last."""
    return max(
        (view.frontiers for view in views if view.sample.alive and view.frontiers is not None), default=None
    )


def left_out(left: Sequence[Leftover], by: str) -> tuple[LeftOut, ...]:
    """Return what a robot leaves, to be told."""
    return tuple(LeftOut(spot.x, spot.y, spot.unknown, spot.why, by) for spot in left)
