"""The figures of an exploration: ``summary.json``, in simulated time only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from vedette.domains.mapping.leftovers import Why
from vedette.missions.explore.expected import Expected
from vedette.record.explore.frames import FramesFound
from vedette.record.summary import MissionSummary, Traffic


@dataclass(frozen=True)
class LeftOut:
    """A frontier that a robot left, where the map is still unknown."""

    x: float  # [m], team frame
    y: float
    unknown_cells: int  # near it
    why: Why  # ``vedette.domains.mapping.leftovers``
    by: str  # the robot


@dataclass(frozen=True, kw_only=True)
class ExploreSummary(MissionSummary):
    """What one mission achieved, in simulated time only; the fields are explained in ``docs/outputs.md``."""

    robots: int
    planner: str
    scheme: str
    fusion: str
    world: str
    radio: str | None
    faults: str | None
    time_s: float
    t50_s: float | None
    t90_s: float | None
    t95_s: float | None
    t99_s: float | None
    auc_s: float | None
    coverage: float | None  # like the times above and the area over it None where nobody knows the ground
    known_m2: float
    rate_m2_s: float
    frontiers: int | None
    beyond: int
    no_go_m2: float
    cut_off_m2: float
    turned_back: tuple[str, ...]
    map_errors: int
    map_error_share: float
    pose_error_m: Mapping[str, float] | None  # None where nobody knows where the robots truly were
    path_m: Mapping[str, float]
    overlap: float
    collisions: int
    min_clearance_m: float
    rounds: int
    sweeps: int
    bound_ratio: float | None
    apart_s: float
    messages: Mapping[str, Traffic]
    bytes: Mapping[str, Traffic]
    maps: tuple[tuple[str, ...], ...]  # who lives, by the map that they hold: of one group, all hold one
    left_out: tuple[LeftOut, ...]
    expected: Expected | None  # how it would have gone on; None: it ended by itself, or too early to say
    frames: FramesFound | None = None  # None: all share one frame
