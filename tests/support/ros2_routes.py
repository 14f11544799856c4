"""Routes as an agent gives them to a robot's body."""

from __future__ import annotations

import numpy as np

from vedette.agent.effects import Drive, Route
from vedette.maps import GridFrame


def route(*path: tuple[float, float], facing: float | None = None) -> Drive:
    """Along these points [m], to face that way in the end."""
    return Drive(Route(np.array(path), np.ones((2, 2), np.bool_), GridFrame(0.1, 2, 2), facing=facing))
