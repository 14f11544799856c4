"""What robots of a log make of it: they see what was recorded, and go where the log went."""

from __future__ import annotations

from collections.abc import Sequence

from vedette.agent.events import Pose, Scan, Sensed
from vedette.agent.mates import Mate
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.frames.exploring import FramedExploring


class Following(Exploring):
    """Sees what was recorded: no mate was in those scans, and the mission ends with the log."""

    def observe(self, seen: Scan | Sensed, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Add a scan, or take over a map, whoever is said to stand where now."""
        super().observe(seen, pose, (), now)

    def nothing_left(self, value: float, now: float) -> bool:
        """Tell that there is more, to the end."""
        return False


class FramedFollowing(Following, FramedExploring):
    """Does so in a frame of its own, where no mate has to be told from a wall."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.own.passers_by = None

    def meet(self, mates: Sequence[Mate], now: float) -> None:
        """Meet nobody: shares are of one robot, at different times."""
