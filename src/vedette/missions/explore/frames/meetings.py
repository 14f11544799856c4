"""Meetings: a robot sees a disc move as a mate's beacons say, and so knows where the mate's frame lies.

docs/align.md, section 6
"""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.agent.events import Pose
from vedette.agent.mates import Mate
from vedette.fusion.frame_edges import EdgeKind, FrameEdge
from vedette.fusion.link import Key
from vedette.maps.transform import Transform
from vedette.missions.explore.frames.graph import MOST_MET
from vedette.missions.explore.passers_by import Disc

LATELY = 10.0  # sightings and beacons count for so long [s]
EVERY = 1.0  # discs are compared with beacons [s]
HEARD = 0.6  # between two beacons, at most, where the mate is known in between [s]
ONE = 0.5  # a disc seen so near to where one was a scan ago is that one [m]
MISSED = 0.7  # between two sightings of one disc at most [s]
LEAST = 6  # sightings of a disc
OFF = 0.15  # a sighting farther from where the beacons say is of something else [m] ...
FOLLOWS = 0.8  # ... and this share has to be of the mate
BESIDE = 0.06  # root of the mean square of what is left, at most [m]
ERROR = 0.04  # of a sighting, at least [m]
ALIKE = 5.0  # sightings one after another that tell as much as one
CERTAIN = math.radians(1.0), 0.1  # deviations of a meeting's turn, and of its place, at most [rad, m]
SAME = 1.0, math.radians(6.0)  # two meetings with one mate that differ by more cannot both be [m, rad]
ARM = 5.0  # about the mate, up to which a meeting has to tell how its frame lies [m]
WALL = 10.0, 0.02  # walls in common, and the deviation that they leave [m]
JUMP = 0.05  # farther than it drives a robot comes only by its SLAM, which puts it right [m]
UNCERTAIN = 0.3  # a meeting whose place deviates more is taken back [m]

Floats = NDArray[np.float64]
Pair = tuple[Key, Key]


class Met(NamedTuple):
    """How a mate's frame lies in one's own by what was seen of it."""

    there: Transform  # T_own_mate
    deviation: float  # of a place `ARM` from where they met [m]

    @property
    def weight(self) -> int:
        """As much wall in common as leaves the same deviation, (V210) [cm]."""
        return _weight(self.deviation)


_Fits = tuple[Key, int, Met]  # whose beacons follow which disc


@dataclass
class _Seen:
    """A disc, followed from scan to scan in the robot's own frame."""

    times: list[float]
    places: list[tuple[float, float]]


@dataclass
class Meetings:
    """One robot's meetings with mates whose frames are unknown."""

    own: Key
    found: dict[Pair, FrameEdge] = field(default_factory=dict)
    refused: Counter[str] = field(default_factory=Counter)  # by why
    _discs: list[_Seen] = field(default_factory=list)
    _heard: dict[Key, deque[tuple[float, float, float]]] = field(default_factory=dict)  # when, x, y
    _due: float = 0.0
    _deviations: dict[Pair, float] = field(default_factory=dict)  # of what has been found [m]
    _stood: tuple[float, float, float] | None = None  # x, y [m], and when [s]

    def stand(self, pose: Pose, speed: float, now: float) -> None:
        """Take in where the robot takes itself to be, which drives at such a speed at most [m/s].

        Where it has moved farther than it drives, its frame has been put right under the meetings: by how
        much where they were nobody knows, so they are as much less certain, and in the end taken back.
        """
        (x, y, since), self._stood = self._stood or (pose.x, pose.y, now), (pose.x, pose.y, now)
        shift = math.dist((x, y), (pose.x, pose.y)) - speed * (now - since) - 2.0 * pose.deviation
        if shift <= JUMP:
            return
        self._discs.clear()
        for pair, edge in list(self.found.items()):
            self._deviations[pair] += shift
            if self._deviations[pair] > UNCERTAIN:
                del self.found[pair], self._deviations[pair]
                self.refused["put right since"] += 1
            else:
                self.found[pair] = edge._replace(weight=_weight(self._deviations[pair]))

    def see(self, discs: Iterable[Disc], now: float) -> None:
        """Note where discs that may move are now, own frame."""
        self._discs = [one for one in self._discs if one.times[-1] >= now - LATELY]
        going_on = [one for one in self._discs if now - MISSED <= one.times[-1] < now]
        for x, y, _ in discs:
            nearest = min(going_on, key=lambda one: math.dist(one.places[-1], (x, y)), default=None)
            if nearest is None or math.dist(nearest.places[-1], (x, y)) > ONE:
                self._discs.append(_Seen([now], [(x, y)]))
            else:
                nearest.times.append(now)
                nearest.places.append((x, y))
                going_on.remove(nearest)

    def hear(self, mates: Iterable[Mate]) -> None:
        """Note where mates say that they are, each in its own frame."""
        for mate in mates:
            said = self._heard.setdefault((mate.robot, mate.boot), deque())
            if not said or mate.heard > said[-1][0]:
                said.append((mate.heard, mate.x, mate.y))
            while said[0][0] < mate.heard - LATELY:
                said.popleft()

    def compare(self, unplaced: Collection[Key], now: float) -> None:
        """Tell who has been met lately of those whose frames are unknown, if it is time to look.

        Others count as rivals: who is known to be somewhere has been seen there, whoever says the same way.
        """
        if now < self._due:
            return
        self._due = now + EVERY
        fits: list[_Fits] = []
        for key, said in sorted(self._heard.items()):
            track = np.array(said)
            for number, disc in enumerate(self._discs):
                met = _met(track, disc, now)
                if met is not None:
                    fits.append((key, number, met))
        for key, number, met in fits:
            if key not in unplaced:
                continue
            if any(_rivals((key, number, met), other) for other in fits):
                self.refused["several might have been met"] += 1
            else:
                self._take(key, met)

    def _take(self, key: Key, met: Met) -> None:
        """Believe a meeting that tells more than the last with that mate."""
        pair = self.own, key
        known = self.found.get(pair)
        if known is None or met.weight > known.weight:
            self._deviations[pair] = met.deviation
            self.found[pair] = FrameEdge(*pair, met.there, met.weight, EdgeKind.MEETING)


