"""Sees from time to time who is joined with whom, and how far from the truth, which robots do not know."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Literal, NamedTuple

import numpy as np

from vedette.align import FramePose
from vedette.maps.transform import Transform
from vedette.record.explore.frames import FrameJoin, FramesFound

_Start = tuple[int, int]  # a robot and its boot


class Whereabouts(NamedTuple):
    """Where a robot's frame is taken to lie."""

    boot: int  # of the robot's start that is the latest: each has a frame of its own
    anchor: Hashable  # the same for all that are joined, and theirs alone
    there: Transform  # T_anchor_robot
    met: bool = False  # a meeting is among the edges between the two


class TrueFrame(NamedTuple):
    """Where a robot's frame lies, and the robot in the world."""

    frame: FramePose  # T_world_robot
    at: tuple[float, float]  # [m]


@dataclass
class JoinWatch:
    """What has been seen of a team's joins up to now."""

    names: Sequence[str]  # of robots, by index
    _joined: set[tuple[_Start, _Start]] = field(default_factory=set)
    _joins: list[FrameJoin] = field(default_factory=list)
    _undone: int = 0

    def look(
        self,
        now: float,
        graph: Mapping[int, Whereabouts],
        true: Sequence[TrueFrame],
        living: Sequence[int],
        refused: Mapping[str, int],
        walls: float | None = None,
    ) -> FramesFound:
        """Return what has come of it by now [s].

        Args:
            now: [s].
            graph: by robot, as one of the living sees it.
            true: by index.
            living: robots, increasing.
            refused: pairs of maps that were looked at and not believed, by why.
            walls: how far walls that two joined maps have in common lie apart, at most [m]; None: not known.
        """
        latest = [(robot, placed.boot) for robot, placed in sorted(graph.items())]
        joined = {
            (one, other)
            for one, other in combinations(latest, 2)
            if graph[one[0]].anchor == graph[other[0]].anchor
        }
        errors = {
            pair: _error(true[i], true[j], graph[i].there.inverse().after(graph[j].there))
            for pair in sorted(joined)
            for (i, _), (j, _) in (pair,)
        }
        for pair in sorted(joined - self._joined):
            (i, _), (j, _) = pair
            by: Literal["match", "meeting"] = "meeting" if graph[i].met or graph[j].met else "match"
            self._joins.append(FrameJoin(now, (self.names[i], self.names[j]), *errors[pair], by))
        self._undone += sum(one in latest and other in latest for one, other in self._joined - joined)
        self._joined = joined
        parts: dict[Hashable, list[str]] = {}
        for i in living:
            parts.setdefault(graph[i].anchor if i in graph else i, []).append(self.names[i])
        return FramesFound(
            tuple(self._joins),
            self._undone,
            dict(sorted(refused.items())),
            tuple(map(tuple, parts.values())),
            max((shift for shift, _ in errors.values()), default=None),
            max((turn for _, turn in errors.values()), default=None),
            walls,
        )


def _error(i: TrueFrame, j: TrueFrame, there: Transform) -> tuple[float, float]:
    """Return how far from the truth the second one's frame is taken to lie, where it is now [m, deg]."""
    true = i.frame.inverse().after(j.frame)
    own = j.frame.inverse().places(np.array([j.at]))
    turn = (true.angle - there.radians + math.pi) % math.tau - math.pi
    return math.dist(there.places(own)[0], true.places(own)[0]), abs(math.degrees(turn))
