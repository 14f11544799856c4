"""How close together a lidar's beams lie where it looks, once the robot has turned through the gaps."""

from __future__ import annotations

from math import radians

from vedette.team import PlatformSpec

GAP = 6.0  # beams farther apart than that where they look leave gaps that the robot turns through [cells]
STEP = 2.0  # so far apart are the directions in which it looks then [cells]


def between(spec: PlatformSpec) -> float:
    """Return the angle between two beams [rad]."""
    return radians(spec.view) / spec.beams


def apart(spec: PlatformSpec, distance: float, resolution: float) -> float:
    """Return the angle between two directions of a whole look at what is so far away [rad].

    Args:
        spec: the robot with its lidar.
        distance: of what it looks at [m].
        resolution: side of a cell of the map [m].
    """
    lies = between(spec)
    return min(lies, STEP * resolution / distance) if lies * distance > GAP * resolution else lies
