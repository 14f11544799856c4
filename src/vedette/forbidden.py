"""Ground that vehicles must not be over: which flights keep out of it, and how to get out, or round it.

A vehicle that cannot stand circles when its plan is over. So a flight keeps out only if the circle after it
does, too: whoever holds such a flight can always hold on to it, whatever the next plans are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vedette.maps.area import Area
from vedette.vehicle import drive

Floats = NDArray[np.float64]
BODY = 0.5  # that a vehicle keeps beside its way [m]
_OF_RADIUS = 1.0 / 16.0  # of the least circle's radius: that it keeps from an area
_ARC = math.pi / 12.0  # in which an escape turns
_ARCS = 24
_MOST_STEPS = 10_000


@dataclass(frozen=True)
class Turning:
    """How a vehicle moves that cannot stand."""

    speed: float  # [m/s]
    turn_rate: float  # at most [rad/s], and in its circle

    @property
    def radius(self) -> float:
        """Of its least circle [m]."""
        return self.speed / self.turn_rate if self.turn_rate > 0.0 else 0.0

    @property
    def margin(self) -> float:
        """That it keeps from an area [m]: half of what lies between two places that are looked at."""
        return BODY + _OF_RADIUS * self.radius

    @property
    def spacing(self) -> float:
        """Between two places of a flight that are looked at, at most [m]."""
        return 2.0 * self.margin


@dataclass(frozen=True)
class Forbidden:
    """No-go areas; false if there are none."""

    areas: tuple[Area, ...] = ()

    def __bool__(self) -> bool:
        """Tell whether there are any."""
        return bool(self.areas)

    def distance(self, places: Floats) -> Floats:
        """Return how far places ``(..., 2)`` [m] are from the nearest of them, ``(...)``; 0 inside."""
        flat = places.reshape(-1, 2)
        nearest = np.min([area.distance(flat) for area in self.areas], axis=0, initial=math.inf)
        return np.asarray(nearest).reshape(places.shape[:-1])

    def holds(self, x: float, y: float) -> bool:
        """Tell whether a place is inside."""
        return bool(self.areas) and float(self.distance(np.array([x, y]))) <= 0.0

    def clear(self, poses: Floats, vehicle: Turning) -> NDArray[np.bool_]:
        """Tell which flights, ``(..., P, 3)`` poses no farther apart than ``spacing``, keep out for good."""
        on_the_way = (self.distance(poses[..., :2]) > vehicle.margin).all(axis=-1)
        end = poses[..., -1, :]
        left = np.stack((-np.sin(end[..., 2]), np.cos(end[..., 2])), axis=-1)
        middle = end[..., :2] + vehicle.radius * left
        return np.asarray(on_the_way & (self.distance(middle) > vehicle.radius + vehicle.margin))

    def allows(self, pose: Floats, rates: Floats, vehicle: Turning, dt: float) -> NDArray[np.bool_]:
        """Tell which flights ``(C,)`` from a pose keep out: turn rates ``(C, K)``, each held for ``dt``."""
        parts = max(1, math.ceil(vehicle.speed * dt / vehicle.spacing))
        poses = drive(pose, np.repeat(rates, parts, axis=1), vehicle.speed, dt / parts)
        start = np.broadcast_to(pose, (len(rates), 1, 3))
        return self.clear(np.concatenate((start, poses), axis=1), vehicle)

    def kept_out(self, pose: Floats, rates: Floats, vehicle: Turning, dt: float, fixed: int = 0) -> Floats:
        """Return turn rates ``(C, K)`` with those that do not keep out replaced by the first that do.

        If none do, by those of the circle, after the ``fixed`` first steps.
        """
        if not self.areas:
            return rates
        allowed = self.allows(pose, rates, vehicle, dt)
        circle = rates[0].copy()
        circle[fixed:] = vehicle.turn_rate
        instead = rates[int(np.argmax(allowed))] if allowed.any() else circle
        return np.where(allowed[:, None], rates, instead)

    def escape(self, pose: Floats, vehicle: Turning) -> tuple[Floats, float]:
        """Return turn rates ``(K,)`` that lead out, or past, and for how long each is held [s].

        One turn, as far as need be, then straight on: of these ways the one that is soonest out, then over.
        """
        step = _ARC / vehicle.turn_rate
        straight = math.ceil(self._across(pose) / (vehicle.speed * step)) + _ARCS // 4
        turns = [(side, arcs) for arcs in range(_ARCS) for side in (1.0, -1.0)]
        rates = np.zeros((len(turns), _ARCS + straight))
        for row, (side, arcs) in zip(rates, turns, strict=True):
            row[:arcs] = side * vehicle.turn_rate
        poses = drive(pose, rates, vehicle.speed, step)
        left = np.stack((-np.sin(poses[..., 2]), np.cos(poses[..., 2])), axis=-1)
        middles = poses[..., :2] + vehicle.radius * left
        safe = self.distance(middles) > vehicle.radius + vehicle.margin
        inside = self.distance(poses[..., :2]) <= vehicle.margin
        over = np.argmax(safe, axis=1)  # the first step after which it may circle
        over[~safe.any(axis=1)] = rates.shape[1] - 1
        seconds = np.array([row[: k + 1].sum() for row, k in zip(inside, over, strict=True)])
        best = int(np.lexsort((over, seconds))[0])
        return rates[best, : over[best] + 1], step

    def _across(self, pose: Floats) -> float:
        """Return how far it is at most to beyond all areas that a place is in, or near [m]."""
        boxes = np.array([area.box for area in self.areas])
        low, high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
        return float(np.hypot(*(np.maximum(high, pose[:2]) - np.minimum(low, pose[:2]))))

    @cached_property
    def corners(self) -> Floats:
        """``(N, 2)`` all corners [m]."""
        return np.array([corner for area in self.areas for corner in area.corners]).reshape(-1, 2)

    def round(self, here: Floats, there: Floats, room: float) -> list[Floats]:
        """Return the places of the shortest way of straight lines that keeps about so far out [m].

        None: there is no way. It leads by points beside the areas' corners, ``2 room`` away from each.
        """
        turns = np.linspace(0.0, 2.0 * math.pi, 8, endpoint=False)
        ring = 2.0 * room * np.column_stack((np.cos(turns), np.sin(turns)))
        beside = (self.corners[:, None] + ring).reshape(-1, 2)
        beside = beside[self.distance(beside) > room] if len(beside) else beside
        nodes = np.vstack((here, there, beside))
        far = np.full(len(nodes), math.inf)
        far[0], before, done = 0.0, np.full(len(nodes), -1), np.zeros(len(nodes), np.bool_)
        while not done.all():
            left = np.where(done, math.inf, far)
            k = int(np.argmin(left))
            if not math.isfinite(left[k]) or k == 1:
                break
            done[k] = True
            for j in np.flatnonzero(~done).tolist():
                way = far[k] + float(np.hypot(*(nodes[j] - nodes[k])))
                if way < far[j] and self._sees(nodes[k], nodes[j], room):
                    far[j], before[j] = way, k
        if before[1] < 0:
            return []
        path = [1]
        while path[-1] != 0:
            path.append(int(before[path[-1]]))
        return [nodes[k] for k in path[::-1]]

    def _sees(self, a: Floats, b: Floats, room: float) -> bool:
        """Tell whether a straight line keeps so far out [m]."""
        if not self.areas:
            return True
        count = max(2, math.ceil(float(np.hypot(*(b - a))) / room) + 1)
        return bool((self.distance(np.linspace(a, b, count)) > 0.5 * room).all())


NOWHERE = Forbidden()


def steered(pose: Floats, places: list[Floats], vehicle: Turning) -> tuple[Floats, float] | None:
    """Return turn rates ``(K,)`` that lead by places, and for how long each is held [s]; None: they do not.

    Towards each as fast as it turns, then straight on; away from one within the circles to its left or right.
    """
    step = _ARC / vehicle.turn_rate
    near = max(0.5 * vehicle.speed * step, 1e-6)
    rates: list[float] = []
    left = list(places)
    here = np.asarray(pose, np.float64)
    while left and len(rates) < _MOST_STEPS:
        away = left[0] - here[:2]
        if np.hypot(*away) <= near:
            left.pop(0)
            continue
        heading = float(here[2])
        sideways = np.array([-math.sin(heading), math.cos(heading)])
        turn = (math.atan2(away[1], away[0]) - heading + math.pi) % (2.0 * math.pi) - math.pi
        middle = math.copysign(vehicle.radius, turn) * sideways
        within = np.hypot(*(away - middle)) < vehicle.radius * (1.0 - 1e-9)
        rate = 0.0 if within else max(-vehicle.turn_rate, min(vehicle.turn_rate, turn / step))
        rates.append(rate)
        here = drive(here, [rate], vehicle.speed, step)[0]
    return None if left else (np.array(rates), step)
