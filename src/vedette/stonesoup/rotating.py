"""Stone Soup's rotating radar, all dwell angles at once: one question instead of one an angle.

Turning the antenna turns the measured bearing and changes neither what is known of its noise nor the range,
so that ``H' R^-1 H`` is the same at every dwell angle that has the track in view. Not so where the mean is on
the radar: Stone Soup gives it a bearing of 0 from the antenna, wherever that points.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from stonesoup.sensor.radar import RadarRotatingBearingRange

from vedette.stonesoup.forecast import Forecast
from vedette.stonesoup.information import difference_steps, information, linearised

_NEAR = 1e4  # steps of finite differences
_ASKED = ("measurement_model", "measure", "is_detectable", "is_visible", "position", "orientation")


def is_plain_rotating_radar(sensor: Any) -> bool:
    """Whether the sensor sees as ``RadarRotatingBearingRange`` does, upright and with nothing in the way."""
    own = all(
        getattr(type(sensor), name, None) is getattr(RadarRotatingBearingRange, name) for name in _ASKED
    )
    return own and not sensor.obstacles and not np.any(sensor.orientation[:2, 0])


def is_clear(sensor: Any, forecast: Forecast) -> bool:
    """Whether no mean is so near to the radar that finite differences of its bearing are no slope."""
    here = np.asarray(sensor.position, dtype=np.float64).ravel()
    mapping = list(sensor.position_mapping)
    away = np.linalg.norm(forecast.means[:, mapping] - here, axis=1)
    return bool((away > _NEAR * difference_steps(forecast.means[:, mapping]).max(axis=1, initial=0.0)).all())


class RotatingView:
    """What a plain rotating radar at a fixed place tells about each track, by its dwell angle."""

    def __init__(self, sensor: Any, forecast: Forecast) -> None:
        """Ask the radar once, as it stands."""
        model = sensor.measurement_model
        (bearings, ranges), jacobians = linearised(model, forecast, list(range(len(forecast.truths))))
        self._bearings = bearings + float(sensor.dwell_centre[0, 0])  # from the radar's own axis [rad]
        self._in_range = ranges <= sensor.max_range
        self._information = information(model, jacobians, forecast.covariances)

    def __call__(self, sensor: Any) -> NDArray[np.float64]:
        """Return the information about every track, (m, d, d), at the sensor's present dwell angle."""
        off = (self._bearings - float(sensor.dwell_centre[0, 0]) + np.pi) % (2.0 * np.pi) - np.pi
        seen = self._in_range & (np.abs(off) <= sensor.fov_angle / 2.0)
        return np.where(seen[:, None, None], self._information, 0.0)
