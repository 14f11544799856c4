"""One member, or two, that are slow, hang, say nothing, or what is not so: the others finish all the same."""

from __future__ import annotations

import pytest

from tests.support import signed_mutants, signed_team
from tests.support.bad_member import MODES, plan_of, play
from tests.support.mutants import CASES, mutants_of

SEEDS = 4
ALL, BATCH = 124, 10
MUTANTS, SIGNED = 40, 20
TWO_HUNG, WORTH_TOLD = 100223, 13614  # seeds


@pytest.mark.parametrize("mode", MODES)
def test_no_member_stops_the_others(mode: str) -> None:
    for seed in range(SEEDS):
        play(mode, seed)


def test_a_team_parts_and_goes_on_where_two_that_hang_are_a_thirds_only_links() -> None:
    plan, bad = plan_of("hung", TWO_HUNG)
    alone = set(range(len(plan.places))) - set(bad) - {0, 3, 4}
    assert len(bad) == 2
    assert all(a in bad or b in bad for a, b in plan.edges if {a, b} & alone)
    play("hung", TWO_HUNG)


def test_a_worth_that_is_told_while_nobody_goes_is_believed_for_a_few_rounds_only() -> None:
    (case,) = mutants_of([WORTH_TOLD])
    assert (case.message, case.value) == ("Stop", 2.0**53)
    play("mutant", WORTH_TOLD)


@pytest.mark.parametrize("mode", ["mates", "epoch", "echo", "wrong map"])
def test_who_says_what_cannot_be_is_named_by_a_neighbour(mode: str) -> None:
    team = play(mode, 0)
    lives = [robot.life for robot in team.network._robots]
    named = {robot for i in team.honest for robot in lives[i].complaints}
    assert named == set(team.bad)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(SEEDS, ALL, BATCH))
@pytest.mark.parametrize("mode", MODES)
def test_no_member_stops_the_others_in_many_teams(mode: str, first: int) -> None:
    for seed in range(first, first + BATCH):
        play(mode, seed)


@pytest.mark.parametrize("first", range(0, MUTANTS, BATCH))
def test_no_field_of_any_message_stops_the_others(first: int) -> None:
    for seed in range(first, first + BATCH):
        play("mutant", seed)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(MUTANTS, len(CASES), BATCH))
def test_no_field_of_any_message_stops_the_others_at_any_value(first: int) -> None:
    for seed in range(first, min(first + BATCH, len(CASES))):
        play("mutant", seed)


@pytest.mark.parametrize("first", range(0, SIGNED, BATCH))
def test_no_field_of_what_is_signed_stops_the_others_or_has_the_honest_accused(first: int) -> None:
    for seed in range(first, first + BATCH):
        signed_team.play(seed)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(SIGNED, len(signed_mutants.CASES), BATCH))
def test_no_field_of_what_is_signed_stops_the_others_at_any_value(first: int) -> None:
    for seed in range(first, min(first + BATCH, len(signed_mutants.CASES))):
        signed_team.play(seed)
