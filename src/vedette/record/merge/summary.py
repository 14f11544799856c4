"""What came of merging maps, as figures and as a file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from vedette.align.candidates import PossibleJoin
from vedette.align.joining import JoinedMaps
from vedette.align.pose import FramePose
from vedette.record.summary import Figures


@dataclass(frozen=True)
class Confidence:
    """What a map's place rests on: its match with one that was placed before it."""

    with_map: str
    same_m: float  # walls that both have
    common_m2: float  # ground that both know
    overlap: float  # its share of what the smaller knows
    contradicted: float  # share of the walls seen
    x_deviation_m: float
    y_deviation_m: float
    yaw_deviation_deg: float

    @classmethod
    def of(cls, candidate: PossibleJoin, other: str) -> Confidence:
        """Return what is told of a match."""
        x, y, turn = (math.sqrt(max(0.0, variance)) for variance in candidate.covariance.diagonal().tolist())
        return cls(
            other,
            candidate.same,
            candidate.common,
            candidate.overlap,
            candidate.contradicted,
            x,
            y,
            math.degrees(turn),
        )


@dataclass(frozen=True)
class PlacedMap:
    """Where one map lies in the first one's frame."""

    name: str
    x_m: float
    y_m: float
    yaw_deg: float
    confidence: Confidence | None  # None: it is the first

    @classmethod
    def of(cls, name: str, pose: FramePose, confidence: Confidence | None) -> PlacedMap:
        """Return what is told of a map."""
        return cls(name, pose.x, pose.y, math.degrees(pose.angle), confidence)


@dataclass(frozen=True, kw_only=True)
class MergeSummary(Figures):
    """``merge.json`` of ``vedette merge``."""

    maps: tuple[PlacedMap, ...]

    @classmethod
    def told(cls, names: Sequence[str], joined: JoinedMaps) -> MergeSummary:
        """Return the figures of maps that are all joined."""
        placed = []
        for number, (name, pose, match) in enumerate(zip(names, joined.poses, joined.tree, strict=True)):
            assert pose is not None
            confidence = None
            if match is not None:
                other = names[match.a if match.b == number else match.b]
                confidence = Confidence.of(match.candidate, other)
            placed.append(PlacedMap.of(name, pose, confidence))
        return cls(maps=tuple(placed))
