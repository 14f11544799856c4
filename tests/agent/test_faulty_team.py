"""Fault schedules: no round is mixed with another, nothing seen is lost, nobody stands idle for good."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.support.faulty_laws import EvidenceLaw, mission_of
from tests.support.faulty_team import AT_MOST, FaultyTeam, Plan, play
from tests.support.faulty_world import FRAME, Impact, LawBroken, SiteMission, Sites
from tests.support.overlay_network import random_graph
from tests.support.site_team import SiteTeam
from vedette.fusion import ReplicatedEvidence
from vedette.outcome import Outcome
from vedette.sim.datagrams import Datagrams
from vedette.sim.faults import Schedule
from vedette.sim.faults.kinds import Crash, FreezeFault, Heal, Partition
from vedette.sim.setup import Setup

SCHEDULES, BATCH = 200, 20
ALL, SLOW_BATCH = 5000, 50


@pytest.mark.parametrize("first", range(0, SCHEDULES, BATCH))
def test_no_faults_break_a_law(first: int) -> None:
    for seed in range(first, first + BATCH):
        play(seed)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(SCHEDULES, ALL, SLOW_BATCH))
def test_thousands_of_fault_schedules_break_no_law(first: int) -> None:
    for seed in range(first, first + SLOW_BATCH):
        play(seed)


def test_a_schedule_is_the_same_every_time() -> None:
    first, second = play(17), play(17)
    assert first.now == second.now
    assert first.bodies.places == second.bodies.places
    assert first.network.bytes_sent == second.network.bytes_sent


# -- single faults -----------------------------------------------------------------------------------


def two(faults: Schedule, before: list[int], allowed: list[list[bool]]) -> FaultyTeam:
    """Robots 0 and 1 beside each other, sites in a row ahead of them."""
    sites = Sites(np.arange(len(before)) * 8 + 400, np.array(before), np.array(allowed))
    places = np.array([(1.0, 5.0), (1.0, 6.0)])
    return FaultyTeam(
        replace(Plan.of(0), edges=[(0, 1)], sites=sites, places=places, scheme="token", faults=faults)
    )


def test_who_has_finished_alone_goes_on_when_others_come_who_know_more() -> None:
    apart = Schedule((Partition(at=0.0, parts=((1,), (2,))), Heal(at=11.0)))
    team = two(apart, before=[-1, 0], allowed=[[False, True], [True, False]])
    done = []
    team.run(lambda: done.append([agent.done for agent in team.agents]), period=0.5)
    assert [True, True] in done[: done.index([False, False], 20)]  # each had finished by itself
    team.check_end()
    assert mission_of(team.agents[0]).counts.tolist() == [0, 1]


def test_what_a_crashed_robot_has_told_is_kept_and_what_only_it_could_reach_is_left() -> None:
    crash = Schedule((Crash(at=8.0, robot=2),))
    team = two(crash, before=[-1, -1, 1, 2, 3], allowed=[[True] * 5, [True] * 5])
    assert team.run(lambda: None) is Outcome.COMPLETE
    team.check_end()
    alone = two(crash, before=[-1, 0, 1, 2, 3], allowed=[[False] * 5, [True] * 5])
    assert alone.run(lambda: None) is Outcome.COMPLETE
    seen = alone.sites.seen(mission_of(alone.agents[0]).fusion.classes.window())
    assert 0 < seen.sum() < 5


def test_a_robot_that_freezes_for_long_takes_up_its_work_again() -> None:
    freeze = Schedule((FreezeFault(at=3.0, robot=1, lasts=9.5),))
    team = two(freeze, before=[-1, 0, 1], allowed=[[True] * 3, [False] * 3])
    assert team.run(lambda: None) is Outcome.COMPLETE
    team.check_end()
    assert team.now > 12.5


# -- the laws see what they are to see ---------------------------------------------------------------


def test_impacts_of_two_rounds_or_of_one_robot_twice_are_not_combined() -> None:
    miss = np.ones(2)
    one = Impact(miss, frozenset({(0, 1)}), (5, 1))
    assert one.joined(Impact(miss, frozenset({(1, 1)}), (5, 1))).who == {(0, 1), (1, 1)}
    for other in (Impact(miss, frozenset({(1, 1)}), (5, 2)), Impact(miss, frozenset({(0, 1)}), (5, 1))):
        with pytest.raises(LawBroken):
            one.joined(other)


def test_evidence_that_is_forgotten_or_counted_twice_is_noticed() -> None:
    sites = Sites(np.array([10, 20]), np.array([-1, -1]), np.ones((1, 2), np.bool_))
    law = EvidenceLaw(sites)
    fusion = ReplicatedEvidence(0, 1, FRAME.shape, 2)
    mission = SiteMission((0, 1), sites, fusion, law.published)
    mission._dirty.append(10)
    mission.own.put(np.array([10]), np.array([-10], np.int8))
    mission.counts[0] = 1
    mission.publish(0.0)
    assert law.check(mission)
    assert not law.check(mission)
    fusion.counts += 1
    fusion._contributors.own.version += 1
    law.published((0, 1), 2, mission.own.window(), mission.counts)
    with pytest.raises(LawBroken, match="counted twice"):
        law.check(mission)
    fusion._contributors.own.version -= 2
    with pytest.raises(LawBroken, match="lost"):
        law.check(mission)


# -- scale -------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_thousand_agents_form_one_tree_and_decide_together() -> None:
    team = big_team(1000)
    team.run(lambda: None)
    assert {agent.rounds.tree.size for agent in team.agents} == {1000}
    assert len({agent.rounds.stamp for agent in team.agents}) == 1
    whole = [mission.whole for agent in team.agents if (mission := mission_of(agent)).whole is not None]
    assert max(len(impact.who) for impact in whole) == 1000


def big_team(n: int) -> BigTeam:
    """A random graph whose links are short, and robots that stand still."""
    rng = np.random.default_rng(1)
    sites = replace(Sites.random(n, 48, rng), before=np.full(48, -1))
    places = rng.uniform(0.0, 20.0, (n, 2))
    edges = random_graph(n, rng, extra=0.5)
    datagrams = Datagrams(n, rng, (0.0005, 0.001))
    setup = Setup(max_time=AT_MOST, faults=Schedule(()))
    return BigTeam(sites, places, edges, datagrams, setup, lease=3.0, published=lambda *_: None)


class BigTeam(SiteTeam):
    """Ends once everybody has decided in one round."""

    @property
    def over(self) -> Outcome | None:
        """Told by the agents."""
        first = self.agents[0].rounds
        if self.now >= self.setup.max_time:
            return Outcome.TIME_LIMIT
        together = all(
            a.rounds.stamp == first.stamp and a.rounds.decisions and not a.rounds.busy for a in self.agents
        )
        return Outcome.COMPLETE if together and first.tree.size == len(self.agents) else None
