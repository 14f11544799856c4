"""What a team is made of: each platform's body and lidar, as a team file lists them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PlatformSpec:
    """One robot: a disc that drives and turns in place, with a planar lidar at its centre."""

    name: str = "robot-1"
    speed: float = 0.5  # top speed [m/s]
    turn_rate: float = 1.5  # top turn rate [rad/s]
    radius: float = 0.2  # of the disc [m]
    range: float = 8.0  # of the lidar [m]
    view: float = 360.0  # field of view, centred on the heading [deg]
    beams: int = 360
    rate: float = 5.0  # scans a second [Hz]
    range_noise: float = 0.01  # standard deviation of a range [m]
    start: tuple[float, ...] | None = None  # x, y[, heading] [m, m, deg], team frame; None: chosen