def _weight(deviation: float) -> int:
    """Return the walls in common [cm] that leave a deviation [m]."""
    walls, leaves = WALL
    return max(1, min(MOST_MET, round(100.0 * walls * (leaves / deviation) ** 2)))


def _rivals(one: _Fits, other: _Fits) -> bool:
    """Tell whether two cannot both be: of one disc two mates, or of one mate two frames."""
    (key, number, met), (of, disc, there) = one, other
    if key != of:
        return number == disc
    shift, turn = met.there.apart(there.there, 0.0, 0.0)
    return shift > SAME[0] or turn > SAME[1]


def _met(track: Floats, disc: _Seen, now: float) -> Met | None:
    """Return how a mate's frame lies if it is what was seen; None: it is not, or that tells too little."""
    times, places = np.array(disc.times), np.array(disc.places)
    lately = times >= now - LATELY
    times, places = times[lately], places[lately]
    after = np.searchsorted(track[:, 0], times)
    between = (after > 0) & (after < len(track))
    between[between] = np.diff(track[:, 0])[after[between] - 1] <= HEARD
    if np.count_nonzero(between) < LEAST:
        return None
    times, places = times[between], places[between]
    said = np.column_stack([np.interp(times, track[:, 0], track[:, axis]) for axis in (1, 2)])
    there, off = _laid(said, places)
    kept = off <= max(OFF, float(np.median(off)))
    if np.count_nonzero(kept) < max(LEAST, FOLLOWS * len(kept)):
        return None
    there, off = _laid(said[kept], places[kept])
    error = float(np.sqrt(np.mean(off**2)))
    told = np.count_nonzero(kept) / ALIKE
    spread = float(np.sqrt(np.mean(np.sum((said[kept] - said[kept].mean(axis=0)) ** 2, axis=1))))
    place = max(error, ERROR) / math.sqrt(told)
    turn = place / spread if spread > 0.0 else math.inf
    if error > BESIDE or off.max() > OFF or turn > CERTAIN[0] or place > CERTAIN[1]:
        return None
    return Met(there, math.hypot(place, ARM * turn))


def _laid(said: Floats, seen: Floats) -> tuple[Transform, Floats]:
    """Return the motion of least squares that takes places ``(n, 2)`` to others; and what is left [m]."""
    middle, onto = said.mean(axis=0), seen.mean(axis=0)
    a, b = said - middle, seen - onto
    angle = math.atan2(float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])), float(np.sum(a * b)))
    cos, sin = math.cos(angle), math.sin(angle)
    rotation = np.array([[cos, -sin], [sin, cos]])
    x, y = (onto - rotation @ middle).tolist()
    return Transform.of(x, y, angle), np.hypot(*(a @ rotation.T - b).T)
