"""One member lies, of its own or in others' names: the honest finish, on a right map, and name it."""

from __future__ import annotations

import pytest

from tests.support.liars import MODES, Ending, play, without

LIES = sorted(MODES.keys() - {"dead", "honest"})
NAMED_WITHIN = 30.0  # [s]


def check(mode: str, robots: int, seed: int) -> None:
    """What must hold of every lie."""
    ending, dead = play(mode, robots, seed), without(robots, seed)
    about = mode, robots, seed, ending
    assert ending.outcome.value == "complete", about
    assert ending.known >= 0.99 * dead.known, about
    assert ending.time <= 1.5 * dead.time, about
    assert ending.wrong <= 0.005, about
    assert is_named(ending), about


def is_named(ending: Ending) -> bool:
    return ending.named.get(ending.liar, float("inf")) <= NAMED_WITHIN


@pytest.mark.parametrize("mode", ["claim", "free", "notes", "poison"])
def test_a_team_of_three_finishes_and_names_who_lies(mode: str) -> None:
    check(mode, 3, 0)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("robots", [3, 5])
@pytest.mark.parametrize("mode", LIES)
def test_teams_finish_and_name_who_lies(mode: str, robots: int, seed: int) -> None:
    check(mode, robots, seed)


def test_of_the_honest_nobody_is_named_and_all_are_believed() -> None:
    ending = play("honest", 3, 0)
    assert not ending.named
    assert not ending.out
