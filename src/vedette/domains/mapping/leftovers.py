"""What is left of a map to a robot that has no stop any more: each frontier, and why it is left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.left_alone import GivenUp, near_any
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.stops import (
    CLEARANCES,
    LEFT_ALONE,
    Ground,
    nearest_view,
    seen_from,
    survey,
    unknown_near,
)
from vedette.domains.mapping.views import MOST_STOPS, views_within
from vedette.team import PlatformSpec

Why = Literal["unseeable", "unreached", "out_of_reach"]


@dataclass(frozen=True)
class Leftover:
    """A frontier that a robot leaves, and behind which it knows nothing."""

    x: float  # [m], team frame
    y: float
    unknown: int  # cells near it
    why: Why  # looked at in vain; not got to, though there is a way; or the known map leaves its body no way


def given_up(platform: MappingPlatform) -> list[Leftover]:
    """Return what the robot has given up by now."""
    alone = platform.left_alone
    return [
        *(Leftover(spot.x, spot.y, spot.unknown, "unseeable") for spot in alone.looked_at),
        *(Leftover(spot.x, spot.y, spot.unknown, "unreached") for spot in alone.missed),
    ]


def leftovers(belief: MapBelief, platform: MappingPlatform) -> list[Leftover]:
    """Return what is left to a robot that has just found no stop.

    A frontier is out of reach if from no place that the map, without anybody's body in it, lets the robot
    drive to is it seen. One that promises too little for a stop is not worth mention. A lidar that sees no
    farther than its robot gets to a frontier has looked at nothing: whatever is left is unreached.
    """
    if blind(platform.spec, belief.frame.resolution):
        places = _places(belief).tolist()
        return [_left(belief, x, y, "unreached") for x, y in places]
    without_bodies = survey(belief, platform.spec, platform.x, platform.y, [], CLEARANCES[-1])
    middles, way = _seen(belief, platform, without_bodies)
    open_now = way
    if platform.obstacles and platform.ground is not None:
        _, open_now = _seen(belief, platform, platform.ground)
    alone = platform.left_alone
    visited, missed, told = alone.looked_at, alone.missed, alone.told
    left = [Leftover(spot.x, spot.y, spot.unknown, "unseeable") for spot in visited]
    for spot in missed:
        near, here = _near(middles, [spot]), np.array([spot.at])
        if near.any() and not _near(here, [*visited, *told]).any():
            left.append(Leftover(spot.x, spot.y, spot.unknown, _why(bool(way[near].any()))))
    untouched = ~_near(middles, [*visited, *missed, *told]) & ~(way & open_now)
    for (x, y), reachable in zip(middles[untouched].tolist(), way[untouched].tolist(), strict=True):
        left.append(_left(belief, x, y, _why(reachable)))
    return left


def blind(spec: PlatformSpec, resolution: float) -> bool:
    """Tell whether a lidar sees hardly a cell beyond what its robot keeps off from."""
    return spec.range < nearest_view(spec, resolution) + resolution


def _left(belief: MapBelief, x: float, y: float, why: Why) -> Leftover:
    return Leftover(x, y, unknown_near(belief.classes, belief.frame, x, y), why)


def _why(reachable: bool) -> Why:
    return "unreached" if reachable else "out_of_reach"


def _seen(
    belief: MapBelief, platform: MappingPlatform, ground: Ground
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return a place on each frontier, ``(K, 2)`` [m], and whether it is seen from anywhere on the ground.

    Where that takes too much work, it is.
    """
    frontiers = belief.frontier_cells, belief.frontier_starts
    away = seen_from(platform.spec, belief.frame.resolution, close=False)
    places = _places(belief)
    found = views_within(belief, ground, frontiers, away, 1 + len(places) // MOST_STOPS)
    places[found.clusters] = belief.frame.centres(found.targets)
    seen = np.full(len(places), found.cut_short)
    seen[found.clusters] = True
    return places, seen


def _places(belief: MapBelief) -> NDArray[np.float64]:
    starts = belief.frontier_starts
    return belief.frame.centres(belief.frontier_cells[(starts[:-1] + starts[1:]) // 2])


def _near(places: NDArray[np.float64], spots: Sequence[GivenUp]) -> NDArray[np.bool_]:
    """Tell which places are so near to any of the spots that what holds for it holds for them."""
    return near_any(places, (spot.at for spot in spots), LEFT_ALONE)
