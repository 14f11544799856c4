"""An objective of one's own for tracking: some targets matter more than others.

`vedette track --objective own_objective:Guarding` takes it from this folder; docs/how-to/own-objective.md.
"""

from vedette.domains.tracking.impact import Impact
from vedette.domains.tracking.objective import TrackingObjective


def about(impact: Impact, target: int) -> Impact:
    """Return what an impact tells of one target."""
    own = impact.targets == target
    return Impact(impact.targets[own], impact.blocks[own])


class Guarding(TrackingObjective):
    """What is learned of the first target counts ten times: a weighted sum, so monotone and submodular."""

    more = ((0, 9.0),)  # targets, and what they count beside the one time that each does

    def values(self, belief, others, own):  # of others * own_k, for every k
        total = super().values(belief, others, own)
        for target, weight in self.more:
            these = [about(each, target) for each in own]
            total = total + weight * super().values(belief, about(others, target), these)
        return total
