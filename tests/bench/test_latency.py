"""Rounds over slow links, and who else could decide: outcomes as elsewhere, and times that add up."""

from __future__ import annotations

import numpy as np
import pytest

from bench.compare import TracksCodec, in_a_centre, ours
from bench.latency import HOPS, JUDGED_HOP, SCHEMES, judge, make_tree, measure, play, root_of, trips
from bench.scale.series import DOMAINS
from bench.scale.team import Lots
from bench.stonesoup.scenario import scene
from vedette.negotiation import Tree, negotiate

LOT = DOMAINS["tracking"].LOT
TEAM = DOMAINS["tracking"].dense(Lots.square(8, LOT), np.random.default_rng(3))


@pytest.mark.parametrize("scheme", SCHEMES[:2])
def test_a_round_over_slow_links_comes_to_what_negotiate_does(scheme: str) -> None:
    tree = Tree.balanced(8)
    trip = play(TEAM, tree, 0, scheme, HOPS)
    agreed = negotiate(TEAM.objective, TEAM.belief, TEAM.candidates, tree, scheme, codec=TEAM.codec)
    assert trip.outcome.value == pytest.approx(agreed.value, rel=1e-6)
    assert (trip.outcome.sweeps, trip.messages) == (agreed.sweeps, agreed.messages)


def test_a_round_takes_at_least_its_hops_one_after_the_other() -> None:
    tree = Tree.star(8)
    token, fork = (trips(TEAM, tree, 0, scheme) for scheme in ("token", "fork"))
    # gathering, sweeps there and back, the end: on a star the token visits the leaves in turn
    assert fork.seconds[-1] >= 0.1 * (2 + 2 * fork.outcome.sweeps)
    assert token.seconds[-1] >= 0.1 * (2 + 2 * 7 * (token.outcome.sweeps - 1))
    assert np.all(np.diff(fork.seconds) > 0.0)


def test_the_tree_over_radios_links_only_those_in_reach_and_is_rooted_at_the_first() -> None:
    tree = make_tree("radio", TEAM.places, LOT)
    for i, k in tree.edges:
        assert np.hypot(*(TEAM.places[i] - TEAM.places[k])) <= 2.0 * LOT
    assert root_of("radio", tree)[0] == 0
    assert root_of("chain", Tree.chain(7)) == (3, 3)


def test_rows_name_what_was_measured_and_small_teams_are_not_judged() -> None:
    rows = measure((8,), lambda text: None)
    assert {(row.tree, row.scheme) for row in rows} == {
        (tree, scheme) for tree in ("radio", "balanced", "random") for scheme in SCHEMES
    }
    assert all(len(row.seconds) == len(HOPS) and row.value > 0.9 for row in rows)
    assert all(row.of_token == 1.0 for row in rows if row.scheme == "token")
    assert [each.verdict for each in judge(rows)] == ["NOT MEASURED", "NOT MEASURED"]
    assert JUDGED_HOP in HOPS


def test_a_centre_gets_all_lists_and_is_worth_what_it_says() -> None:
    problem = ours(scene(3, 8, np.random.default_rng(1)))
    cpu, messages, size, value = in_a_centre(problem)
    lists = [problem.codec.encode(each) for own in problem.candidates[1:] for each in own]
    assert (messages, size) == (4, sum(map(len, lists)) + 4)
    agreed = negotiate(problem.objective, problem.belief, problem.candidates, Tree.chain(3))
    assert value == pytest.approx(agreed.history[3].value)  # after the token's first sweep
    assert cpu > 0.0


def test_information_about_tracks_survives_its_bytes() -> None:
    problem = ours(scene(2, 8, np.random.default_rng(2)))
    codec = TracksCodec(problem.belief.roots.shape)
    for impact in problem.candidates[0]:
        np.testing.assert_allclose(codec.decode(codec.encode(impact)), impact, rtol=1e-6)
