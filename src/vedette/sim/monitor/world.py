"""Those who measure, simulated: they move over the true field, and read it at each step's end."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vedette.domains.monitoring.case import MonitorCase
from vedette.missions.monitor.monitoring import FieldLook
from vedette.outcome import Outcome
from vedette.sim.simulation import random_streams
from vedette.sim.vehicles import Vehicles


def measurers(case: MonitorCase, seed: int, over: Callable[[float], Outcome | None]) -> Vehicles:
    """Return the vehicles of a case, at their starts.

    Chance comes from one stream for the field and one for each sensor: teams that behave differently meet the
    same field, and the same noise.
    """
    truth, frame = case.truth(seed), case.scenario.frame
    streams = random_streams(seed, len(case.scenario.vehicles))
    rows = case.spots.weights

    def look(i: int, pose: NDArray[np.float64], now: float) -> FieldLook:
        x0, x1, y0, y1 = frame.extent
        margin = 1e-6 * frame.resolution
        x, y = np.clip(pose[:2], (x0, y0), (x1 - margin, y1 - margin)).tolist()
        cell, sensor = frame.flat(x, y), case.sensor(i)
        spot = case.spots.of(sensor.side, np.array([cell]))
        field = truth.at(round(now / case.scenario.step)).ravel()
        noise = np.sqrt(sensor.variance) * streams[i].normal()
        return FieldLook(cell, float((rows[spot] @ field)[0] + noise))

    return Vehicles(
        [vehicle.pose for vehicle in case.scenario.vehicles],
        [vehicle.speed for vehicle in case.scenario.vehicles],
        None,
        case.scenario.step,
        look,
        over,
    )
