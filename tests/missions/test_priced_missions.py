"""Missions whose robots price the end of their tours: what is announced never falls, and nothing is left."""

from __future__ import annotations

from functools import reduce
from typing import Any

import pytest

from tests.support.small_missions import check_complete, robots, small_office
from vedette.domains.mapping.objective import MappingObjective
from vedette.negotiation import TokenNode
from vedette.negotiation.messages import Tally
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation

OBJECTIVE = MappingObjective()
PRICED, DEAR = (f"tests.support.priced_planner:{name}" for name in ("PRICED", "DEAR"))


def team(planner: str, seed: int, n: int, scheme: str = "token") -> ExploreSimulation:
    """A team in a small office."""
    setup = ExploreSetup(seed=seed, planner=planner, scheme=scheme, max_time=900.0)
    return prepare(small_office(seed=1 + seed), robots(n), setup)


@pytest.mark.parametrize("planner", ["long", PRICED])
def test_for_hundreds_of_turns_the_token_announces_what_the_team_is_worth_and_that_never_falls(
    planner: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    teams: list[ExploreSimulation] = []
    turns: list[tuple[float, float, float, bool]] = []  # announced before, and after, true, with prices
    turn = TokenNode._turn

    def watched(self: TokenNode[Any], tally: Tally) -> Any:
        sends = turn(self, tally)
        rounds = [agent.rounds.round for agent in teams[-1].agents]
        seats = [each.participant for each in rounds if each is not None and each.participant is not None]
        if len(seats) == tally.size:  # nobody has left yet
            whole = reduce(OBJECTIVE.combine, [seat.impact for seat in seats])
            true = OBJECTIVE.value(seats[0]._belief, whole)
            turns.append((tally.value, self.turns[-1][1], true, whole.price > 0))
        return sends

    monkeypatch.setattr(TokenNode, "_turn", watched)
    for seed in range(4):
        teams.append(team(planner, seed, 3))
        check_complete(explore(teams[-1]))
    assert len(turns) > 300
    assert sum(priced for *_, priced in turns) > 0.9 * len(turns)
    assert any(after > before + 1e-6 for before, after, *_ in turns)
    for before, after, true, _ in turns:
        assert after >= before - 1e-9
        assert after == pytest.approx(true, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("scheme", ["token", "multistart", "fork", "async", "jacobi"])
def test_where_no_tour_is_worth_its_price_a_team_goes_on_until_nothing_is_left_to_see(scheme: str) -> None:
    check_complete(explore(team(DEAR, 0, 2, scheme)))
