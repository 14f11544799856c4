"""A hub that shows a small made-up mission, and a page in Debian's Chromium to look at it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from vedette.agent.orders import Order
from vedette.maps import FREE, OCCUPIED, GridFrame
from vedette.record.explore.log import ExploreScene, ExploreSnapshot, RobotSample
from vedette.window.hub import Hub
from vedette.window.picture import Beside, picture

CHROMIUM = Path("/usr/bin/chromium")
FRAME = GridFrame(0.1, 70, 100, -2.0, 1.0)
SCENE = ExploreScene(name="hall", vehicles=("scout", "mule"), frame=FRAME, planning=FRAME.coarse(2))

needs_chromium = pytest.mark.skipif(not CHROMIUM.exists(), reason="Debian's chromium is not installed")


def snapshot(t: float, states: tuple[str, str] = ("driving", "driving")) -> ExploreSnapshot:
    """Two robots that drive to the right while the map grows by a column a second."""
    classes = np.zeros(FRAME.shape, np.uint8)
    classes[:, : int(t) + 1] = FREE
    classes[0] = OCCUPIED
    alive = tuple(state != "dead" for state in states)
    robots = tuple(
        RobotSample(
            -1.5 + 0.1 * t, 2.0 + 3.0 * i, 0.0, states[i], alive[i], np.array(((0.0, 0.0), (1.0, 1.0))), name,
            (1.0, 1.0), 0.1 * t,
        )
        for i, name in enumerate(SCENE.vehicles)
    )  # fmt: skip
    return ExploreSnapshot(t, robots, min(t / 100.0, 1.0), 0.5, 10.0, classes, None, known_m2=t)


def shown(
    times: range,
    give: Callable[[Order], str] | None = None,
    *,
    live: bool = True,
    beside: Beside | None = None,
) -> Hub:
    """A hub that has shown the mission at these times."""
    hub = Hub("hall", give, live=live)
    for t in times:
        hub.show(picture(SCENE, snapshot(float(t)), beside or Beside()))
    return hub
