"""Robots' maps are laid together when they are new, and no more often than a share of a core allows."""

from __future__ import annotations

import numpy as np
import pytest
from msgspec import structs

from vedette.maps import FREE, OCCUPIED, GridFrame
from vedette.net.explore.content import MapContent, content, read_content
from vedette.net.explore.reported import SHARE, ReportedMaps

FRAME = GridFrame(0.1, 20, 30)
COST = 0.1  # of laying maps together [s]


def told(cells: int) -> MapContent:
    """A robot's map whose first cells are free, and one wall."""
    classes = np.zeros(FRAME.shape, np.uint8)
    classes.flat[:cells] = FREE
    classes[-1, -1] = OCCUPIED
    extent = slice(0, FRAME.rows), slice(0, FRAME.cols)
    return read_content(content(FRAME, extent, classes, classes > 0, None))


class Ticking:
    """A clock of the hand, and CPU time that grows with each reading."""

    def __init__(self) -> None:
        self.now = self.used = 0.0

    def spent(self) -> float:
        self.used += COST
        return self.used


def test_maps_are_laid_together_as_often_as_a_share_of_a_core_allows_and_not_for_nothing() -> None:
    time = Ticking()
    maps = ReportedMaps(lambda: time.now, time.spent)
    laid = set[int]()
    for tick in range(100):
        time.now = 0.1 * tick
        laid.add(id(ground := maps.of([told(10 + tick), told(5)])))
        if tick == 0:
            first = ground
    assert time.used / 2.0 <= SHARE * 10.0 + 2 * COST  # read before and after
    assert time.used / 2.0 >= SHARE * 10.0 - COST
    assert first.known_m2 == pytest.approx(0.11)
    before = time.used
    latest = [told(109), told(5)]
    time.now = 100.0
    assert maps.of(latest).known_m2 == pytest.approx(1.10)
    time.now = 200.0
    maps.of(latest)
    assert time.used == pytest.approx(before + 2 * COST)  # nothing was new


def test_a_malformed_map_is_told_and_the_next_whole_one_is_shown() -> None:
    maps = ReportedMaps()
    broken = structs.replace(told(10), classes=b"nothing")
    with pytest.raises(ValueError, match="not deflated"):
        maps.of([broken])
    assert maps.of([told(10)]).known_m2 == pytest.approx(0.11)
