"""Watches how robots find each other's frames in simulation: it knows the truth, they do not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import cast

from vedette.align import FramePose
from vedette.missions.explore.frames.exploring import FramedExploring
from vedette.record.explore.frames import FramesFound
from vedette.record.explore.joins import JoinWatch, TrueFrame, Whereabouts
from vedette.sim.simulation import Simulation


class FrameWatch:
    """What has been seen of a simulated team's joins up to now."""

    def __init__(self, simulation: Simulation, names: Sequence[str], frames: Sequence[FramePose]) -> None:
        """Watch robots of these names, whose frames lie so in the world, T_world_own."""
        self.simulation, self._frames = simulation, frames
        self._joins = JoinWatch(names)

    def look(self, *, last: bool = False) -> FramesFound | None:
        """Return what has come of it by now, as the first living robot sees it; None: nobody lives.

        ``last``: of walls, too, which takes a while.
        """
        simulation, living = self.simulation, self.simulation.living
        if not living:
            return None
        missions = [cast(FramedExploring, agent.mission) for agent in simulation.agents]
        first = missions[living[0]].frames
        graph = first.graph
        latest = {key[0]: Whereabouts(key[1], *placed) for key, placed in sorted(graph.items())}
        true = [TrueFrame(frame, simulation.pose(i)[:2]) for i, frame in enumerate(self._frames)]
        refused = sum((mission.refused for mission in missions), Counter[str]())
        walls = first.walls_apart() if last else None
        return self._joins.look(simulation.now, latest, true, living, refused, walls)
