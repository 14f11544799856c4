"""The joint optimum of the team's objective over single frontiers, for teams of a few."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.baselines.joint import joint_optimum
from vedette.domains.mapping.baselines.team import TeamPlatform, check_size
from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import NOTHING, Impact
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.platform import HYSTERESIS, STICKINESS
from vedette.domains.mapping.tour import STAY, Tour
from vedette.kernels.coverage import LAYERS

MOST_ROBOTS = 4  # joint choices multiply: 40 frontiers, four robots, 2.6 million
NOWHERE = -1
_OBJECTIVE = MappingObjective()


@dataclass(frozen=True, eq=False)
class JointOptions:
    """What one robot can do: go to one of the stops, or nowhere if it can get to none."""

    stops: NDArray[np.int64]  # (M,) index among the round's stops, or NOWHERE
    impacts: list[Impact]  # (M,)

    def only(self, stop: int) -> JointOptions:
        """Return the options without all stops but one."""
        return JointOptions(np.array([stop]), [self.impacts[int(np.flatnonzero(self.stops == stop)[0])]])


@dataclass(eq=False)
class OptimalPlatform(TeamPlatform):
    """Takes its part of ``argmax_v J(v)``, one stop a robot, which all compute alike (paper, eq. (16))."""

    options: list[JointOptions] = field(init=False, default_factory=list)  # by row
    best: tuple[int, float] = field(
        init=False, default=(NOWHERE, 0.0)
    )  # own stop at the optimum; value [nats]

    def prepare(self, belief: MapBelief) -> None:
        """List everybody's options, and find the optimum.

        Raises:
            InputError: the team has more than four robots.
        """
        check_size("optimal", len(self.team), MOST_ROBOTS)
        super().prepare(belief)
        self.options = [self._options(belief, lengths) for lengths in self.lengths]
        choice, value = joint_optimum(belief, [own.impacts for own in self.options])
        self.best = int(self.options[self.row].stops[choice[self.row]]), value

    def reply(self, belief: MapBelief, others: Impact, current: Tour) -> Tour:
        """Return this robot's stop at the optimum; the present one unless it adds clearly less."""
        stop, value = self.best
        if stop == NOWHERE:
            return STAY
        if len(current) and current.stops[0] != stop:
            rest, kept = self._keeping(belief, int(current.stops[0]))
            if value - rest <= (kept - rest) * (1.0 + STICKINESS) * (1.0 + HYSTERESIS):
                return self.tour(current.stops[:1])
        return self.tour(np.array([stop]))

    def _keeping(self, belief: MapBelief, stop: int) -> tuple[float, float]:
        """Value of the best that mates can do if this robot keeps its stop, without it and with it [nats]."""
        options = list(self.options)
        options[self.row] = options[self.row].only(stop)
        choice, value = joint_optimum(belief, [own.impacts for own in options])
        mates = [own.impacts[k] for own, k in zip(options, choice, strict=True)]
        del mates[self.row]
        return _OBJECTIVE.value(belief, reduce(_OBJECTIVE.combine, mates, NOTHING)), value

    def _options(self, belief: MapBelief, lengths: NDArray[np.float64]) -> JointOptions:
        stops = np.flatnonzero(np.isfinite(lengths))
        if not len(stops):
            return JointOptions(np.array([NOWHERE]), [NOTHING])
        return JointOptions(
            stops, [self._glimpse(belief, k, lengths[k] / self.spec.speed) for k in stops.tolist()]
        )

    def _glimpse(self, belief: MapBelief, stop: int, arrival: float) -> Impact:
        """Return what a robot that gets to a stop at a time [s] would reveal."""
        assert self.stops is not None
        marks = self.stops.footprints
        row = slice(marks.starts[stop], marks.starts[stop + 1])
        keys = marks.cells[row] * np.uint32(LAYERS) + np.uint32(belief.layers.layer(arrival))
        return Impact(keys, marks.misses[row])
