"""A planner of one's own: each robot keeps to the frontiers on its own side, and negotiates over those.

`vedette explore --planner own_planner:SIDES` takes it from this folder; docs/how-to/own-planner.md explains.
"""

from dataclasses import replace

import numpy as np

from vedette.domains.mapping import layers
from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.planners import Planner
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.tour import Tour


class SidesPlatform(MappingPlatform):
    """Prefers frontiers that are nearer to it than to any mate; takes others when none of these is left."""

    def reply(self, belief: MapBelief, others: Impact, current: Tour) -> Tour:
        """Return the best tour over its own side; the negotiation asks until nobody changes any more."""
        found = self.stops  # what `prepare` found, before the negotiation began
        mates = [(x, y) for robot, x, y in self.team if robot >= 0]  # -1 is this robot itself
        mine = np.hypot(*(found.targets - (self.x, self.y)).T)
        theirs = [np.hypot(*(found.targets - mate).T) for mate in mates]
        near = np.isfinite(found.first_leg) & (mine <= np.min(theirs, axis=0, initial=np.inf))
        if not near.any():
            return super().reply(belief, others, current)
        self.stops = replace(found, first_leg=np.where(near, found.first_leg, np.float32(np.inf)))
        try:
            return super().reply(belief, others, current)
        finally:
            self.stops = found


SIDES = Planner("frontiers nearer to oneself than to any mate first", layers.rate(start=5.0), SidesPlatform)
