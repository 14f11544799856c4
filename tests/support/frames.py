"""Parts of one building as robots with frames of their own would have mapped them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.align import Charted, FramePose, charted
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.missions.explore.own_map import OwnMap
from vedette.sim.worlds import office


@dataclass(frozen=True, eq=False)
class Part:
    """A part of a building, mapped in a frame of its own."""

    frame: GridFrame
    classes: NDArray[np.uint8]  # (R, C)
    pose: FramePose  # of its frame in the building's

    @property
    def charted(self) -> Charted:
        """The part, ready to be laid on another."""
        made = charted(self.frame, self.classes)
        assert made is not None
        return made


def building(seed: int, width: float = 24.0, height: float = 16.0) -> NDArray[np.uint8]:
    """Return the classes of an office at 0.1 m; what is solid and not beside anything free is unknown."""
    world = office(np.random.default_rng(seed), width, height)
    return shell(world.solid)


def shell(solid: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return what a lidar could know of a place: free ground and the faces about it."""
    around = np.pad(~solid, 1)
    rows, cols = solid.shape
    beside = np.zeros(solid.shape, np.bool_)
    for down in range(3):
        for right in range(3):
            beside |= around[down : down + rows, right : right + cols]
    return np.where(~solid, FREE, np.where(beside, OCCUPIED, UNKNOWN)).astype(np.uint8)


def part(
    classes: NDArray[np.uint8], left: float, right: float, pose: FramePose, resolution: float = 0.1
) -> Part:
    """Return what lies between two x [m] of a building whose corner is the origin, in an own frame."""
    kept = classes[:, round(left / 0.1) : round(right / 0.1)]
    rows = len(kept)
    own = pose.inverse()
    corners = np.array([[left, 0.0], [right, 0.0], [left, rows * 0.1], [right, rows * 0.1]])
    low, high = own.places(corners).min(axis=0) - 0.4, own.places(corners).max(axis=0) + 0.4
    wide, tall = np.ceil((high - low) / resolution).astype(int).tolist()
    x, y = low.tolist()
    frame = GridFrame(resolution, tall, wide, x, y)
    corner_x, corner_y = own.places(np.array([[left, 0.0]]))[0].tolist()
    return Part(frame, OwnMap(kept, 0.1, corner_x, corner_y, own.angle).laid(frame), pose)


def off(found: FramePose, a: Part, b: Part) -> tuple[float, float]:
    """Return how far a found T_a_b is from the true one at the middle of b, and by which angle [m, rad]."""
    return found.apart(a.pose.inverse().after(b.pose), b.charted.middle)
