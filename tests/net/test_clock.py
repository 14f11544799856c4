"""A process's clock: its own slows down with its host, one that the team shares does not."""

from __future__ import annotations

import pytest

from vedette.agent.body import TICK
from vedette.net.clock import LATE, MissionClock, ToldClock


def test_a_clock_of_its_own_shows_no_more_than_the_body_has_done() -> None:
    clock = MissionClock(2.0)
    clock.start(100.0)
    assert clock.shows(100.0) == 0.0
    assert clock.shows(100.02) == pytest.approx(0.04)
    assert clock.shows(103.0) == pytest.approx(TICK)
    assert clock.next == pytest.approx(100.0 + TICK / 2)


def test_a_clock_of_its_own_makes_up_for_a_few_ticks_and_lets_the_rest_go() -> None:
    clock = MissionClock(1.0)
    clock.start(0.0)
    clock.tick(60.0)
    assert clock.at == pytest.approx(TICK)
    ticks = 0
    while clock.next <= 60.0:
        clock.tick(60.0)
        ticks += 1
    assert LATE - 1 <= ticks <= LATE  # as the last one rounds


@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_a_shared_clock_shows_the_time_since_the_mission_began_whenever_it_starts(speed: float) -> None:
    early, late = MissionClock(speed, begins=50.0), MissionClock(speed, begins=50.0)
    early.start(40.0)
    assert early.shows(49.0) == 0.0
    now = 40.0
    while now < 90.0:
        now = max(now, early.next)
        early.tick(now)
    late.start(90.0)
    late.tick(90.0)
    for clock in (early, late):
        assert clock.at == pytest.approx((90.0 - 50.0) * speed, abs=2 * TICK)
    assert late.at == pytest.approx(early.at, abs=TICK * 1.001)


def test_a_clock_that_is_told_stands_still_with_its_source_and_never_goes_back() -> None:
    source: list[float | None] = [None]
    clock = ToldClock(lambda: source[0], 0.05)
    clock.start(100.0)
    seen = []
    for now, shown in enumerate([None, 500.0, 500.5, 500.5, 3.0, 4.0]):
        source[0] = shown
        clock.tick(100.0 + now)
        seen.append(clock.shows(100.0 + now))
    assert seen == [0.0, 0.0, 0.5, 0.5, 0.5, 1.5]
    assert clock.next == 105.05
