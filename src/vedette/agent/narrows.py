"""Where on its way a robot comes through places in which two cannot pass side by side."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf

import numpy as np
from numpy.typing import NDArray

from vedette.agent.intents import GAP, TICK, Intent

AROUND = 0.5  # of a place on a way, this much of the way belongs to it [m]
BROAD = 1.0  # wider to one side is not told from this [m]


@dataclass(eq=False)
class Narrows:
    """Narrow places on the map of one robot, along the ways of all."""

    traversable: NDArray[np.bool_]  # (R, C) cells where my map allows my centre
    resolution: float  # [m]
    _found: dict[int, NDArray[np.bool_]] = field(default_factory=dict)  # by priority

    def width(self, way: NDArray[np.float64], place: int) -> float:
        """Least width [m] open to centres across a foreseen ``way``, within half a metre of a point."""
        near = np.hypot(*(way - way[place]).T) <= AROUND
        step = np.diff(way, axis=0, append=way[-1:] + (way[-1:] - way[-2:-1]))
        near &= np.hypot(*step.T) > 0
        return float(self._widths(way[near], step[near], BROAD).min(initial=inf)) if near.any() else 0.0

    def on_the_way(self, robot: Intent) -> NDArray[np.bool_]:
        """Tell which of a robot's foreseen places, ``(T,)``, are too narrow for two of its like abreast."""
        if robot.priority not in self._found:
            way = robot.foreseen
            narrow = np.zeros(len(way), np.bool_)
            if len(way) > 1:
                step = np.diff(way, axis=0, append=way[-1:] + (way[-1:] - way[-2:-1]))
                limit = 2.0 * robot.radius + GAP + self.resolution
                moves = np.hypot(*step.T) > 0
                narrow[moves] = self._widths(way[moves], step[moves], limit) < limit
            self._found[robot.priority] = narrow
        return self._found[robot.priority]

    def way_to(self, robot: Intent) -> float:
        """How far a robot still has to drive to the first narrow place on its way [m]; infinite: none."""
        narrow = self.on_the_way(robot)
        return float(narrow.argmax()) * TICK * robot.speed if narrow.any() else inf

    def _widths(
        self, places: NDArray[np.float64], ahead: NDArray[np.float64], most: float
    ) -> NDArray[np.float64]:
        """Return how wide it is across each way at each place [m]; to either side up to ``most``."""
        aside = np.column_stack((-ahead[:, 1], ahead[:, 0])) / np.hypot(*ahead.T)[:, None]
        distances = np.arange(0.0, most, self.resolution / 2)
        widths = np.zeros(len(places))
        for side in (aside, -aside):
            points = places[:, None] + distances[:, None] * side[:, None]
            open_ = self._open(points.reshape(-1, 2)).reshape(len(places), -1)
            widths += np.where(open_.all(axis=1), most, distances[np.argmin(open_, axis=1)])
        return widths

    def _open(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Values of the cells that hold the points ``(n, 2)``; False outside."""
        col, row = np.floor(points / self.resolution).astype(int).T
        rows, cols = self.traversable.shape
        inside = (row >= 0) & (col >= 0) & (row < rows) & (col < cols)
        values = np.zeros(len(points), dtype=np.bool_)
        values[inside] = self.traversable[row[inside], col[inside]]
        return values
