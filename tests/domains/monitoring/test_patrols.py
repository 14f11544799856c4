"""Patrols and budgets: strips that make up the area, ways round obstacles, and what is left to spend."""

from __future__ import annotations

import math

import numpy as np
import pytest

from vedette.domains.monitoring.patrols import around, at_random, strip
from vedette.domains.monitoring.purse import Purse
from vedette.domains.monitoring.scenario import Budget
from vedette.domains.monitoring.ways import passable
from vedette.maps import GridFrame

FRAME = GridFrame(1.0, 30, 40)


def test_strips_of_a_team_cover_the_area_within_half_a_line_of_each_other() -> None:
    ways = [strip(FRAME, (1.0, 1.0), i, 3, 300.0) for i in range(3)]
    assert all(way.length >= 300.0 for way in ways)
    points = np.concatenate([way.at(np.linspace(0.0, way.length, 1600)) for way in ways])
    centres = FRAME.centres(np.arange(FRAME.size))
    away = np.sqrt(((centres[:, None] - points[None, ::4]) ** 2).sum(axis=2)).min(axis=1)
    assert away.max() < 2.0


@pytest.mark.parametrize("seed", range(3))
def test_a_patrol_on_the_ground_goes_round_what_cannot_be_entered(seed: int) -> None:
    blocked = np.zeros(FRAME.shape, bool)
    blocked[10:18, 18:24] = True
    rng = np.random.default_rng(seed)
    for way in (at_random(FRAME, (2.0, 2.0), 200.0, rng), strip(FRAME, (2.0, 2.0), 0, 2, 200.0)):
        ground = around(way, FRAME, blocked)
        assert passable(ground, FRAME, blocked, ground.length).length == pytest.approx(ground.length)
        assert ground.length > 50.0


def test_a_patrol_that_nobody_gets_to_is_staying() -> None:
    blocked = np.ones(FRAME.shape, bool)
    blocked[2, 2] = False
    way = around(strip(FRAME, (2.5, 2.5), 0, 1, 100.0), FRAME, blocked)
    assert way.length == 0.0


def test_a_budget_of_way_is_gone_with_the_way_and_leaves_the_sensor_awake() -> None:
    purse = Purse(Budget(path=100.0))
    assert (purse.reach(2.0), purse.left(0.0, 20.0), purse.awake(0.0)) == (100.0, 100.0, math.inf)
    purse.gone = 130.0
    assert (purse.left(50.0, 20.0), purse.awake(50.0)) == (0.0, math.inf)


def test_energy_is_spent_on_way_and_time_and_what_measuring_takes_is_kept() -> None:
    purse = Purse(Budget(energy=100.0, per_metre=2.0, per_second=1.0))
    assert purse.reach(2.0) == pytest.approx(40.0)  # 20 s on the way: 80 J for it, 20 J for the time
    assert purse.reach(1e-3) == pytest.approx(0.1, rel=0.01)  # next to all goes with the time
    assert purse.left(0.0, 20.0) == pytest.approx(40.0)  # 100 J less 20 s of measuring
    purse.gone = 20.0
    assert purse.awake(30.0) == pytest.approx(30.0)  # 100 - 40 - 30 J
    assert purse.left(30.0, 20.0) == pytest.approx(5.0)
    assert (purse.awake(70.0), purse.left(70.0, 20.0)) == (0.0, 0.0)
    standing = Purse(Budget(energy=10.0, per_metre=0.0, per_second=1.0))
    assert standing.left(5.0, 20.0) == math.inf
    assert standing.left(10.0, 20.0) == 0.0
