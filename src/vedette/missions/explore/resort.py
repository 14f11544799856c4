"""What a robot does before it concludes that there is nothing for it to do: look all round, and creep."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from vedette.agent.events import Pose
from vedette.domains.mapping.stops import Ground
from vedette.maps import GridFrame
from vedette.missions.explore.looking import SAME_SPOT, Looking

NEAR = 2.0  # so far away beams shall lie close together when a robot looks all round [m]
CREEP = 0.5  # a robot that can get no farther than that is hemmed in, and creeps for another look [m] ...
CREEPS = 3  # ... so often
Place = tuple[float, float]  # x, y [m], team frame


@dataclass(eq=False)
class LastResort:
    """Where a robot without any stop that it can reach still has to look, once from each place.

    A robot whose lidar leaves its surroundings unknown knows no way from where it stands, until it has turned
    on the spot. One that is hemmed in by what is not known creeps a little and looks again.
    """

    looking: Looking
    goal: Place | None = None
    _looked: list[Place] = field(default_factory=list)  # all round
    _creeps: int = 0
    _creeping: bool = False

    def consider(self, pose: Pose, frame: GridFrame, ground: Ground, frontiers: bool) -> None:
        """Find what is left to try for want of stops; ``frontiers``: there are any."""
        if self.goal is not None and self._creeping:
            return
        self.goal, self._creeping = None, False
        if not frontiers:
            return
        if not self._has_looked(pose) and self.facing(pose) is not None:
            self.goal = pose.x, pose.y
        elif hemmed_in(ground) and self._creeps < CREEPS:
            self.goal = self._place_to_creep_to(pose, frame, ground)
            self._creeping = self.goal is not None
            self._creeps += self._creeping

    def facing(self, pose: Pose) -> float | None:
        """Return the heading to turn to next; None: the robot has looked all round from here."""
        return self.looking.around(pose, NEAR)

    def reached(self, pose: Pose) -> bool:
        """Note that the robot is there; False: it has to look on from here."""
        if self.facing(pose) is not None:
            return False
        self._looked.append((pose.x, pose.y))
        self.goal = None
        return True

    def _has_looked(self, pose: Pose) -> bool:
        same = SAME_SPOT + 2.0 * pose.deviation
        return any(np.hypot(pose.x - x, pose.y - y) <= same for x, y in self._looked)

    def _place_to_creep_to(self, pose: Pose, frame: GridFrame, ground: Ground) -> Place | None:
        """Return the place a short way off that is farthest from here and from where the robot has looked."""
        cells = np.flatnonzero(ground.field.ravel() <= CREEP)
        centres = frame.centres(cells)
        away = np.full(len(cells), np.inf)
        for x, y in ((pose.x, pose.y), *self._looked):
            away = np.minimum(away, np.hypot(*(centres - (x, y)).T))
        if away.max(initial=0.0) <= SAME_SPOT:
            return None
        x, y = centres[int(np.argmax(away))].tolist()
        return x, y


def hemmed_in(ground: Ground) -> bool:
    """Tell whether a robot can hardly move from where it stands."""
    return bool(np.max(ground.field, where=np.isfinite(ground.field), initial=0.0) <= CREEP)
