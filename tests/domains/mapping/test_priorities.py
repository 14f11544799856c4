"""Priority areas: they pull at the frontier from which the way there is shortest, by walls and unknown."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.small_missions import drawn
from vedette.domains.mapping.approach import ways_to
from vedette.domains.mapping.priorities import FADING, PULL, REACHED, priority_factors, pull
from vedette.kernels.frontier import find_frontiers
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.maps.area import Area

# Free where there is a dot, unknown where there is a question mark; the area is what the 'A's are in.
HALL = """
##################
#??????#AAAA??????
#..????#AAAA#?????
#..#########??????
#..............???
#..............???
##################
"""
FACTOR = 2
WORLD = drawn(HALL.replace("A", "?"))
FRAME = WORLD.frame
LINES = [line for line in HALL.splitlines() if line]
KINDS = np.array(
    [[{"#": OCCUPIED, ".": FREE}.get(mark, UNKNOWN) for mark in line] for line in reversed(LINES)]
)
CLASSES = KINDS.astype(np.uint8).repeat(5, axis=0).repeat(5, axis=1)
AREA = Area(((4.0, 2.0), (6.0, 2.0), (6.0, 3.0), (4.0, 3.0)))
FRONTIERS = find_frontiers(CLASSES, 2, 25)


def places() -> np.ndarray:
    """Where the frontiers are [m]."""
    cells, starts = FRONTIERS
    return FRAME.centres(cells[(starts[:-1] + starts[1:]) // 2])


def test_a_frontier_behind_a_wall_is_farther_than_one_round_it() -> None:
    at = places()
    ways = ways_to(AREA, FRAME, CLASSES, FRONTIERS, FACTOR)
    assert ways is not None
    west, east = at[:, 0] < 2.0, at[:, 0] > 5.0
    assert west.any()
    assert east.any()
    assert ways[east].max() < ways[west].min()
    assert (ways >= np.hypot(*(at - (5.0, 2.5)).T) - 0.3).all()


def test_ways_are_those_of_a_search_over_open_planning_cells() -> None:
    ways = ways_to(AREA, FRAME, CLASSES, FRONTIERS, FACTOR)
    assert ways is not None
    open_ = ~(CLASSES[:34, :90].reshape(17, 2, 45, 2) == OCCUPIED).any(axis=(1, 3))
    unknown = np.argwhere(AREA.holds(FRAME) & (CLASSES == UNKNOWN))
    start = tuple(unknown[((unknown - unknown.mean(axis=0)) ** 2).sum(axis=1).argmin()] // 2)
    far = {start: 0.0}
    left = {start}
    while left:  # Dijkstra, cell by cell
        here = min(left, key=far.__getitem__)
        left.discard(here)
        for row in (-1, 0, 1):
            for col in (-1, 0, 1):
                to = here[0] + row, here[1] + col
                if (row, col) == (0, 0) or not (0 <= to[0] < 17 and 0 <= to[1] < 45) or not open_[to]:
                    continue
                if row and col and not (open_[here[0], to[1]] and open_[to[0], here[1]]):
                    continue
                way = far[here] + 0.2 * (17 / 12 if row and col else 1.0)
                if way < far.get(to, np.inf) - 1e-9:
                    far[to] = way
                    left.add(to)
    cells, starts = FRONTIERS
    ends = [
        tuple(np.array(divmod(int(cell), FRAME.cols)) // 2) for cell in cells[(starts[:-1] + starts[1:]) // 2]
    ]
    assert ways.tolist() == pytest.approx([far.get(end, np.inf) for end in ends], abs=1e-5)


def test_an_area_beyond_the_window_is_led_to_through_what_is_unknown() -> None:
    far = Area(((30.0, 1.0), (32.0, 1.0), (32.0, 3.0), (30.0, 3.0)))
    ways = ways_to(far, FRAME, CLASSES, FRONTIERS, FACTOR)
    assert ways is not None
    east = places()[:, 0] > 5.0
    assert ways[east].min() == pytest.approx(31.0 - places()[east, 0].max(), abs=1.5)
    assert ways_to(Area(((1e6, 0.0), (1e6 + 5, 0.0), (1e6, 9.0))), FRAME, CLASSES, FRONTIERS, FACTOR) is None


def test_all_frontiers_together_stand_for_the_same_however_many_there_are() -> None:
    told = pull(FRAME, CLASSES, FRONTIERS, [(AREA, 4.0)], FACTOR)
    assert len(told) >= 2
    assert told.sum() == pytest.approx(4.0 * PULL)
    assert places()[told.argmax(), 0] > 5.0
    ways = ways_to(AREA, FRAME, CLASSES, FRONTIERS, FACTOR)
    assert ways is not None
    assert told.max() / told.min() == pytest.approx(np.exp(np.ptp(ways) / FADING))


def test_the_pull_fades_as_the_area_gets_known_and_none_is_none() -> None:
    known = CLASSES.copy()
    inside = AREA.holds(FRAME)
    cells = np.flatnonzero(inside)
    known.flat[cells[: len(cells) // 4]] = FREE
    frontiers = find_frontiers(known, 2, 25)
    share = 0.25 / REACHED
    told = pull(FRAME, known, frontiers, [(AREA, 4.0)], FACTOR).sum()
    assert told == pytest.approx(4.0 * PULL * (1.0 - share), rel=0.05)
    known[inside] = FREE
    assert not pull(FRAME, known, find_frontiers(known, 2, 25), [(AREA, 4.0)], FACTOR).any()
    assert not pull(FRAME, CLASSES, FRONTIERS, [], FACTOR).any()


def test_where_areas_overlap_the_greatest_factor_counts() -> None:
    factors = priority_factors(FRAME, [(AREA, 4.0), (AREA, 2.0)])
    assert set(factors[AREA.holds(FRAME)].tolist()) == {4.0}
    assert set(factors[~AREA.holds(FRAME)].tolist()) == {1.0}
