"""Watches how simulated robots find each other's frames: it knows the truth, they do not."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field
from itertools import combinations
from typing import cast

import numpy as np

from vedette.align import FramePose
from vedette.maps.transform import Transform
from vedette.missions.explore.frames.exploring import FramedExploring
from vedette.record.explore.frames import FrameJoin, FramesFound
from vedette.sim.explore.simulation import ExploreSimulation
from vedette.sim.framed import FramedRobots


@dataclass
class FrameWatch:
    """What has been seen of a team's joins up to now."""

    simulation: ExploreSimulation
    _joined: set[tuple[int, int]] = field(default_factory=set)
    _joins: list[FrameJoin] = field(default_factory=list)
    _undone: int = 0

    def look(self) -> FramesFound | None:
        """Return what has come of it by now, as the first living robot sees it; None: all share a frame."""
        robots, living = self.simulation.robots, self.simulation.living
        if not isinstance(robots, FramedRobots) or not living:
            return None
        names = [spec.name for spec in self.simulation.specs]
        missions = [cast(FramedExploring, mission) for mission in self.simulation.missions]
        frames = missions[living[0]].frames
        latest = {key[0]: placed for key, placed in sorted(frames.graph.items())}
        now = {(i, j) for i, j in combinations(sorted(latest), 2) if latest[i].anchor == latest[j].anchor}
        for i, j in sorted(now - self._joined):
            there = latest[i].there.inverse().after(latest[j].there)
            error = _error(robots, i, j, there)
            self._joins.append(FrameJoin(self.simulation.now, (names[i], names[j]), *error))
        self._undone += len(self._joined - now)
        self._joined = now
        refused = sum((mission.matcher.refused for mission in missions), Counter[str]())
        parts: dict[object, list[str]] = {}
        for i in living:
            parts.setdefault(latest[i].anchor if i in latest else i, []).append(names[i])
        return FramesFound(
            tuple(self._joins), self._undone, dict(sorted(refused.items())), tuple(map(tuple, parts.values()))
        )


def _error(robots: FramedRobots, i: int, j: int, there: Transform) -> tuple[float, float]:
    """Return how far from the truth the second one's frame is taken to lie, where it is now [m, deg]."""
    true = robots.frames[i].inverse().after(robots.frames[j])
    x, y, heading = robots.pose(j)
    at = robots.frames[j].inverse().after(FramePose(x, y, heading))
    (found, right) = np.array((there.place(at.x, at.y), true.places(np.array([[at.x, at.y]]))[0]))
    turn = (true.angle - there.radians + math.pi) % math.tau - math.pi
    return float(np.hypot(*(found - right))), abs(math.degrees(turn))
