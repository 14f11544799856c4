"""What an agent knows of its team-mates' motion, from their beacons."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import msgspec
import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from vedette.agent.holdups import HoldUps
from vedette.agent.messages import Beacon
from vedette.maps.transform import Transform

MOST_MATES = 1024  # that are kept at most; each has a path of at most 500 points
MOST_UNPROVED = 24  # beacons after one that is known to be its robot's, that are believed without proof
ASIDE = 0.5  # and so far from there, beside what the robot can have driven [m]
Proved = tuple[tuple[int, int], float, float, float]  # boot and sequence, x, y [m], when it came [s]
OFTEN = 0.25  # beacons come [s]
PROVES = 5.0  # for so long what is known to be its robot's vouches for others [s]
SILENT = 3.0  # a mate not heard for so long stands where it was last [s]


class Mate(msgspec.Struct, frozen=True, eq=False):
    """A team-mate as it last beaconed; a large team makes thousands a second."""

    robot: int
    x: float  # [m], team frame
    y: float
    heading: float  # [rad]
    ahead: tuple[int, ...]  # x, y, x, y, ...: its next few metres, from where it is [cm]; empty: it stands
    slowed: float  # [s]
    radius: float  # [m]
    speed: float  # at most [m/s]
    heard: float  # when the beacon came [s]
    boot: int = 0  # of its start

    @property
    def path(self) -> NDArray[np.float64]:
        """``(L, 2)`` its next few metres [m], team frame; empty: it stands."""
        offsets = np.array(self.ahead[: len(self.ahead) // 2 * 2], np.float64).reshape(-1, 2) / 100.0
        path: NDArray[np.float64] = offsets + np.array((self.x, self.y))
        return path

    def seen_from(self, there: Transform) -> Mate:
        """Return the mate as it lies in another frame, where its own lies so."""
        x, y = there.place(self.x, self.y)
        ends = there.places(self.path) - (x, y)
        ahead = tuple(np.rint(100.0 * ends).astype(int).ravel().tolist())
        return structs.replace(self, x=x, y=y, heading=self.heading + there.radians, ahead=ahead)

    def silent(self, now: float) -> bool:
        """Tell whether the mate may be dead: it has not been heard for seconds."""
        return now - self.heard > SILENT


@dataclass
class Mates:
    """The newest beacon of every team-mate."""

    admitted: int = MOST_MATES  # robots of the team are numbered below it
    framed: Callable[[int], Transform | None] | None = None  # where a robot's frame lies; None: all share one
    holdups: HoldUps = field(default_factory=HoldUps)
    _newest: dict[int, tuple[int, int]] = field(default_factory=dict)  # boot and sequence
    _mates: dict[int, Mate] = field(default_factory=dict)
    _proved: dict[int, Proved] = field(default_factory=dict)

    def hear(
        self, beacon: Beacon, now: float, sender: int, *, signed: bool = False, passed_on: bool = False
    ) -> bool:
        """Keep a beacon; tell whether it is news.

        Of what comes from itself, or when it has been silent, a mate's beacon is news whatever its number:
        who passes beacons on could have said higher ones. Not if it is signed: nobody could, but old ones
        might be said again. ``passed_on``: it was likely, and proves nothing.

        Raises:
            ValueError: of a robot that the team cannot have.
        """
        known = self._mates.get(beacon.robot)
        if beacon.robot >= self.admitted or (known is None and len(self._mates) == MOST_MATES):
            raise ValueError(f"beacon of robot {beacon.robot}: the team has no such robot")
        stamp, newest = (beacon.boot, beacon.sequence), self._newest.get(beacon.robot, (-1, -1))
        unproved = (known is None or known.silent(now)) and not (signed or passed_on)
        believed = beacon.robot == sender or unproved
        if signed and beacon.robot != sender:
            newest = self._proved.get(beacon.robot, (newest, 0.0, 0.0, 0.0))[0]
        if newest == stamp or (newest > stamp and not believed):
            return False
        self._newest[beacon.robot] = stamp
        mate = self._mates[beacon.robot] = _mate(beacon, now)
        self.holdups.note(beacon.robot, mate.x, mate.y, mate.slowed, sender, now)
        if not passed_on:
            self._proved[beacon.robot] = stamp, beacon.x / 100.0, beacon.y / 100.0, now
        return True

    def is_likely(self, beacon: Beacon, now: float) -> bool:
        """Tell whether a beacon agrees with the last that its robot is known to have said, not long ago."""
        if beacon.robot not in self._proved:
            return False
        (boot, sequence), x, y, said = self._proved[beacon.robot]
        known, seconds = self._mates.get(beacon.robot), now - said
        moved = max(seconds, OFTEN * (beacon.sequence - sequence)) + 1.0  # what was signed came late, perhaps
        away = float(np.hypot(beacon.x / 100.0 - x, beacon.y / 100.0 - y))
        follows = beacon.boot == boot and sequence < beacon.sequence <= sequence + MOST_UNPROVED
        speed = 0.0 if known is None else known.speed
        return follows and seconds <= PROVES and away <= ASIDE + speed * moved

    def is_new(self, robot: int, stamp: tuple[int, int], now: float) -> bool:
        """Tell whether a beacon, by boot and sequence, is one of the last few of a mate that is heard."""
        known, (boot, sequence) = self._mates.get(robot), self._newest.get(robot, (-1, -1))
        lately = boot == stamp[0] and abs(sequence - stamp[1]) <= MOST_UNPROVED
        return known is not None and not known.silent(now) and lately

    def prove(self, robot: int, stamp: tuple[int, int], x: float, y: float, now: float) -> None:
        """Note where a robot has signed to be [m], by which beacon: boot and sequence."""
        if robot < self.admitted and stamp > self._proved.get(robot, ((-1, -1), 0.0, 0.0, 0.0))[0]:
            self._proved[robot] = stamp, x, y, now

    def anybody_moves(self) -> bool:
        """Tell whether any mate was on its way when last heard."""
        return any(len(mate.path) > 1 for mate in self._mates.values())

    @property
    def heard(self) -> list[Mate]:
        """All team-mates ever heard, by id, each in the frame that it reckons in."""
        return [mate for _, mate in sorted(self._mates.items())]

    def all(self) -> list[Mate]:
        """Return all team-mates ever heard, by id; not those of whose frame it is not known where it lies."""
        if self.framed is None:
            return self.heard
        placed = ((mate, self.framed(mate.robot)) for mate in self.heard)
        return [mate.seen_from(there) for mate, there in placed if there is not None]


def _mate(beacon: Beacon, heard: float) -> Mate:
    return Mate(
        beacon.robot,
        beacon.x / 100.0,
        beacon.y / 100.0,
        beacon.heading / 1000.0,
        beacon.path,
        beacon.slowed / 10.0,
        beacon.radius / 100.0,
        beacon.speed / 100.0,
        heard,
        beacon.boot,
    )
