"""Who signs of itself what cannot be is named, by all who hold what it has signed; the honest are not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.notaries import certified
from vedette.fusion.own_word import PATIENCE
from vedette.fusion.particulars import Capabilities
from vedette.fusion.signed import SignedEvidence
from vedette.kernels.tiles import TiledGrid

SHAPE, CELL = (96, 128), 0.1
LIMITS = Capabilities(CELL, 8.0, 0.5, (-2.0, -1.0))
ROOM = np.full(SHAPE, -20, np.int8)  # all free, and walls around and in the middle
ROOM[[0, -1]] = ROOM[:, [0, -1]] = ROOM[40:60, 50:53] = 20


class Pair:
    """A robot that signs, and one that hears it."""

    def __init__(self) -> None:
        self.now = 1000.0
        self.both = [
            SignedEvidence(i, 1, SHAPE, 1, notary=certified(i, lambda: self.now), limits=LIMITS)
            for i in range(2)
        ]
        for one, other in ((0, 1), (1, 0)):
            self.both[one].set_out(30, 30)
            self.both[one].set_neighbours([other])

    def say(self, grid: NDArray[np.int8], at: tuple[float, float], number: int) -> None:
        """Publish a map, that is new in one cell, from a place [m]."""
        grid = grid.copy()
        grid[90, 100 + number % 20] = 0
        self.now += 1.0
        x, y = at
        self.both[0].be_at(number, round(100.0 * x), round(100.0 * y))
        self.both[0].publish(TiledGrid.of(grid), None, None)
        for one, other in ((0, 1), (1, 0)) * 2:
            payload = self.both[one].outgoing(other, self.now)
            if payload is not None:
                self.both[other].receive(one, payload, self.now)

    @property
    def named(self) -> dict[int, str]:
        return self.both[1].complaints


def driven(number: int) -> tuple[float, float]:
    """Where a robot is that drives past the wall in the middle, 30 cm from it [m]."""
    return -2.0 + CELL * 30 + 0.1 * number, -1.0 + CELL * 36


def test_who_maps_what_there_is_and_drives_past_walls_is_not_named() -> None:
    pair = Pair()
    for number in range(60):
        pair.say(ROOM, driven(number), number)
    assert pair.named == {}


def test_who_has_walls_all_about_where_it_stands_is_named_once_it_has_had_time_to_put_it_right() -> None:
    pair = Pair()
    for number in range(PATIENCE + 1):
        pair.say(ROOM if number == 0 else np.full(SHAPE, 20, np.int8), driven(number), number)
        assert bool(pair.named) is (number >= PATIENCE)
    assert "its own map has walls all about" in pair.named[0]


def test_a_place_where_nothing_is_known_or_free_ground_is_near_is_none_within_walls() -> None:
    pair = Pair()
    for number in range(2 * PATIENCE):
        told = np.zeros(SHAPE, np.int8) if number % 3 else np.full(SHAPE, 20, np.int8)
        if number % 3 == 1:
            told = ROOM
        pair.say(told, driven(number), number)
    assert pair.named == {}


@pytest.mark.parametrize(("away", "named"), [(4.0, False), (7.0, True)])
def test_who_signs_to_have_come_farther_than_it_drives_is_named(away: float, named: bool) -> None:
    pair = Pair()
    for number in range(3):
        pair.say(ROOM, driven(number), number)
    x, y = driven(3)
    pair.say(ROOM, (x + away, y), 3)  # within a second; five metres are what a SLAM may put right
    assert (pair.named == {0: "it signs to have come farther than anybody drives"}) is named
