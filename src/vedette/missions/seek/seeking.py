"""One robot's share of looking for somebody in a building that nobody knows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import cast

import numpy as np
from numpy.typing import NDArray

from vedette.agent.events import Pose, Scan, Sensed
from vedette.agent.mates import Mate
from vedette.domains.mapping import impact as mapping
from vedette.domains.mapping.belief import planning_factor
from vedette.domains.mapping.impact import MapImpactCodec
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.sightings import BINS, ROWS
from vedette.domains.mapping.views import MOST_STOPS
from vedette.domains.search.detectors import Report
from vedette.domains.search.evidence import LEVELS_PER_NAT
from vedette.domains.search.objective import SearchObjective
from vedette.kernels.coverage import LAYERS
from vedette.kernels.misses import MissesCodec, SparseMisses
from vedette.maps import FREE
from vedette.missions.explore.exploring import Exploring
from vedette.missions.seek.looks import Looker, entropy_of, levels, room_for_somebody, search_belief
from vedette.missions.seek.options import SeekOptions
from vedette.missions.seek.platform import LOOKED_AT, Belief, Impact, SeekingPlatform
from vedette.missions.seek.spots import MOST_SPOTS
from vedette.problem.mixed import PartsCodec, WeightedSum
from vedette.team import Most


@dataclass(frozen=True)
class Glimpse:
    """What a robot tells when it has looked for somebody."""

    place: Report  # of whom it sees [m]; None: nobody


@dataclass(eq=False)
class Seeking(Exploring):
    """Explores, and looks for somebody; ``vedette.agent.mission.GroundMission``.

    The team adds up, for each planning cell, how surely somebody there would have been seen.
    """

    seek: SeekOptions = field(default_factory=SeekOptions)
    found: tuple[float, float] | None = None  # where this robot has seen somebody [m]
    _looked: NDArray[np.int64] = field(init=False)  # (N,) own log-misses of planning cells [1/1024 nat]

    def __post_init__(self) -> None:
        super().__post_init__()
        size = self.planning.size
        self._looked = np.zeros(size, np.int64)
        worth = self.seek.worth * entropy_of(self.frame)
        self.objective = WeightedSum((MappingObjective(), SearchObjective()), (1.0, worth))
        self.codec = PartsCodec((MapImpactCodec(size), MissesCodec(size, LAYERS)))
        platform = self._seeker
        platform.seek, platform.worth = self.seek, worth

    @property
    def _seeker(self) -> SeekingPlatform:
        return cast(SeekingPlatform, self.platform)

    # -- evidence -----------------------------------------------------------------------------------

    def observe(self, seen: Scan | Sensed, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Take in a scan, or what a look for somebody showed."""
        if isinstance(seen, Sensed) and isinstance(seen.data, Glimpse):
            if seen.data.place is None:
                self._note_nobody(pose)
            else:
                self.found = seen.data.place
        else:
            super().observe(seen, pose, mates, now)

    def _note_nobody(self, pose: Pose) -> None:
        """Note in which cells somebody would have been seen, by what the team knows of the walls."""
        factor, row_col = planning_factor(self.frame.resolution), self.frame.cell(pose.x, pose.y)
        away = (int(self.seek.reach / self.frame.resolution) // factor + 1) * factor
        rows, cols = (
            slice(max(0, at // factor * factor - away), min(size, at // factor * factor + away + factor))
            for at, size in zip(row_col, self.frame.shape, strict=True)
        )
        looker = Looker(self.fusion.classes.window(rows, cols), self.frame.resolution, self.seek.reach)
        row, col = row_col[0] - rows.start, row_col[1] - cols.start
        if not (0 <= row < looker.classes.shape[0] and 0 <= col < looker.classes.shape[1]):
            return
        if looker.classes[row, col] != FREE:
            return
        seen = looker.seen(row * looker.classes.shape[1] + col)
        tops, lefts = np.divmod(seen, -(-looker.classes.shape[1] // factor))
        cells = (tops + rows.start // factor) * self.planning.cols + lefts + cols.start // factor
        self._looked[cells] += levels(self.seek.detection)

    def _own_counts(self) -> NDArray[np.int64]:
        return np.concatenate((super()._own_counts(), self._looked))

    # -- planning -----------------------------------------------------------------------------------

    def freeze(self, t0: float) -> Belief:  # type: ignore[override]
        """Snapshot the team's map, and where somebody may be in it."""
        known = super().freeze(t0)
        return known, search_belief(known, self.fusion.counts[ROWS * BINS :])

    def prepare(  # type: ignore[override]
        self, belief: Belief, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float
    ) -> None:
        """Find the stops of a round, frontiers and places to look from."""
        self._seeker.unsearched = self._unsearched(belief)
        super().prepare(belief[0], pose, mates, blocked, now)

    def _unsearched(self, belief: Belief) -> NDArray[np.float64]:
        """Return ``(r, c)`` free cells of each of the window's planning cells that nobody has looked at.

        One that would have shown somebody with a probability of 0.9 counts a tenth.
        """
        known, (row, col) = belief[0], belief[0].first
        free = room_for_somebody(
            np.where(known.classes == FREE, known.classes, 2).astype(np.uint8), known.factor
        )
        looked = self.fusion.counts[ROWS * BINS :].reshape(known.planning.shape)
        part = looked[row : row + free.shape[0], col : col + free.shape[1]]
        return np.asarray(free * np.exp(-part / LEVELS_PER_NAT))

    def admit(self, belief: Belief, impact: Impact, robots: int) -> None:  # type: ignore[override]
        """Refuse more than so many of the team's best robots can see."""
        super().admit(belief[0], impact[0], robots)
        if self.most is None:
            return
        side, edges = belief[0].planning.resolution, belief[0].layers.edges
        most = Most(self.seek.reach, self.most.speed)
        mapping.check_claim(impact[1], robots, most, MOST_STOPS + MOST_SPOTS, side, edges)

    def promised(  # type: ignore[override]
        self, belief: Belief, impact: Impact
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return what of the map is more likely seen than not, and after how long [s]."""
        return super().promised(belief[0], impact[0])

    def unseen(self, belief: Belief, cells: NDArray[np.int64]) -> NDArray[np.bool_]:  # type: ignore[override]
        """Tell of which planning cells at least half is unknown."""
        return super().unseen(belief[0], cells)

    def discounted(self, impact: Impact, halvings: int) -> Impact:  # type: ignore[override]
        """Return an impact that is so many times half as likely."""
        looks = SparseMisses(*mapping.less_likely(impact[1], halvings))
        return super().discounted(impact[0], halvings), looks

    # -- driving ------------------------------------------------------------------------------------

    def reached(self, pose: Pose, mates: Sequence[Mate], now: float) -> bool:
        """Go on to the next stop; at a place to look from there is nothing else to do."""
        if len(self.strategy) and self.strategy.unknown[0] == LOOKED_AT:
            self.strategy = self.strategy.after_first()
            return True
        return super().reached(pose, mates, now)
