"""One member, or two, that are slow, hang, or say nothing: the others keep the laws, and finish."""

from __future__ import annotations

import pytest

from tests.support.bad_member import MODES, play

SEEDS = 6
ALL, BATCH = 100, 10


@pytest.mark.parametrize("mode", MODES)
def test_no_member_stops_the_others(mode: str) -> None:
    for seed in range(SEEDS):
        play(mode, seed)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(SEEDS, ALL, BATCH))
@pytest.mark.parametrize("mode", MODES)
def test_no_member_stops_the_others_in_many_teams(mode: str, first: int) -> None:
    for seed in range(first, first + BATCH):
        play(mode, seed)
