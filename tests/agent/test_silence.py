"""Who is silent for long in round after round is slow; who waits for somebody else is not."""

from __future__ import annotations

import pytest

from vedette.agent.attendance import Attendance
from vedette.agent.silence import OFTEN, Silences, Slowness

BEARS = 0.5  # [s]


def silences(*heard: float, frozen: float = 10.0) -> Silences:
    """What one round saw of the neighbour 1, heard at these times [s]."""
    round_ = Silences()
    for now in [each for each in heard if each < frozen]:
        round_.heard(1, now)
    round_.begin(frozen)
    for now in [each for each in heard if each >= frozen]:
        round_.heard(1, now)
    return round_


@pytest.mark.parametrize(
    ("heard", "longest"),
    [
        ((10.25, 10.5, 10.75), 0.25),
        ((), 1.0),
        ((3.0, 9.9), 1.0),  # what was before the freezing does not count
        ((10.01, 10.71, 10.9), 0.7),
        ((10.25, 10.26), 0.74),
    ],
)
def test_a_silence_lasts_from_the_freezing_or_the_last_word_to_the_next_or_the_end(
    heard: tuple[float, ...], longest: float
) -> None:
    assert silences(*heard).longest(1, 11.0) == pytest.approx(longest)


def test_before_a_round_is_frozen_nobody_is_silent() -> None:
    assert Silences().longest(1, 1000.0) == 0.0


def test_who_is_silent_for_long_in_three_rounds_in_a_row_is_slow_until_one_goes_well() -> None:
    slowness = Slowness()
    for row in range(1, 6):
        slowness.note(silences(10.01, 10.71), [1], BEARS, 11.0)
        assert slowness.slow == (frozenset({1}) if row >= OFTEN else frozenset())
    slowness.note(silences(10.25, 10.5, 10.75), [1], BEARS, 11.0)
    assert not slowness.slow
    slowness.note(silences(10.01, 10.71), [1], BEARS, 11.0)
    assert not slowness.slow


def test_a_child_that_has_missed_a_round_is_waited_for_briefly_until_it_is_there_to_an_end() -> None:
    attendance = Attendance()
    assert attendance.bears(1, 2.5) == 2.5
    attendance.missed(1, 0.0, 1.0)
    assert attendance.bears(1, 2.5) == pytest.approx(0.5)
    assert attendance.bears(2, 2.5) == 2.5
    attendance.attended([1])
    assert attendance.bears(1, 2.5) == 2.5


def test_but_three_times_as_long_as_it_took_last_where_links_are_slow() -> None:
    attendance = Attendance()
    attendance.missed(1, 0.0, 1.0)
    for took, bears in ((0.7, 2.1), (2.0, 2.5)):
        attendance.flushed(1, took)
        assert attendance.bears(1, 2.5) == pytest.approx(bears)
