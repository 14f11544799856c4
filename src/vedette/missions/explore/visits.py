"""How one robot carries out a tour: where it goes and turns next, and what counts as a visit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.agent.events import Pose
from vedette.agent.mates import Mate
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.stops import VIEW_REACH
from vedette.domains.mapping.tour import Tour
from vedette.missions.explore.failures import Failures
from vedette.missions.explore.looking import Looking
from vedette.missions.explore.resort import LastResort

THERE = 0.35  # a robot this near a stop's viewpoint is at it; more by two deviations of its pose [m]
WELL_SEEN = 0.5  # nothing is concluded from a look at what is nearer the end of the lidar's range ... [m]
IN_THE_WAY = 1.0  # a mate this near a frontier may hide it [m]
SERVED_SHARE = 0.4  # a frontier with less than this of its unknown cells left has lost its point


@dataclass(eq=False)
class Visits:
    """Visits of a tour's stops; of a robot without one, of where there is something left to try."""

    platform: MappingPlatform
    looking: Looking
    resort: LastResort
    failures: Failures
    unknown_at: Callable[[NDArray[np.float64]], int]  # cells near a frontier [m], on the newest map

    def goal(self, tour: Tour) -> tuple[float, float] | None:
        """Return where to go next [m]; None: nowhere, for now."""
        if not len(tour):
            return self.resort.goal
        if self.platform.is_ahead_of_map(tour):
            return None
        x, y = tour.views[0].tolist()
        return x, y

    def served(self, tour: Tour) -> bool:
        """Tell whether most of what the next stop was to reveal is known by now."""
        return len(tour) > 0 and self.unknown_at(tour.targets[0]) < SERVED_SHARE * int(tour.unknown[0])

    def reached(self, tour: Tour, pose: Pose, mates: Sequence[Mate], now: float) -> bool:
        """Note that the robot is where it was to go; False: it has not yet looked as planned.

        The next round sees whether a visit changed the map. A stop that a mate kept the robot from, or stands
        in front of, or whose frontier is out of the lidar's range, has not been visited.
        """
        if not len(tour):
            return self.resort.goal is None or self.resort.reached(pose)
        if not self._can_be_judged(tour, pose, mates, now):
            self.put_off(tour, now)
            return True
        if not self.served(tour) and self.facing(tour, pose) is not None:
            return False
        x, y = tour.targets[0].tolist()
        afar = float(np.hypot(*(tour.targets[0] - tour.views[0])))
        self.platform.left_alone.visited.append((x, y, int(tour.unknown[0]), afar))
        if self.platform.daring:
            self.platform.in_vain = 0
        return True

    def _can_be_judged(self, tour: Tour, pose: Pose, mates: Sequence[Mate], now: float) -> bool:
        """Tell whether a look from here says anything of the next stop's frontier."""
        (x, y), spec = tour.targets[0].tolist(), self.platform.spec
        away = np.hypot(pose.x - tour.views[0, 0], pose.y - tour.views[0, 1])
        there = away <= THERE + 2.0 * pose.deviation
        in_the_way = any(
            np.hypot(mate.x - x, mate.y - y) < IN_THE_WAY for mate in mates if not mate.silent(now)
        )
        within = np.hypot(pose.x - x, pose.y - y) <= max(spec.range - WELL_SEEN, VIEW_REACH * spec.range)
        return bool(there and not in_the_way and within)

    def facing(self, tour: Tour, pose: Pose) -> float | None:
        """Return the heading to turn to next where the robot goes; None: it has looked as planned."""
        if not len(tour):
            return self.resort.facing(pose)
        ahead = tour.targets[0] - tour.views[0]
        distance = float(np.hypot(*ahead))
        if distance < self.looking.resolution:
            return self.resort.facing(pose)
        return self.looking.toward(pose, float(np.arctan2(ahead[1], ahead[0])), distance)

    def put_off(self, tour: Tour, now: float) -> None:
        """Leave the next stop alone, for a while or for good."""
        target = tour.targets[0]
        x, y = target.tolist()
        self.failures.put_off(x, y, self.unknown_at(target), now)
