"""What a vehicle can do: turn rates over the horizon, and where it means to search afterwards."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.vehicle import drive, turn_sequences


@dataclass(frozen=True, eq=False)
class Flight:
    """A strategy: turn rates held for a step each, then a turn towards the goal and straight on to it."""

    step: int  # from which on, number of steps since the mission began
    turn_rates: NDArray[np.float64]  # (K,) [rad/s]
    goal: tuple[float, float] | None = None  # where to search after the horizon [m], team frame

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Flight) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    @property
    def _key(self) -> Hashable:
        return self.step, self.turn_rates.tobytes(), self.goal


@dataclass(frozen=True, eq=False)
class Branches:
    """Distinct beginnings of flights: node n follows its parent by one step and is listed after it."""

    parents: NDArray[np.int64]  # (N,) -1 in the first step
    turn_rates: NDArray[np.float64]  # (N,) [rad/s]
    ends: NDArray[np.int64]  # (C,) the last node of each flight


def held_sequences(turn_rate: float, horizon: int, controls: int, choices: int) -> NDArray[np.float64]:
    """Return every sequence of up to ``controls`` turn rates, each held about as long, ``(C, horizon)``.

    Where the horizon does not divide evenly the later ones are held longer.
    """
    parts = min(controls, horizon)
    held = np.full(parts, horizon // parts)
    held[parts - horizon % parts :] += 1
    return np.repeat(turn_sequences(turn_rate, parts, choices if turn_rate > 0.0 else 1), held, axis=1)


def branches(turn_rates: NDArray[np.float64]) -> Branches:
    """Merge what flights ``(C, K)`` begin with alike."""
    rates, which = np.unique(turn_rates, return_inverse=True)
    which = which.reshape(turn_rates.shape)
    at = np.full(len(turn_rates), -1)
    parents, chosen, count = [], [], 0
    for column in which.T:
        pairs, where = np.unique((at + 1) * len(rates) + column, return_inverse=True)
        parents.append(pairs // len(rates) - 1)
        chosen.append(pairs % len(rates))
        at = count + where
        count += len(pairs)
    return Branches(
        np.concatenate(parents).astype(np.int64), rates[np.concatenate(chosen)], at.astype(np.int64)
    )


def look_poses(
    tree: Branches, pose: NDArray[np.float64], speed: float, dt: float, looks: int
) -> NDArray[np.float64]:
    """Poses of the looks in each node's step, evenly spaced, the last at its end: ``(N, looks, 3)``."""
    poses = np.empty((len(tree.parents), looks, 3))
    done = 0
    while done < len(tree.parents):  # a layer at a time: its parents are done
        layer = slice(done, done + int(np.searchsorted(tree.parents[done:], done)))
        parents = tree.parents[layer]
        start = np.where(parents[:, None] < 0, pose, poses[np.maximum(parents, 0), -1])
        rates = np.repeat(tree.turn_rates[layer, None], looks, axis=1)
        poses[layer] = drive(start, rates, speed, dt / looks)
        done = layer.stop
    return poses


def steer(
    poses: NDArray[np.float64],
    goals: NDArray[np.float64],
    *,
    speed: float,
    turn_rate: float,
    dt: float,
    steps: int,
) -> NDArray[np.float64]:
    """Turn towards a goal as fast as can be, then go straight: turn rates ``(J, steps)`` [rad/s].

    Args:
        poses: ``(J, 3)`` [m, m, rad].
        goals: ``(J, 2)`` [m].
    """
    rates = np.empty((len(poses), steps))
    for k in range(steps):
        error = _turn(poses, goals)
        rates[:, k] = np.clip(error / dt, -turn_rate, turn_rate)
        poses = drive(poses, rates[:, k : k + 1], speed, dt)[:, 0]
    return rates


def time_to(
    poses: NDArray[np.float64], goals: NDArray[np.float64], radius: float, speed: float, turn_rate: float
) -> NDArray[np.float64]:
    """Time to turn and go straight to within ``radius`` [m] of each goal, ``(P, J)`` [s]; 0 where there."""
    away = goals - poses[:, None, :2]
    way = np.hypot(away[..., 0], away[..., 1]) - radius
    turn = np.abs(_turn(poses[:, None], goals))
    return np.where(way > 0.0, way / speed + turn / turn_rate, 0.0)


def _turn(poses: NDArray[np.float64], goals: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far to turn to face a goal, in [-pi, pi) [rad]."""
    away = goals - poses[..., :2]
    bearing = np.arctan2(away[..., 1], away[..., 0])
    return np.asarray((bearing - poses[..., 2] + np.pi) % (2.0 * np.pi) - np.pi)
