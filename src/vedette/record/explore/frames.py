"""How robots that share no frame have found each other's, measured against the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class FrameJoin:
    """Two robots' maps have been joined."""

    time_s: float
    robots: tuple[str, str]
    error_m: float  # of where the second one's frame lies in the first one's, at the second robot's place
    error_deg: float


@dataclass(frozen=True)
class FramesFound:
    """What has come of looking for frames by some time."""

    joins: tuple[FrameJoin, ...]  # in order of time; one that was undone and made again counts twice
    undone: int  # joins that were taken back
    refused: Mapping[str, int]  # by why: pairs of maps that were looked at, and not believed
    components: tuple[tuple[str, ...], ...]  # living robots that are joined, by name

    @property
    def told(self) -> str:
        """Who is joined, for people."""
        return " | ".join(
            "+".join(name.removeprefix("robot-") for name in names) for names in self.components
        )
