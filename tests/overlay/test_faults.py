"""Fault schedules: after each step no cycle, no stamp mixed with another; in the end one tree a component."""

from __future__ import annotations

import pytest

from tests.support.overlay_faults import play

SCHEDULES = 200
BATCH = 20


@pytest.mark.parametrize("first", range(0, SCHEDULES, BATCH))
def test_any_faults_end_in_one_tree_a_component(first: int) -> None:
    for seed in range(first, first + BATCH):
        play(seed)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(SCHEDULES, 5000, 100))
def test_thousands_of_fault_schedules_end_in_one_tree_a_component(first: int) -> None:
    for seed in range(first, first + 100):
        play(seed)


def test_a_schedule_is_the_same_every_time() -> None:
    assert play(17) == play(17)
