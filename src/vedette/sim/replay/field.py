"""Robots that have been where a log says, and see what it says; ``vedette.sim.field.Field``."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Motion
from vedette.agent.events import Event, Pose, Scan, Sensed
from vedette.align import FramePose
from vedette.logs import RecordedMap, RecordedScan, Sight
from vedette.logs.recorded import place_of
from vedette.missions.explore.own_map import OwnMap
from vedette.outcome import Outcome
from vedette.sim.worlds.logged import beams


class RecordedRobots:
    """A robot for each share of a log: all begin at once, and stand when theirs is over."""

    def __init__(
        self,
        shares: Sequence[Sequence[Sight]],
        reach: float,
        no_return: str,
        frames: Sequence[FramePose] | None = None,
    ) -> None:
        """Take shares of at least one sight each; ``reach`` [m] and ``no_return`` as for `logged`.

        ``frames``: T_log_own, where each robot's frame lies in the log's; None: all are the log's.
        """
        self.shares = shares
        self._own = shares if frames is None else [
            [in_frame(sight, frame.inverse()) for sight in share]
            for share, frame in zip(shares, frames, strict=True)
        ]  # fmt: skip
        self._times = [[sight.time - share[0].time for sight in share] for share in shares]
        self._told = [0] * len(shares)  # sights
        self._reach, self._no_return = reach, no_return
        self._alive: NDArray[np.bool_] = np.ones(len(shares), np.bool_)

    @property
    def duration(self) -> float:
        """Until the longest share is over [s]."""
        return max(times[-1] for times in self._times)

    @property
    def told(self) -> int:
        """How many sights the team has been told by now."""
        return sum(self._told)

    @property
    def alive(self) -> NDArray[np.bool_]:
        """``(n,)``."""
        return self._alive

    def pose(self, i: int) -> tuple[float, float, float]:
        """Return x, y [m] and heading [rad] of a robot, frame of the log; its map's, if none was told."""
        return self._place(i, self.shares)

    def _place(self, i: int, shares: Sequence[Sequence[Sight]]) -> tuple[float, float, float]:
        sight = shares[i][max(self._told[i], 1) - 1]
        place = place_of(sight)
        if place is None:
            assert isinstance(sight, RecordedMap), "scans have places"
            return (*sight.middle, 0.0)
        return place

    def sense(self, i: int, now: float) -> list[Event]:
        """Return a robot's poses and sights up to now that it has not been told yet, in its own frame."""
        until = bisect_right(self._times[i], now + 1e-9)
        events: list[Event] = [Pose(*self._place(i, self._own))]
        for sight in self._own[i][self._told[i] : until]:
            if isinstance(sight, RecordedMap):
                events.append(Sensed(OwnMap(sight.classes, sight.resolution, *sight.corner), now))
            else:
                events += Pose(sight.x, sight.y, sight.heading), self._scan(sight)
        self._told[i] = until
        return events

    def _scan(self, scan: RecordedScan) -> Scan:
        ranges, hits = beams(scan, self._reach, self._no_return)
        said = ranges > 0.0
        return Scan(scan.angles[said], np.where(hits, ranges, np.inf)[said])

    def carry_out(self, i: int, motion: Motion, now: float) -> None:
        """Go where the log says, whatever the agent wants."""

    def advance(self, now: float, dt: float) -> None:
        """Nothing moves between scans."""

    def kill(self, i: int) -> None:
        """Let a robot be told nothing any more."""
        self._alive[i] = False

    def revive(self, i: int, now: float) -> None:
        """Let a robot go on."""
        self._alive[i] = True

    def over(self, now: float) -> Outcome | None:
        """It is not the world that ends a replay."""
        return None


def in_frame(sight: Sight, there: FramePose) -> Sight:
    """Return what was seen, told in another frame: ``there`` is T_other_log."""
    place = place_of(sight)
    moved = None if place is None else _moved(there, place)
    if isinstance(sight, RecordedMap):
        return replace(sight, corner=_moved(there, sight.corner), pose=moved)
    assert moved is not None, "scans have places"
    x, y, heading = moved
    return replace(sight, x=x, y=y, heading=heading, angles=sight.angles + there.angle)


def _moved(there: FramePose, place: tuple[float, float, float]) -> tuple[float, float, float]:
    moved = there.after(FramePose.of(*place))
    return moved.x, moved.y, moved.angle
