"""How a vehicle gets somewhere by itself: to a place, or out of ground where nobody may be any more."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.agent.events import Pose
from vedette.agent.flight import AnyPlan, FlightPlan, Itinerary, MovePlan
from vedette.agent.mission import FlightMission, Place
from vedette.forbidden import BODY, Forbidden, Turning, steered

Floats = NDArray[np.float64]
_ROOMS = (1.5, 2.5, 4.0)  # that ways keep from areas, in radii of the least circle: the wider where need be
_SIDES, _APPROACH = 8, 2.5  # from which a place is come to, and from how far, in such radii
_STEP = 1.0  # of a way of one that turns at once [s]
_BEARINGS = 32
_MARCH = 0.25  # between two places on a way out [m]


@dataclass(frozen=True)
class Getting:
    """Makes plans that no round has decided on."""

    speed: float  # [m/s]
    turn_rate: float | None  # [rad/s]; None: it turns at once, and may stand

    @property
    def _turns(self) -> Turning | None:
        """How it turns; None: it may stand."""
        stands = self.turn_rate is None or self.turn_rate == 0.0 or self.speed == 0.0
        return None if stands or self.turn_rate is None else Turning(self.speed, self.turn_rate)

    def nowhere(self, now: float) -> AnyPlan:
        """Return a plan that is over at once: a circle follows, or it stands."""
        if self.turn_rate is None:
            return MovePlan(now, _STEP, np.empty((0, 2)))
        return FlightPlan(now, _STEP, np.empty(0))

    def is_at(self, pose: Pose, place: Place) -> bool:
        """Tell whether it is at a place, or circles beside it."""
        near = 1.0 if self._turns is None else 2.5 * self._turns.radius
        return math.hypot(pose.x - place[0], pose.y - place[1]) <= near

    def to(
        self, mission: FlightMission[Any, Any, Any], pose: Pose, place: Place, now: float
    ) -> AnyPlan | None:
        """Return a plan that leads to a place; None: none is found."""
        here = pose.x, pose.y
        if self.speed == 0.0 or self.turn_rate == 0.0:
            return None
        if self._turns is None:
            way = mission.route(here, place, 2.0 * BODY)
            return self._along(way, now) if way else None
        for room in _ROOMS:
            for by in self._approaches(place) if mission.forbidden else ((place,),):
                plan = self._turning(mission, pose, by, room * self._turns.radius, now)
                if plan is not None:
                    return plan
        return None

    def _approaches(self, place: Place) -> Iterator[tuple[Place, ...]]:
        """Yield ways to come to a place: straight, then from each side, for the circle there to be free."""
        yield (place,)
        assert self._turns is not None
        for turn in np.linspace(0.0, 2.0 * math.pi, _SIDES, endpoint=False).tolist():
            far = _APPROACH * self._turns.radius
            yield (place[0] - far * math.cos(turn), place[1] - far * math.sin(turn)), place

    def _turning(
        self,
        mission: FlightMission[Any, Any, Any],
        pose: Pose,
        by: tuple[Place, ...],
        room: float,
        now: float,
    ) -> AnyPlan | None:
        """Return a plan that leads by places to the last of them, and keeps out; None: none is found."""
        assert self._turns is not None
        corners = [(pose.x, pose.y)]
        for place in by:
            way = mission.route(corners[-1], place, room)
            if not way:
                return None
            corners += way[1:]
        at = np.array((pose.x, pose.y, pose.heading))
        turns = steered(at, [np.array(each) for each in corners[1:]], self._turns)
        if turns is None:
            return None
        plan = FlightPlan(now, turns[1], turns[0])
        flight = Itinerary(self.turn_rate).joined(plan, now)
        return plan if not mission.forbidden or self.keeps_out(mission.forbidden, flight, pose, now) else None

    def out(self, mission: FlightMission[Any, Any, Any], pose: Pose, now: float) -> AnyPlan | None:
        """Return a plan that leads out of what is forbidden, the soonest; None: there is none, or no need."""
        forbidden = mission.forbidden
        if self._turns is not None:
            rates, step = forbidden.escape(np.array((pose.x, pose.y, pose.heading)), self._turns)
            return FlightPlan(now, step, rates)
        if self.turn_rate is not None or self.speed == 0.0 or not forbidden.holds(pose.x, pose.y):
            return None
        turns = np.linspace(0.0, 2.0 * math.pi, _BEARINGS, endpoint=False)
        ways = np.column_stack((np.cos(turns), np.sin(turns)))
        boxes = np.array([area.box for area in forbidden.areas])
        across = float(np.hypot(*(boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0))))
        steps = np.arange(1, math.ceil(across / _MARCH) + 4) * _MARCH
        places = np.array((pose.x, pose.y)) + steps[None, :, None] * ways[:, None]
        free = (forbidden.distance(places) > BODY) & mission.passes(places)
        open_ = np.logical_and.accumulate(mission.passes(places), axis=1)
        first = np.where((free & open_).any(axis=1), np.argmax(free & open_, axis=1), len(steps))
        best = int(np.argmin(first))
        if first[best] == len(steps):
            return None
        x, y = places[best, first[best]].tolist()
        return self._along([(pose.x, pose.y), (x, y)], now)

    def keeps_out(self, forbidden: Forbidden, flight: Itinerary, pose: Pose, now: float) -> bool:
        """Tell whether a flight from now on, and what follows it, keeps out of what is forbidden."""
        if self.speed == 0.0 or self.turn_rate == 0.0:
            return True  # it cannot help where it is
        at = pose.x, pose.y, pose.heading
        if self._turns is None:
            places = flight.traced(at, self.speed, now, _MARCH)[:, :2]
            return bool((forbidden.distance(places) > 0.0).all())
        poses = flight.traced(at, self.speed, now, self._turns.spacing)
        return bool(forbidden.clear(poses, self._turns))

    def _along(self, way: list[Place], now: float) -> MovePlan:
        """Return a plan along straight lines at full speed."""
        corners = np.array(way, np.float64)
        legs = np.hypot(*np.diff(corners, axis=0).T)
        marks = np.concatenate(((0.0,), np.cumsum(legs)))
        steps = max(1, math.ceil(marks[-1] / (self.speed * _STEP)))
        at = np.minimum(self.speed * _STEP * np.arange(steps + 1), marks[-1])
        places = np.column_stack([np.interp(at, marks, axis) for axis in corners.T])
        return MovePlan(now, _STEP, np.diff(places, axis=0) / _STEP)
