"""A body of one's own for `vedette agent`: a robot that drives and looks in a hall of four walls.

Yours asks your localisation and your lidar, and hands routes to your driver. A robot's file names it.
"""

import numpy as np

from vedette.agent.body import TICK, BodyFigures
from vedette.agent.effects import Drive
from vedette.agent.events import Arrived, Event, Pose, Scan
from vedette.team import PlatformSpec

BEAMS = np.radians(np.arange(0.0, 360.0, 2.0))  # directions in the team's frame
AHEAD = np.cos(BEAMS) + 1e-9, np.sin(BEAMS) + 1e-9


class HallRobot:
    def __init__(self, spec: PlatformSpec, size: list[float]) -> None:
        self.hull, self.size, self.way, self.figures = spec, size, [], BodyFigures()
        self.pose = spec.start[0], spec.start[1], 0.0  # x, y [m], heading [rad], team frame

    def sense(self, now: float) -> list[Event]:  # each TICK: pose, scan, what became of its way
        arrived = [Arrived()] if self.way and self.drive(TICK * self.hull.speed) else []
        walls = [
            np.where(d > 0, s - p, -p) / d for d, s, p in zip(AHEAD, self.size, self.pose[:2], strict=True)
        ]
        return [Pose(*self.pose), Scan(BEAMS, np.minimum(*walls)), *arrived]

    def drive(self, metres: float) -> bool:
        step = np.subtract(self.way[0], self.pose[:2])
        x, y = np.add(self.pose[:2], step * min(1.0, metres / max(np.hypot(*step), 1e-9))).tolist()
        self.pose = x, y, float(np.arctan2(step[1], step[0]))
        self.way = self.way[1:] if np.allclose((x, y), self.way[0]) else self.way
        return not self.way

    def carry_out(self, motion: Drive, now: float) -> None:  # a route to follow from now on; None: stand
        self.way = [] if motion.route is None else motion.route.path[1:].tolist()

    def stop(self, now: float) -> None:
        self.way = []
