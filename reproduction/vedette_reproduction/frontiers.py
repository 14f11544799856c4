"""Single frontiers as strategies (paper, section 5.1): a map frozen outside any round, who looks at it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief, freeze, longest_frontier
from vedette.domains.mapping.layers import TimeLayers
from vedette.domains.mapping.platform import MappingPlatform
from vedette.maps import GridFrame
from vedette.team import PlatformSpec


def frozen(
    classes: NDArray[np.uint8],
    frame: GridFrame,
    spec: PlatformSpec,
    layers: TimeLayers,
    counts: NDArray[np.int64],
) -> MapBelief:
    """Freeze a map (R, C) as the paper has it, with nothing hidden behind frontiers.

    Args:
        classes: the map.
        frame: where it lies.
        spec: the robots that look at it.
        layers: of time.
        counts: (ROWS, BINS) what their scans have seen.
    """
    extent = longest_frontier(spec.range)
    return freeze(classes, frame, reach=spec.range, extent=extent, hidden=0.0, layers=layers, counts=counts)


def robot_at(x: float, y: float, spec: PlatformSpec, belief: MapBelief) -> MappingPlatform:
    """Return a robot at (x, y) [m], alone, that has looked for its stops."""
    platform = MappingPlatform(spec, max_stops=1, measured="distance")
    platform.place(x, y, [], [(0, x, y)], 0.0)
    platform.prepare(belief)
    return platform


def reachable(platform: MappingPlatform) -> NDArray[np.int64]:
    """Return the numbers of the stops that a robot can go to."""
    assert platform.stops is not None
    return np.flatnonzero(np.isfinite(platform.stops.first_leg))
