"""Ways over a field and who takes them: borders, walls, budgets, and the best reply by trying everything."""

from __future__ import annotations

import math

import numpy as np
import pytest

from vedette import InputError
from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.field import FieldModel
from vedette.domains.monitoring.impact import NOTHING, impact_of
from vedette.domains.monitoring.objective import MonitoringBelief, MonitoringObjective
from vedette.domains.monitoring.platform import FieldSensor, MonitoringPlatform, lawnmower
from vedette.domains.monitoring.spots import Spots
from vedette.domains.monitoring.ways import Way, fan, passable
from vedette.domains.monitoring.worth import Patrol
from vedette.maps import GridFrame

FRAME = GridFrame(0.5, 20, 24, -1.0, 2.0)  # x -1 to 11, y 2 to 12
ROVER, FLYER = FieldSensor(0.1), FieldSensor(0.4, side=3, every=0.5)


def frozen() -> MonitoringBelief:
    belief = FieldBelief.prior(FieldModel(FRAME, length=3.0), Spots(FRAME, (1, 3)))
    return MonitoringBelief(belief, Patrol(6.0, 2, 0.8), unit=0.1)


def test_a_way_is_gone_at_constant_speed_and_what_is_left_of_it_ends_where_it_did() -> None:
    way = Way(((0.0, 0.0), (3.0, 0.0), (3.0, 4.0)))
    assert way.length == 7.0
    assert way.at(np.array([0.0, 1.5, 5.0, 99.0])).tolist() == [[0, 0], [1.5, 0], [3, 2], [3, 4]]
    assert way.after(1.0) == Way(((1.0, 0.0), (3.0, 0.0), (3.0, 4.0)))
    assert way.after(5.0) == Way(((3.0, 2.0), (3.0, 4.0)))
    assert way.after(9.0) == Way(((3.0, 4.0),))


def test_a_fan_has_every_pair_of_legs_and_staying() -> None:
    ways = fan((1.0, 2.0), 6.0, 4)
    assert len(set(ways)) == 17
    assert sorted(round(way.length, 9) for way in ways) == [0.0] + [6.0] * 16
    ends = {(round(x, 9), round(y, 9)) for x, y in (way.places[-1] for way in ways)}
    assert {(7.0, 2.0), (4.0, 5.0), (1.0, 2.0), (1.0, -4.0)} <= ends


def test_a_way_ends_before_the_border_a_wall_and_the_end_of_the_budget() -> None:
    blocked = np.zeros(FRAME.shape, bool)
    blocked[:, 10] = True  # x from 4.0 to 4.5
    east = Way(((0.0, 5.0), (20.0, 5.0)))
    assert passable(east, FRAME, None, math.inf).places[-1][0] == pytest.approx(11.0, abs=0.15)
    assert passable(east, FRAME, blocked, math.inf).places[-1][0] == pytest.approx(4.0, abs=0.15)
    assert passable(east, FRAME, blocked, math.inf).places[-1][0] < 4.0
    assert passable(east, FRAME, blocked, 2.5).length == pytest.approx(2.5)
    assert passable(east, FRAME, None, 0.0).length == 0.0
    inside = Way(((0.0, 5.0), (3.0, 5.0), (3.0, 7.0)))
    assert passable(inside, FRAME, blocked, 99.0) is inside
    corner = passable(Way(((0.0, 5.0), (3.0, 5.0), (3.0, 99.0))), FRAME, None, 99.0)
    assert corner.places[:2] == inside.places[:2]
    assert corner.places[2][1] == pytest.approx(12.0, abs=0.15)


