"""What befalls a team that shares no frame: nothing is lost or counted twice, and no false edge stays."""

from __future__ import annotations

from itertools import permutations
from typing import cast

import numpy as np
import pytest

from tests.support.small_missions import robots, small_office
from vedette.fusion.frame_edges import EdgeKind, FrameEdge
from vedette.maps.transform import Transform
from vedette.missions.explore.frames.exploring import FramedExploring
from vedette.record.explore.observer import ExploreReport
from vedette.sim.explore.run import ExploreRun, prepare
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.faults.kinds import Crash, Partition, Restart, Schedule
from vedette.sim.framed import FramedRobots

SEED = 7


def team(n: int = 2, **setup: object) -> ExploreSimulation:
    given = ExploreSetup(seed=SEED, **{"frames": "unknown", "max_time": 400.0, **setup})  # type: ignore[arg-type]
    return prepare(small_office(seed=1), robots(n), given)


def framed(simulation: ExploreSimulation) -> list[FramedExploring]:
    return [cast(FramedExploring, mission) for mission in simulation.missions]


def check(report: ExploreReport, names: tuple[str, ...]) -> None:
    """The whole office is known to all, joined rightly, and nothing of it is wrong."""
    summary = report.summary
    assert summary.coverage is not None
    assert summary.coverage > 0.99
    assert summary.map_error_share < 0.01
    assert summary.frames is not None
    assert names in summary.frames.components
    assert all(join.error_m < 0.3 for join in summary.frames.joins)


def test_robots_join_over_links_that_lose_three_messages_in_ten() -> None:
    check(ExploreRun(team(link_loss=0.3)).run(), ("robot-1", "robot-2"))


def test_robots_that_were_parted_join_when_they_can_and_have_what_each_saw_meanwhile() -> None:
    parted = Partition(at=2.0, parts=((1,),), lasts=40.0)
    simulation = team(faults=Schedule((parted,)))
    run = ExploreRun(simulation)
    while simulation.now < 41.0:
        run.step()
    assert all(len(mission.frames.evidence.frames) == 1 for mission in framed(simulation))
    seen = [np.count_nonzero(mission.own.log_odds.window()) for mission in framed(simulation)]
    report = run.run()
    check(report, ("robot-1", "robot-2"))
    assert report.summary.frames is not None
    assert min(join.time_s for join in report.summary.frames.joins) > 40.0
    for mission in framed(simulation):
        known = np.count_nonzero(mission.fusion.classes.window())
        assert known > 0.99 * max(seen)


def test_of_a_robot_that_starts_anew_what_it_said_before_stays_and_its_new_frame_is_found() -> None:
    faults = Schedule((Crash(at=25.0, robot=2), Restart(at=30.0, robot=2)))
    simulation = team(faults=faults)
    check(ExploreRun(simulation).run(), ("robot-1", "robot-2"))
    first = framed(simulation)[0].frames
    assert len([key for key in first.graph if key[0] == 1]) == 2  # of both its starts
    assert len({placed.anchor for placed in first.graph.values()}) == 1


def test_an_injected_wrong_edge_however_heavy_bends_nothing() -> None:
    simulation = team()
    run = ExploreRun(simulation)
    while simulation.now < 30.0:
        run.step()
    one = framed(simulation)[1]
    a, b = framed(simulation)[0].frames.key, one.frames.key
    true = framed(simulation)[0].frames.own(1)
    assert true is not None
    wrong = FrameEdge(a, b, Transform(true.x + 2500, true.y, true.angle), 10**9)
    one.matcher.found[a, b] = wrong
    while simulation.now < 45.0:
        run.step()
    there = framed(simulation)[0].frames.own(1)
    assert there is None or there.apart(true, 0.0, 0.0)[0] < 0.3
    check(run.run(), ("robot-1", "robot-2"))


class Liar(FramedExploring):
    """Tells of false matches and meetings of everybody with everybody, each time others."""

    lies = 0

    @property
    def _edges(self) -> list[FrameEdge]:
        Liar.lies += 1
        rng = np.random.default_rng(Liar.lies // 20)
        return [
            FrameEdge(a, b, Transform(*rng.integers(0, 20_000, 3).tolist()), 10**9, kind)
            for a, b in permutations(self.frames.known, 2)
            for kind in EdgeKind
        ]


@pytest.mark.parametrize("liar", [0, 2])
def test_an_insiders_false_matches_and_meetings_join_nobody(liar: int) -> None:
    simulation = team(3)
    assert isinstance(simulation.robots, FramedRobots)
    framed(simulation)[liar].__class__ = Liar
    report = ExploreRun(simulation).run()
    honest = tuple(f"robot-{i + 1}" for i in range(3) if i != liar)
    summary = report.summary
    assert Liar.lies > 20
    assert summary.map_error_share < 0.01
    assert summary.coverage is not None
    assert summary.coverage > 0.99
    assert summary.frames is not None
    assert any(set(honest) <= set(names) for names in summary.frames.components)
    assert all(join.error_m < 0.3 for join in summary.frames.joins)
