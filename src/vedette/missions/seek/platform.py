"""One robot that maps and looks for somebody: tours of frontiers and of places to look from, in one."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import MapImpact
from vedette.domains.mapping.platform import HYSTERESIS, STICKINESS, MappingPlatform
from vedette.domains.mapping.sightings import SightingModel
from vedette.domains.mapping.stops import LEFT_ALONE, Ground, Stops, legs_between
from vedette.domains.mapping.tour import Tour, on_the_way
from vedette.domains.search.belief import SearchBelief
from vedette.domains.search.impact import quantise
from vedette.kernels import coverage
from vedette.kernels.coverage import LAYERS, CellWeights, Footprints
from vedette.kernels.misses import STEPS_PER_NAT, SparseMisses
from vedette.missions.seek.looks import Looker
from vedette.missions.seek.options import SeekOptions
from vedette.missions.seek.spots import good_spots

Belief: TypeAlias = tuple[MapBelief, SearchBelief]
Impact: TypeAlias = tuple[MapImpact, SparseMisses]  # of the map, of looks for somebody

LOOKED_AT = -1  # in the place of the unknown cells near a frontier: this stop is none


@dataclass(eq=False)
class SeekingPlatform(MappingPlatform):
    """Strategies are tours; each stop shows something of the map, and somebody who is in sight of it.

    Kernels see both objectives as one coverage over the planning cells twice: for what is unknown there, and
    for somebody whom nobody has seen there.
    """

    seek: SeekOptions = field(default_factory=SeekOptions)
    worth: float = 1.0  # of finding somebody [nat]
    unsearched: NDArray[np.float64] | None = None  # (r, c) as ``good_spots`` has it
    looks: Footprints | None = None  # of the round's stops, probabilities of seeing somebody

    def prepare(self, belief: MapBelief) -> None:
        """Find the stops, frontiers and places to look from, and what each shows."""
        super().prepare(belief)
        assert self.ground is not None
        assert self.stops is not None
        looker = self._looker(belief)
        if not (self.leads_anywhere and self.seek.order == "map-first"):
            spots = self._spots(belief, self.ground, looker)
            if spots:
                self.stops = self._with(belief, self.ground, self.stops, spots)
                self.ahead, self.cut_short = self.max_stops, False
        self.looks = self._looks_from(belief, self.stops, looker)

    def _dares(self, belief: MapBelief, model: SightingModel) -> bool:
        """Look behind what is doubtful only where nothing is left to be searched."""
        assert self.ground is not None
        return not self._spots(belief, self.ground, self._looker(belief)) and super()._dares(belief, model)

    def _looker(self, belief: MapBelief) -> Looker:
        return Looker(belief.classes, belief.frame.resolution, self.seek.reach)

    def _spots(self, belief: MapBelief, ground: Ground, looker: Looker) -> list[int]:
        assert self.unsearched is not None
        return good_spots(belief, ground, self.unsearched, self.seek.reach, looker.seen)

    def _with(self, belief: MapBelief, ground: Ground, stops: Stops, spots: list[int]) -> Stops:
        """Return stops with places to look from after the frontiers."""
        cells = np.array(spots, np.int64)
        places = belief.frame.centres(cells)
        views = np.concatenate((stops.views, places))
        first_leg = np.concatenate(
            (stops.first_leg, ground.field.ravel()[cells] / np.float32(self.spec.speed))
        )
        legs = legs_between(belief, ground, _cells_of(belief, views)) / np.float32(self.spec.speed)
        shut = np.isinf(first_leg)
        shut[len(stops) :] |= self.left_alone.avoids(places, LEFT_ALONE)
        legs[:, shut] = np.inf
        marks, none = stops.footprints, np.full(len(cells), stops.footprints.starts[-1])
        return Stops(
            np.concatenate((stops.targets, places)),
            views,
            np.concatenate((stops.unknown, np.full(len(cells), LOOKED_AT))),
            Footprints(np.concatenate((marks.starts, none)), marks.cells, marks.misses),
            np.where(shut, np.float32(np.inf), first_leg),
            legs,
        )

    def _looks_from(self, belief: MapBelief, stops: Stops, looker: Looker) -> Footprints:
        """Return how likely somebody is seen in each planning cell from each stop, as log-misses.

        In what is known by whether it is in sight; in the unknown by whether the stop shows it.
        """
        starts, cells, chances = [0], [], []
        for k, cell in enumerate(_cells_of(belief, stops.views).tolist()):
            known = belief.planning_cells(looker.seen(cell).astype(np.uint32))
            row = slice(int(stops.footprints.starts[k]), int(stops.footprints.starts[k + 1]))
            shown, misses = stops.footprints.cells[row], stops.footprints.misses[row]
            away = np.hypot(*(belief.planning.centres(shown) - stops.views[k]).T)
            near = away <= self.seek.reach
            share = 1.0 - np.exp(-misses[near].astype(np.float64) / STEPS_PER_NAT)
            both, where = np.unique(np.concatenate((known, shown[near])), return_inverse=True)
            chance = np.zeros(len(both))
            np.maximum.at(chance, where, np.concatenate((np.ones(len(known)), share)))
            cells.append(both.astype(np.uint32))
            chances.append(self.seek.detection * chance)
            starts.append(starts[-1] + len(both))
        none = np.empty(0, np.uint32)
        return Footprints(
            np.array(starts, np.int64),
            np.concatenate((none, *cells)),
            quantise(np.concatenate((np.empty(0), *chances))),
        )

    def impact(self, belief: Belief, strategy: Tour) -> Impact:  # type: ignore[override]
        """What the tour shows of the map, and of somebody."""
        assert self.stops is not None
        assert self.looks is not None
        layers = belief[0].layers
        return (
            MapImpact(*on_the_way(self.stops.footprints, strategy, layers)),
            SparseMisses(*on_the_way(self.looks, strategy, layers)),
        )

    def reply(self, belief: Belief, others: Impact, current: Tour) -> Tour:  # type: ignore[override]
        """Best tour found against the rest of the team, if clearly better than the present one."""
        problem = self._both(belief, others)
        order, gain, present = coverage.best_tour(problem, current.stops, self.ahead, STICKINESS)
        return self.tour(order) if gain > present * (1.0 + HYSTERESIS) else current

    def slack(self, belief: Belief, team: Impact) -> float:  # type: ignore[override]
        """No strategy of this robot adds more to the team's impact [nat]; docs/mapping.md (V26)."""
        if self.cut_short:
            return math.inf
        return coverage.most_any_tour_adds(self._both(belief, team), self.ahead)

    def _both(self, belief: Belief, others: Impact) -> coverage.TourProblem:
        """Return the choice of a tour, the cells of searching numbered after those of the map."""
        (known, sought), stops, looks = belief, self.stops, self.looks
        assert stops is not None
        assert looks is not None
        size = known.planning.size
        unknown = known.weights.of(np.arange(size, dtype=np.uint32))
        weights = np.concatenate((unknown, (self.worth * sought.mass.ravel()).astype(np.float32)))
        keys = np.concatenate((others[0].keys, others[1].keys + np.uint32(size * LAYERS)))
        return coverage.TourProblem(
            CellWeights.whole(weights),
            known.layers.weights,
            known.layers.edges,
            (keys, np.concatenate((others[0].misses, others[1].misses))),
            _joined(stops.footprints, looks, size),
            stops.first_leg,
            stops.legs,
        )


def _cells_of(belief: MapBelief, places: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the flat cells of the window that places (K, 2) [m] lie in."""
    frame = belief.frame
    col, row = np.floor((places - (frame.origin_x, frame.origin_y)) / frame.resolution).astype(np.int64).T
    flat: NDArray[np.int64] = row * frame.cols + col
    return flat


def _joined(shows: Footprints, looks: Footprints, size: int) -> Footprints:
    """Return both footprints of each stop as one, the second's cells after ``size`` of the first."""
    stops = len(shows.starts) - 1
    whose = np.concatenate([np.repeat(np.arange(stops), np.diff(each.starts)) for each in (shows, looks)])
    order = np.argsort(whose, kind="stable")
    cells = np.concatenate((shows.cells, looks.cells + np.uint32(size)))[order]
    misses = np.concatenate((shows.misses, looks.misses))[order]
    return Footprints(shows.starts + looks.starts, cells, misses)