def test_an_impact_holds_each_measurement_in_its_cell_and_layer() -> None:
    belief = frozen()
    rover = MonitoringPlatform(1.0, ROVER)
    impact = rover.impact(belief, Way(((0.2, 3.1), (4.2, 3.1))))  # four seconds to go, then two there
    found = {
        (key // 2, key % 2): units
        for key, units in zip(impact.keys.tolist(), impact.misses.tolist(), strict=True)
    }
    row = 2 * 24
    expected = {(row + 4, 0): 100, (row + 6, 0): 100, (row + 8, 0): 100, (row + 10, 1): 255}
    assert found == expected  # three measurements of 100 units at the end, cut off
    flyer = MonitoringPlatform(1.0, FLYER).impact(belief, Way(((0.2, 3.1), (0.2, 3.1))))
    assert {key // 2 - FRAME.size for key in flyer.keys.tolist()} == {row + 2}
    assert flyer.misses.tolist() == [150, 150]


@pytest.mark.parametrize("seed", range(4))
def test_a_reply_is_the_best_of_all_ways_and_the_slack_what_it_adds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = frozen()
    others = impact_of(rng.integers(2 * FRAME.size, size=40), rng.integers(2, size=40), 100, 2)
    platform = MonitoringPlatform(1.2, ROVER if seed % 2 else FLYER, bearings=4)
    platform.place(*rng.uniform((0, 3), (10, 11)).tolist(), budget=math.inf)
    platform.prepare(belief)
    objective = MonitoringObjective()
    values = [
        objective.value(belief, objective.combine(others, platform.impact(belief, way)))
        for way in platform.ways
    ]
    stay = platform.carry_over(belief, None)
    best = platform.reply(belief, others, stay)
    assert values[platform.ways.index(best)] == pytest.approx(max(values), rel=1e-9)
    assert platform.reply(belief, others, best) == best
    assert platform.slack(belief, others) == pytest.approx(
        max(values) - objective.value(belief, others), rel=1e-6
    )
    assert objective.value(belief, platform.impact(belief, best)) > objective.value(belief, NOTHING) == 0.0


def test_what_is_left_of_the_present_way_is_among_the_ways_and_a_budget_bounds_all() -> None:
    belief = frozen()
    platform = MonitoringPlatform(1.0, ROVER, bearings=4)
    present = Way(((2.0, 6.0), (3.7, 6.3), (5.0, 8.0))).after(1.0)
    platform.place(*present.places[0], budget=4.0, present=present)
    platform.prepare(belief)
    assert present in platform.ways
    assert max(way.length for way in platform.ways) == pytest.approx(4.0)
    platform.place(2.0, 6.0, budget=0.0)
    platform.prepare(belief)
    assert {way.length for way in platform.ways} == {0.0}


def test_two_that_stand_together_do_not_take_the_same_way() -> None:
    belief = frozen()
    platforms = [MonitoringPlatform(1.0, ROVER, bearings=4) for _ in range(2)]
    for each in platforms:
        each.place(5.0, 7.0, budget=math.inf)
        each.prepare(belief)
    one = platforms[0].reply(belief, NOTHING, platforms[0].carry_over(belief, None))
    other = platforms[1].reply(
        belief, platforms[0].impact(belief, one), platforms[1].carry_over(belief, None)
    )
    assert np.hypot(*np.subtract(one.places[-1], other.places[-1])) > 2.0


def test_a_lawn_mower_turns_at_the_end_of_each_line_to_the_next() -> None:
    places = np.array(lawnmower((0.0, 10.0, 2.0, 8.0), 1.5).places)
    legs = np.hypot(*np.diff(places, axis=0).T)
    np.testing.assert_allclose(legs, [10.0, 1.5, 10.0, 1.5, 10.0, 1.5, 10.0])


def test_a_lawn_mower_comes_within_half_the_spacing_of_every_place() -> None:
    way = lawnmower((0.0, 10.0, 2.0, 8.0), 1.5)
    places = way.at(np.linspace(0.0, way.length, 4000))
    for x, y in np.random.default_rng(0).uniform((0, 2), (10, 8), (50, 2)):
        assert np.hypot(*(places - (x, y)).T).min() <= 0.75 + 1e-2
    with pytest.raises(InputError, match="spacing must be > 0 m; got 0"):
        lawnmower((0.0, 1.0, 0.0, 1.0), 0.0)


def test_what_cannot_be_is_refused_in_one_line() -> None:
    for changes, line in (
        ({"speed": -1.0}, "speed must be >= 0 m/s; got -1.0"),
        ({"budget": math.nan}, "budget must be >= 0 m; got nan"),
        ({"bearings": 0}, "bearings must be 1 to 16; got 0"),
    ):
        with pytest.raises(InputError, match=line):
            MonitoringPlatform(**{"speed": 1.0, "sensor": ROVER, **changes})  # type: ignore[arg-type]
    for variance, every in ((0.0, 1.0), (-1.0, 1.0), (math.nan, 1.0), (1.0, 0.0)):
        with pytest.raises(InputError, match="must be a number > 0"):
            FieldSensor(variance, every=every)
    platform = MonitoringPlatform(1.0, ROVER, blocked=np.zeros((3, 3), bool))
    platform.place(99.0, 0.0, budget=1.0)
    with pytest.raises(InputError, match="outside the field; place it inside"):
        platform.prepare(frozen())
    platform.place(5.0, 5.0, budget=1.0)
    with pytest.raises(InputError, match=r"blocked has shape \(3, 3\); the field has \(20, 24\)"):
        platform.prepare(frozen())
