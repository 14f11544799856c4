"""How robots that share no frame have found each other's, measured against the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class FrameJoin:
    """Two robots' maps have been joined."""

    time_s: float
    robots: tuple[str, str]
    error_m: float  # of where the second one's frame lies in the first one's, at the second robot's place
    error_deg: float
    by: Literal["match", "meeting"]  # of their maps alone; or robots have met, these two or some between them


@dataclass(frozen=True)
class FramesFound:
    """What has come of looking for frames by some time."""

    joins: tuple[FrameJoin, ...]  # in order of time; one that was undone and made again counts twice
    undone: int  # joins that were taken back
    refused: Mapping[str, int]  # by why: pairs of maps that were looked at, and not believed
    components: tuple[tuple[str, ...], ...]  # living robots that are joined, by name
    error_m: float | None  # the largest of those who are joined now; None: nobody is
    error_deg: float | None
    walls_m: float | None = None  # between walls that two joined maps have in common, at most; None: none has

    @property
    def said(self) -> str:
        """Who is joined in the end, and how well, for people; nothing where there is one robot."""
        if all(len(names) == 1 for names in self.components):
            return "" if len(self.components) == 1 else "nobody joined"
        off = "" if self.error_m is None else f", {self.error_m:.2f} m off at most"
        walls = "" if self.walls_m is None else f", walls {self.walls_m:.2f} m apart"
        return f"joined: {self.told}{off}{walls}"

    @property
    def joined_after(self) -> str:
        """When maps were joined, to go on after what the picture is of."""
        if not self.joins:
            return ", no maps joined"
        times = dict.fromkeys(f"{join.time_s:.0f} s" for join in self.joins)
        return f", maps joined after {', '.join(times)}"

    @property
    def told(self) -> str:
        """Who is joined, for people."""
        return " | ".join(
            "+".join(name.removeprefix("robot-") for name in names) for names in self.components
        )
