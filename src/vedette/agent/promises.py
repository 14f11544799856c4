"""What is claimed has to be fulfilled: a claim repeated, and never made good, loses weight.

Impacts are anonymous sums, so it is a link that is judged; in an audit (``vedette.agent.audit``) a robot.
docs/trust.md (V75)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.agent.mission import Mission, Promising

LEAST = 100  # cells that are overdue before anything is said of it; four square metres of planning cells
SOON = 20.0  # what is promised for later is not looked at [s]
TWICE = 2.0  # so many times the promised time is given
AT_LEAST = (
    5.0  # and no less than this: a plan is carried out once its round has ended, and rounds take time [s]
)
MOST_HELD_UP = 20.0  # and so much more at most, to who says or shows to be held up [s]
FADES = 0.8  # what was fulfilled counts so much less in each round that comes
NOTHING = 3  # halvings at which a link counts as nothing for a while
TOLD = 2  # halvings from which people are told
PAUSE = 60.0  # that while [s]


@dataclass
class Promises:
    """What one link, or one robot, has promised in every round since some time, and whether that came true.

    A promise that is not repeated is void: it was planned anew.
    """

    halvings: int = 0  # by so many halves a claim counts less
    until: float = -np.inf  # it counts as nothing [s]
    lost: float = -np.inf  # when its weight last changed [s]
    _cells: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))  # (P,) increasing
    _first: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))  # (P,) when first promised [s]
    _due: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))  # (P,) for when, soonest [s]
    _before: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))  # (P,) held up before that [s]
    _fulfilled: float = 0.0  # cells

    @property
    def weight(self) -> str:
        """What a claim counts, as people read it."""
        return "nothing" if self.halvings == NOTHING else f"1/{2**self.halvings}"

    def note(
        self,
        cells: NDArray[np.int64],
        due: NDArray[np.float64],
        unseen: Callable[[NDArray[np.int64]], NDArray[np.bool_]],
        now: float,
        held_up: float = 0.0,
    ) -> bool:
        """Take in what is promised now, increasing cells, each for a time [s]; tell if that loses weight.

        ``held_up``: how long who promises has been kept from it so far, all in all and by its own word [s].
        """
        self._fulfilled = FADES * self._fulfilled + float(np.count_nonzero(~unseen(self._cells)))
        soon = (due <= now + SOON) & unseen(cells)
        self._repeat(cells[soon], due[soon], now, held_up)
        given = np.maximum(TWICE * (self._due - self._first), AT_LEAST)
        given += np.minimum(held_up - self._before, MOST_HELD_UP)
        overdue = int(np.count_nonzero(now >= self._first + given))
        if overdue >= LEAST and overdue > self._fulfilled:
            self._lose(now)
            return True
        if overdue == 0 and self.halvings and now >= self.lost + PAUSE:
            self.halvings, self.lost = self.halvings - 1, now
        return False

    def _repeat(self, cells: NDArray[np.int64], due: NDArray[np.float64], now: float, held_up: float) -> None:
        """Keep what is promised again as it was first, and add what is new."""
        first, due, before = np.full(len(cells), now), due.copy(), np.full(len(cells), held_up)
        old = np.searchsorted(self._cells, cells)
        again = old < len(self._cells)
        again[again] = self._cells[old[again]] == cells[again]
        old = old[again]
        first[again] = self._first[old]
        due[again] = np.minimum(due[again], self._due[old])
        before[again] = self._before[old]
        self._cells, self._first, self._due, self._before = cells, first, due, before

    def _lose(self, now: float) -> None:
        self.halvings, self.lost = min(self.halvings + 1, NOTHING), now
        if self.halvings == NOTHING:
            self.until = now + PAUSE
        self._fulfilled = 0.0
        self._cells, self._first = self._cells[:0], self._first[:0]
        self._due, self._before = self._due[:0], self._before[:0]


def weighed(mission: Mission[Any, Any, Any], impact: Any, halvings: int) -> Any:
    """Return an impact as much as it counts, so many times half of what it claims."""
    if halvings == 0 or not isinstance(mission, Promising):
        return impact
    return mission.discounted(impact, halvings)


@dataclass
class Suspicion:
    """A robot's neighbours, by what comes over their links; or, in audits, robots by their own accounts."""

    held_up: Callable[[int], float] = lambda name: 0.0  # how long who promises has been, all in all [s]
    _promises: dict[int, Promises] = field(default_factory=dict)

    def weigh(self, mission: Mission[Any, Any, Any], neighbour: int, impact: Any) -> Any:
        """Return what a neighbour's claim counts for."""
        return weighed(mission, impact, self.halvings(neighbour))

    def halvings(self, neighbour: int) -> int:
        """Return how many times a neighbour's claims have lost half of their weight."""
        known = self._promises.get(neighbour)
        return 0 if known is None else known.halvings

    def note(
        self, mission: Mission[Any, Any, Any], belief: Any, claims: Mapping[int, Any], now: float
    ) -> set[int]:
        """Take in what was claimed in a round, by whom; return whose claims have lost weight."""
        lost = set[int]()
        if not isinstance(mission, Promising):
            return lost
        for name, impact in claims.items():
            cells, after = mission.promised(belief, impact)
            promises = self._promises.setdefault(name, Promises())
            unseen = partial(mission.unseen, belief)
            if promises.note(cells, now + after, unseen, now, self.held_up(name)):
                lost.add(name)
        return lost

    def nothing(self, now: float) -> frozenset[int]:
        """Return whose claims count as nothing for now."""
        return frozenset(name for name, promises in self._promises.items() if now < promises.until)

    @property
    def complaints(self) -> dict[int, str]:
        """What is wrong with whom, by neighbour."""
        return {
            name: f"less than half of what is claimed over its link comes true: it counts {known.weight}"
            for name, known in self._promises.items()
            if known.halvings >= TOLD
        }
