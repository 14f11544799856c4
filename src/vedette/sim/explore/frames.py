"""Watches how simulated robots find each other's frames: it knows the truth, they do not."""

from __future__ import annotations

from collections import Counter
from typing import cast

from vedette.missions.explore.frames.exploring import FramedExploring
from vedette.record.explore.frames import FramesFound
from vedette.record.explore.joins import Joined, JoinWatch, TrueFrame
from vedette.sim.explore.simulation import ExploreSimulation
from vedette.sim.framed import FramedRobots


class FrameWatch:
    """What has been seen of a simulated team's joins up to now."""

    def __init__(self, simulation: ExploreSimulation) -> None:
        self.simulation = simulation
        self._joins = JoinWatch([spec.name for spec in simulation.specs])

    def look(self) -> FramesFound | None:
        """Return what has come of it by now, as the first living robot sees it; None: all share a frame."""
        robots, living = self.simulation.robots, self.simulation.living
        if not isinstance(robots, FramedRobots) or not living:
            return None
        missions = [cast(FramedExploring, mission) for mission in self.simulation.missions]
        graph = missions[living[0]].frames.graph
        latest = {key[0]: Joined(key[1], *placed) for key, placed in sorted(graph.items())}
        true = [TrueFrame(frame, robots.pose(i)[:2]) for i, frame in enumerate(robots.frames)]
        refused = sum((mission.matcher.refused for mission in missions), Counter[str]())
        return self._joins.look(self.simulation.now, latest, true, living, refused)
