"""What a planner for the whole team needs and the paper's method does not: everybody's ways to everything."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.tour import Tour
from vedette.errors import InputError
from vedette.kernels import distance

STICK = 1.0  # a new choice must be nearer than the present one by this much [m]


@dataclass(eq=False)
class TeamPlatform(MappingPlatform):
    """A robot that works out the whole team's assignment, as a central planner would, and takes its part.

    Every robot computes the assignment alike, from the shared map and the places that beacons tell. It takes
    its mates to be built like itself, and to leave alone what it leaves alone.
    """

    lengths: NDArray[np.float64] = field(init=False, default_factory=lambda: np.empty((0, 0)))  # (n, K) [m]
    row: int = field(init=False, default=0)  # this robot's in lengths

    def prepare(self, belief: MapBelief) -> None:
        """Find the stops, and the path lengths of all robots to them.

        Rows are in the order of the robots' places, on which all agree: ties must fall alike for everybody.
        """
        super().prepare(belief)
        places = sorted((x, y) for _, x, y in self.team)
        self.row = int(np.argmin([np.hypot(x - self.x, y - self.y) for x, y in places]))
        self.lengths = np.array([self._to_stops(belief, robot, place) for robot, place in enumerate(places)])

    def _to_stops(self, belief: MapBelief, robot: int, place: tuple[float, float]) -> NDArray[np.float64]:
        """Path lengths from a robot's place to all stops [m]; infinite where this robot may not go."""
        assert self.stops is not None
        assert self.ground is not None
        own: NDArray[np.float64] = self.stops.first_leg.astype(np.float64) * self.spec.speed
        if robot == self.row:
            return own
        frame = belief.frame
        row, col = np.clip(frame.cell(*place), 0, (frame.rows - 1, frame.cols - 1))
        views = np.array([frame.flat(x, y) for x, y in self.stops.views], np.int64)
        source = int(row * frame.cols + col)
        lengths = distance.lengths_to(self.ground.passable, source, views, frame.resolution)
        return np.where(np.isfinite(own), lengths, np.inf)

    def sticky(self, current: Tour) -> NDArray[np.float64]:
        """Return ``lengths``, this robot's to its present stop a metre shorter."""
        lengths = self.lengths.copy()
        if len(current):
            lengths[self.row, current.stops[0]] -= STICK
        return lengths


def check_size(planner: str, robots: int, most: int) -> None:
    """Raise ``InputError`` for a team that is too large for a planner."""
    if robots > most:
        raise InputError(f"planner {planner!r} is for at most {most} robots, not {robots}; use 'rate'")
