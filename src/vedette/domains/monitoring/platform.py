"""One robot or flyer that monitors: the ways it can take, what it would measure, its best reply."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from vedette.domains.monitoring.banded import LayerLooks
from vedette.domains.monitoring.field import FieldModel
from vedette.domains.monitoring.impact import Impact, impact_of, units_of
from vedette.domains.monitoring.objective import MonitoringBelief, MonitoringObjective
from vedette.domains.monitoring.ways import Place, Way, along, cells_of, cut, fan, passable, reached
from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.number import is_number
from vedette.problem import Reach

HYSTERESIS = 0.02  # a new way must gain this share more than the present one, against the rest of the team
MOST_BEARINGS = 16
FAR = 3.0  # lengths at which places have next to nothing in common: a correlation of 0.001


@dataclass(frozen=True)
class FieldSensor:
    """A sensor that measures the mean over ``side x side`` cells about where it is, again and again.

    Raises:
        InputError: a number out of its range.
    """

    variance: float  # of a measurement [unit^2]
    side: int = 1  # [cells]; 1: a point sensor
    every: float = 1.0  # between measurements [s]

    def __post_init__(self) -> None:
        for name, value in (("variance", self.variance), ("every", self.every)):
            if not (is_number(value) and value > 0.0):
                raise InputError(f"sensor: {name} must be a number > 0; got {value}")


@dataclass(eq=False)
class MonitoringPlatform:
    """Whoever moves at constant speed and measures; on the ground around what is blocked, or in the air.

    Candidates: two legs of half the horizon each in any of some bearings, staying, and what is left of the
    present way; each as far as there is a way, and no longer than the budget. ``place`` says where it is and
    what is left before ``prepare``; a round then works on what that found.

    Raises:
        InputError: a number out of its range.
    """

    speed: float  # [m/s]
    sensor: FieldSensor
    blocked: NDArray[np.bool_] | None = None  # (R, C) cells it cannot enter; None: it flies
    ground: GridFrame | None = None  # of these cells, and beyond which there is no way; None: the belief's
    budget: float = math.inf  # way that is left [m]
    awake: float = math.inf  # how long it measures yet [s]
    bearings: int = 8
    objective: MonitoringObjective = field(default_factory=MonitoringObjective)
    here: Place = (0.0, 0.0)  # [m], team frame
    present: Way | None = None
    ways: list[Way] = field(default_factory=list)  # that are compared; set by prepare
    candidates: list[Impact] = field(default_factory=list)  # what each would bring
    _looks: list[LayerLooks] = field(default_factory=list)  # the same by layer

    def __post_init__(self) -> None:
        if not (is_number(self.speed) and self.speed >= 0.0):
            raise InputError(f"monitoring: speed must be >= 0 m/s; got {self.speed}")
        if not self.budget >= 0.0:
            raise InputError(f"monitoring: budget must be >= 0 m; got {self.budget}")
        if not 1 <= self.bearings <= MOST_BEARINGS:
            raise InputError(f"monitoring: bearings must be 1 to {MOST_BEARINGS}; got {self.bearings}")

    def place(self, x: float, y: float, budget: float, present: Way | None = None) -> None:
        """Say where it is [m], team frame, how far it may still go [m], and what is left of its way."""
        self.here, self.budget, self.present = (x, y), budget, present

    def prepare(self, belief: MonitoringBelief) -> None:
        """List the ways, the present one among them, and what each would measure: the slow part.

        Raises:
            InputError: the robot is outside the field, or its map is of another grid.
        """
        frame = self.ground or belief.field.model.frame
        if not frame.contains(*self.here):
            raise InputError(f"monitoring: the robot is at {self.here}, outside the field; place it inside")
        if self.blocked is not None and self.blocked.shape != frame.shape:
            raise InputError(
                f"monitoring: blocked has shape {self.blocked.shape}; the field has {frame.shape}"
            )
        reach = self.speed * belief.patrol.horizon
        fanned = fan(self.here, reach, self.bearings)
        lengths = reached(
            np.array([way.places for way in fanned]), frame, self.blocked, min(self.budget, reach)
        )
        ways = [cut(way, far) for way, far in zip(fanned, lengths.tolist(), strict=True)]
        ways = [replace(way, step=belief.field.step) for way in ways]
        self.ways = list(dict.fromkeys([cut(self.restated(belief), reach), *ways]))
        self.candidates = self.impacts(belief, self.ways)
        self._looks = LayerLooks.of(self.candidates, belief.patrol.layers)

    def restated(self, belief: MonitoringBelief) -> Way:
        """Return what is left of the present way, as far as the budget allows, whatever else there is."""
        way = self.carry_over(belief, self.present)
        return passable(way, self.ground or belief.field.model.frame, self.blocked, self.budget)

    def carry_over(self, belief: MonitoringBelief, strategy: Way | None) -> Way:
        """Restate a way from where the robot is; stay, where there is none."""
        onward = () if strategy is None else strategy.places[1:]
        return Way((self.here, *(onward or (self.here,))), belief.field.step)

    def impact(self, belief: MonitoringBelief, strategy: Way) -> Impact:
        """The information that measuring along the way would bring, by layer; docs/monitoring.md (V124)."""
        return self.impacts(belief, [strategy])[0]

    def impacts(self, belief: MonitoringBelief, ways: Sequence[Way]) -> list[Impact]:
        """Return the same of many ways."""
        frame, patrol = belief.field.model.frame, belief.patrol
        count = math.floor(min(patrol.horizon, self.awake) / self.sensor.every + 1e-9)
        times = self.sensor.every * np.arange(1, count + 1).astype(np.float64)
        most = max(len(way.places) for way in ways)
        places = np.array([way.places + way.places[-1:] * (most - len(way.places)) for way in ways])
        points = along(places, np.tile(self.speed * times, (len(ways), 1)))
        row, col = cells_of(frame, points.reshape(-1, 2))
        cells = np.clip(row, 0, frame.rows - 1) * frame.cols + np.clip(col, 0, frame.cols - 1)
        spots = belief.field.spots.of(self.sensor.side, cells).reshape(len(ways), count)
        each = units_of(self.sensor.variance, belief.unit)
        layers = patrol.layer(times - 0.5 * self.sensor.every)
        return [impact_of(row, layers, each, patrol.layers) for row in spots]

    def reply(self, belief: MonitoringBelief, others: Impact, current: Way) -> Way:
        """Best way against the rest of the team, ``current`` if none is better; paper, eq. (30)."""
        gains = self.gains(belief, others)
        best = int(np.argmax(gains))
        if current in self.ways:
            present = float(gains[self.ways.index(current)])
        else:
            looks = LayerLooks.of([self.impact(belief, current)], belief.patrol.layers)
            (present,) = self.objective.gains(belief, others, looks).tolist()
        return self.ways[best] if gains[best] > (1.0 + HYSTERESIS) * present else current

    def reach(self, belief: MonitoringBelief) -> Reach:
        """Return where its gains depend on what others measure: within `FAR` lengths of where it can get."""
        x, y = self.here
        most = within(self, belief.field.model, belief.patrol.horizon)
        return ((x - most, y - most, x + most, y + most),)

    def slack(self, belief: MonitoringBelief, team: Impact) -> float:
        """No way adds more than this to the team's impact."""
        return max(0.0, float((self.gains(belief, team)).max(initial=0.0)))

    def gains(self, belief: MonitoringBelief, others: Impact) -> NDArray[np.float64]:
        """What each way adds to the rest of the team."""
        return self.objective.gains(belief, others, self._looks)


def within(platform: MonitoringPlatform, model: FieldModel, seconds: float) -> float:
    """Return how far away what others measure still matters to one that moves for so long [m]."""
    side = 0.5 * platform.sensor.side * model.frame.resolution
    return platform.speed * seconds + 2.0 * side + model.frame.resolution + FAR * model.length


def lawnmower(corners: Sequence[float], spacing: float) -> Way:
    """Return the way to and fro over a box x_min, x_max, y_min, y_max, lines so far apart [m]."""
    x_min, x_max, y_min, y_max = corners
    if not (is_number(spacing) and spacing > 0.0):
        raise InputError(f"lawn-mower: spacing must be > 0 m; got {spacing}")
    lines = max(1, math.ceil((y_max - y_min) / spacing))
    places: list[Place] = []
    for line in range(lines):
        y = y_min + (line + 0.5) * (y_max - y_min) / lines
        places += [(x_min, y), (x_max, y)] if line % 2 == 0 else [(x_max, y), (x_min, y)]
    return Way(tuple(places))
