"""Rounds: all decide the same, whatever is lost or dies the next one goes on, and who is done is quiet."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fuzz.fingerprint import fingerprint
from tests.support.agent_team import Post, Team, nested_kind, toy, toy_agent, toy_team
from vedette import Tree, negotiate
from vedette.agent import Pace, messages
from vedette.agent.effects import TrafficKind
from vedette.agent.events import JobDone, Message, Stuck
from vedette.agent.patience import patience
from vedette.agent.round import MAX_FORKS
from vedette.negotiation import Chooser, RoundOutcome, encode
from vedette.negotiation.messages import Stop
from vedette.problem import Coverage

INTERVAL = 1.0  # least time between rounds [s]


@pytest.mark.parametrize("scheme", ["token", "fork", "jacobi"])
@settings(deadline=None, max_examples=15)
@given(n=st.integers(1, 8), seed=st.integers(0, 10**6))
def test_a_round_decides_what_negotiate_does_on_the_same_candidates_and_tree(
    scheme: str, n: int, seed: int
) -> None:
    tree = Tree.random(n, seed=seed)
    team, candidates, belief = toy_team(tree, seed, scheme)
    team.run_round()
    expected = negotiate(Coverage(), belief, candidates, tree, scheme, max_sweeps=12)
    assert team.decisions() == [1] * n
    assert team.choices() == expected.choice
    assert len({agent.rounds.stamp for agent in team.agents}) == 1
    assert len({toy(agent).fusion.digest for agent in team.agents}) == 1
    assert [agent.dropped for agent in team.agents] == [0] * n


@settings(deadline=None, max_examples=15)
@given(n=st.integers(1, 8), seed=st.integers(0, 10**6))
def test_an_asynchronous_round_ends_for_all_where_nobody_gains_alone(n: int, seed: int) -> None:
    team, candidates, belief = toy_team(Tree.random(n, seed=seed), seed, "async")
    team.run_round()
    assert team.decisions() == [1] * n
    assert [agent.dropped for agent in team.agents] == [0] * n
    chosen = [own[k] for own, k in zip(candidates, team.choices(), strict=True)]
    value = Coverage().value(belief, np.prod(chosen, axis=0))
    for i, own in enumerate(candidates):
        rest = np.prod([np.ones_like(belief), *chosen[:i], *chosen[i + 1 :]], axis=0)
        assert max(Coverage().value(belief, rest * other) for other in own) <= value + 1e-9


@pytest.mark.parametrize(("n", "scheme"), [(15, "token"), (16, "fork")])
def test_in_a_large_team_the_token_forks(n: int, scheme: str) -> None:
    tree = Tree.balanced(n)
    team, candidates, belief = toy_team(tree, 3, forks=True)
    team.run_round()
    expected = negotiate(Coverage(), belief, candidates, tree, scheme)
    assert team.decisions() == [1] * n
    assert team.choices() == expected.choice
    kinds = {nested_kind(post) for post in team.log}
    assert ("Fork" in kinds, "Token" in kinds) == (scheme == "fork", scheme == "token")


def test_a_later_round_starts_from_the_strategies_in_hand_and_keeps_an_equilibrium() -> None:
    team, _, _ = toy_team(Tree.random(5, seed=3), seed=3)
    team.run_round()
    first = team.choices()
    team.run(20.0)
    assert min(team.decisions()) >= 4
    assert team.choices() == first


def test_all_freeze_a_round_with_the_same_time_by_the_roots_clock() -> None:
    team, _, _ = toy_team(Tree.chain(5))
    team.run_round()
    [t0] = {t0 for agent in team.agents for t0 in toy(agent).frozen_at}
    [sent] = {post.time for post in team.log if nested_kind(post) == "Freeze" and post.sender == 0}
    assert 0.0 < t0 == round(sent, 3)  # to the millisecond


@pytest.mark.parametrize("worth", [1e-3, 1.0, 1e3])
def test_of_a_round_with_a_bound_its_value_over_that_is_kept_however_little_is_at_stake(worth: float) -> None:
    tree = Tree.chain(3)
    _, candidates, belief = toy_team(tree, 2)
    team = Team([toy_agent(i, own, worth * belief) for i, own in enumerate(candidates)], tree)
    team.run_round()
    agreed = negotiate(Coverage(), worth * belief, candidates, tree, max_sweeps=12)
    assert agreed.bound is not None
    for agent in team.agents:
        assert agent.rounds.bound_ratios == pytest.approx([agreed.value / agreed.bound])


@pytest.mark.parametrize("size", [1, 2, 7, 64])
def test_the_lower_a_robot_the_sooner_it_cuts_a_child_off_and_nobody_at_once(size: int) -> None:
    waits = [patience(size, depth) for depth in range(size + 2)]
    assert all(above >= below + 0.25 for above, below in pairwise(waits[:size]))
    assert min(waits) == pytest.approx(1.3)
    assert waits[0] == patience(size) == pytest.approx(1.0 + 0.3 * size)


@pytest.mark.parametrize("kind", ["Begin", "Flushed", "Freeze", "Gather", "Token", "Stop"])
@pytest.mark.parametrize("n", [2, 5])
def test_a_round_that_loses_a_message_ends_by_time_out_and_a_later_one_succeeds(kind: str, n: int) -> None:
    lost: list[Post] = []

    def lose_the_first(post: Post) -> bool:
        if nested_kind(post) != kind or lost:
            return False
        lost.append(post)
        return True

    team, _, _ = toy_team(Tree.chain(n), lose=lose_the_first)
    team.run(1.0)
    assert lost
    assert min(team.decisions()) == 0
    team.run(8.0)
    assert min(team.decisions()) >= 1


@pytest.mark.parametrize("kind", ["Up", "Down", "Stop"])
def test_a_jacobi_round_that_loses_a_message_is_followed_by_one_that_succeeds(kind: str) -> None:
    lost: list[Post] = []

    def lose_the_first(post: Post) -> bool:
        if nested_kind(post) == kind and not lost:
            lost.append(post)
            return True
        return False

    team, _, _ = toy_team(Tree.star(4), scheme="jacobi", lose=lose_the_first)
    team.run(1.0)
    assert lost
    assert min(team.decisions()) == 0
    team.run(8.0)
    assert min(team.decisions()) >= 1


def test_a_lost_call_is_repeated() -> None:
    team, _, _ = toy_team(Tree.chain(2), lose=lambda post: nested_kind(post) == "Call" and post.time < 3.0)
    team.run(1.5)
    before = team.decisions()[1]
    team.agents[1].rounds.want()
    team.run(3.0)
    calls = [p for p in team.log if nested_kind(p) == "Call"]
    assert len(calls) >= 2
    assert team.decisions()[1] > before


@pytest.mark.parametrize("victim", [0, 1, 3], ids=["root", "inner node", "leaf"])
@pytest.mark.parametrize("when", [0.05, 0.16, 0.3, 2.0])
def test_when_a_robot_dies_the_rest_goes_on_on_a_new_tree(victim: int, when: float) -> None:
    team, candidates, belief = toy_team(Tree.balanced(6), seed=9)
    team.run(when)
    team.alive[victim] = False
    team.run(1.0)
    living = [robot for robot in range(6) if robot != victim]
    before = team.decisions()
    for robot in living:
        toy(team.agents[robot]).strategy = None
    team.plant(Tree.balanced(5), living)
    team.run(4.0)
    assert all(team.decisions()[robot] > before[robot] for robot in living)
    expected = negotiate(Coverage(), belief, [candidates[robot] for robot in living], Tree.balanced(5))
    assert tuple(team.choices()[robot] for robot in living) == expected.choice


def test_without_a_new_tree_a_silent_child_is_cut_and_those_behind_it_keep_their_strategies() -> None:
    team, candidates, belief = toy_team(Tree.chain(3))
    team.run_round()
    chosen, before = team.choices(), team.decisions()
    team.alive[1] = False
    team.run(10.0)
    alone = Chooser(Coverage(), belief, candidates[0])
    alone.reply(Coverage().nothing(belief))
    assert team.decisions()[0] > before[0]
    assert team.agents[0].rounds.cuts >= 1
    assert team.choices() == (alone.index, *chosen[1:])


def test_who_says_what_makes_no_sense_in_a_round_is_not_waited_for() -> None:
    team, _, _ = toy_team(Tree.chain(2), lose=lambda post: nested_kind(post) == "Gather")
    team.run_until(lambda: any(nested_kind(post) == "Gather" for post in team.log))
    epoch, sequence = team.agents[0].rounds.stamp
    team.tell(0, Message(1, messages.encode(messages.Negotiate(epoch, sequence, b"?"))))
    team.run(0.3)
    assert team.agents[0].rounds.cuts == 1
    assert team.decisions() == [1, 0]


def test_messages_of_an_old_epoch_are_void() -> None:
    team, _, _ = toy_team(Tree.chain(3))
    team.run_round()
    old = [post for post in team.log if post.to == 1 and post.traffic is TrafficKind.NEGOTIATION]
    team.plant(Tree.chain(3), [0, 1, 2])
    agent = team.agents[1]
    decisions, stamp = agent.rounds.decisions, agent.rounds.stamp
    before = len(team.log)
    for post in old:
        team.tell(1, Message(post.sender, messages.encode(post.message)))
    said = [post for post in team.log[before:] if post.traffic is TrafficKind.NEGOTIATION]
    assert [type(post.message) for post in said if not isinstance(post.message, messages.Call)] == []
    assert (agent.rounds.decisions, agent.rounds.stamp, agent.dropped) == (decisions, stamp, 0)


def test_negotiation_messages_that_come_before_a_robot_is_prepared_are_not_lost() -> None:
    team, candidates, belief = toy_team(Tree.star(5), seed=4)
    team.run_round()
    kinds = [nested_kind(post) for post in team.log]
    assert kinds.index("Gather") < kinds.index("Token")
    assert team.choices() == negotiate(Coverage(), belief, candidates, Tree.star(5)).choice


def test_a_stuck_robots_call_is_answered_by_a_round_within_a_second_and_a_half() -> None:
    team, _, _ = toy_team(Tree.chain(3))
    for agent in team.agents:
        toy(agent).goals = [(2.0, 2.0)]
    team.run(1.2)
    before = team.decisions()
    team.tell(2, Stuck())
    assert toy(team.agents[2]).released == 1
    team.run(1.5)
    assert [after - b for after, b in zip(team.decisions(), before, strict=True)] == [1, 1, 1]
    assert toy(team.agents[2]).blocked[-2:] == [False, True]  # its mates count as obstacles once
    team.run(5.0)
    assert toy(team.agents[2]).blocked[-1] is False


def test_rounds_are_rate_limited_however_many_are_wanted() -> None:
    team, _, _ = toy_team(Tree.star(4))
    for _ in range(100):
        for agent in team.agents:
            agent.rounds.want()
        team.run(0.1)
    begun = sorted({post.time for post in team.log if nested_kind(post) == "Begin"})
    assert np.diff(begun).min() >= INTERVAL
    assert min(team.decisions()) >= 5


def finished_team(n: int = 3) -> Team:
    """A team for which nothing is worth anything."""
    team, _, belief = toy_team(Tree.chain(n))
    belief[:] = 0.0
    team.run(8.0)
    return team


def test_a_mission_ends_only_when_two_rounds_agree_that_nothing_is_worth_doing() -> None:
    team, _, belief = toy_team(Tree.chain(3))
    belief[:] = 0.0
    team.run_round()
    assert team.decisions() == [1, 1, 1]
    assert not any(agent.finished for agent in team.agents)
    team.run(6.0)
    assert all(agent.finished and agent.done for agent in team.agents)


def test_a_finished_team_exchanges_no_negotiation_messages() -> None:
    team = finished_team()
    quiet_from = team.now
    team.run(30.0)
    assert team.negotiation(since=quiet_from) == []


def test_a_finished_mission_goes_on_when_something_is_worth_doing_again() -> None:
    team = finished_team()
    for agent in team.agents:
        toy(agent).belief[:] = 1.0
        toy(agent).goals = [(2.0, 2.0)]
    team.agents[2].rounds.call(team.now)
    team.tell(0, Message(1, messages.encode(messages.Call(1))))
    team.run(2.0)
    assert not any(agent.finished or agent.done for agent in team.agents)


def test_a_finished_team_on_another_tree_agrees_once_more_and_has_finished() -> None:
    team = finished_team()
    before = team.decisions()
    team.plant(Tree.star(3), range(3))
    team.run(0.1)
    assert not any(agent.finished for agent in team.agents)
    team.run(4.0)
    assert all(agent.finished and agent.done for agent in team.agents)
    assert team.decisions() == [count + 1 for count in before]


def test_a_robot_with_something_put_off_keeps_the_mission_from_ending() -> None:
    team, _, belief = toy_team(Tree.chain(3))
    belief[:] = 0.0
    toy(team.agents[1]).put_off = True
    team.run(20.0)
    assert not team.agents[1].finished
    toy(team.agents[1]).put_off = False
    team.run(20.0)
    assert all(agent.finished for agent in team.agents)


def test_one_robot_that_missed_the_last_round_brings_the_others_to_another() -> None:
    cut = [False]
    team, _, belief = toy_team(Tree.chain(3), lose=lambda post: cut[0] and nested_kind(post) == "Stop")
    belief[:] = 0.0
    team.run_round()
    cut[0] = True
    team.run(1.9)
    assert {agent.finished for agent in team.agents} == {True, False}
    cut[0] = False
    team.run(20.0)
    assert all(agent.finished for agent in team.agents)


def test_a_robot_alone_decides_and_ends_without_a_message() -> None:
    team, candidates, belief = toy_team(Tree.chain(1))
    team.run_round()
    values = [float(belief @ (1.0 - miss)) for miss in candidates[0]]
    assert team.choices() == (int(np.argmax(values)),)
    belief[:] = 0.0
    team.run(12.0)
    assert team.agents[0].done
    assert team.log == []


def test_nothing_is_frozen_before_all_children_are_heard() -> None:
    team, _, _ = toy_team(Tree.chain(3))
    team.tell(1, Message(0, messages.encode(messages.Begin(1, 5, 1))))
    team.tell(1, Message(0, messages.encode(messages.Freeze(1, 5, 0, 0, 3))))
    assert team.agents[1].dropped == 1
    assert toy(team.agents[1]).frozen_at == []


@pytest.mark.parametrize(("apart", "taken"), [(-60.0, False), (-15.0, True), (15.0, True), (1e9, False)])
@pytest.mark.parametrize("beat", [0.0, 1.0])
def test_who_plans_on_beats_freezes_nothing_by_a_clock_that_is_far_from_its_own(
    beat: float, apart: float, taken: bool
) -> None:
    team, _, _ = toy_team(Tree.chain(2))
    team.now, agent = 100.0, team.agents[1]
    agent.rounds.pace = Pace(beat=beat)
    team.tell(1, Message(0, messages.encode(messages.Begin(1, 5, 1))))
    before = fingerprint(agent, frozenset({"dropped", "dropped_of"}))
    freeze = messages.Freeze(1, 5, round(1000.0 * (team.now + apart)), 0, 2)
    team.tell(1, Message(0, messages.encode(freeze)))
    taken = taken or beat == 0.0
    assert agent.dropped == (0 if taken else 1)
    assert (len(toy(agent).frozen_at) == 1) == taken
    assert (fingerprint(agent, frozenset({"dropped", "dropped_of"})) != before) == taken


def test_a_round_of_more_robots_than_the_team_has_is_not_frozen() -> None:
    """So many more could have claimed to see something."""
    team, _, _ = toy_team(Tree.chain(2))
    team.agents[1].rounds.admitted = 2
    team.tell(1, Message(0, messages.encode(messages.Begin(1, 5, 1))))
    for robots, frozen in ((3, 0), (2, 1)):
        team.tell(1, Message(0, messages.encode(messages.Freeze(1, 5, 0, 0, robots))))
        assert len(toy(team.agents[1]).frozen_at) == frozen
    assert team.agents[1].dropped == 1


def test_what_is_told_of_a_rounds_sweeps_and_worth_keeps_a_robots_own_figures_in_range() -> None:
    team, _, _ = toy_team(Tree.chain(2))
    told = Stop(RoundOutcome(1e100, 1e-300, 2**53, True))
    for sequence in (5, 6):
        team.tell(1, Message(0, messages.encode(messages.Begin(1, sequence, 1))))
        team.tell(1, Message(0, messages.encode(messages.Freeze(1, sequence, 0, 0, 2))))
        team.tell(1, JobDone((1, sequence)))
        data = encode(told, toy(team.agents[1]).codec)
        team.tell(1, Message(0, messages.encode(messages.Negotiate(1, sequence, data))))
    rounds = team.agents[1].rounds
    assert rounds.decisions == 2
    assert rounds.sweeps <= 2 * MAX_FORKS
    assert rounds.bound_ratios == [1.0, 1.0]
