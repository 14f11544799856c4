"""An insider in a team that shares no frame: its false matches join nobody, its lies spoil nobody's map."""

from __future__ import annotations

from functools import cache
from typing import Any, cast

import numpy as np
import pytest

from tests.support.lies import Claims, Far, Free, Occupied
from tests.support.notaries import PlainNotary
from tests.support.small_missions import robots, small_office
from vedette.agent import Agent
from vedette.fusion.frame_edges import FrameEdge
from vedette.maps.transform import TURN, Transform
from vedette.missions.explore.assemble import assemble
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.frames.exploring import FramedExploring
from vedette.outcome import Outcome
from vedette.record.explore.score import map_errors
from vedette.sim.explore.frames import FrameWatch
from vedette.sim.explore.run import views
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.framed import FramedRobots
from vedette.sim.starts import choose_starts
from vedette.team import Most

LIAR = 2
HEAVY = 1 << 40  # what it says of its matches [cm]


class FalseMatches(FramedExploring):
    """Maps as it should, and tells of every pair a match that there is not."""

    @property
    def _edges(self) -> list[FrameEdge]:
        keys = self.frames.known
        rng = np.random.default_rng(5)  # the same all the time
        pairs = [(a, b) for a in keys for b in keys if a < b]
        places = [(*rng.integers(-9000, 9000, 2).tolist(), int(rng.integers(TURN))) for _ in pairs]
        return [FrameEdge(a, b, Transform(*at), HEAVY) for (a, b), at in zip(pairs, places, strict=True)]


class FramedOccupied(Occupied, FramedExploring):
    """Everything is a wall."""


class FramedFree(Free, FramedExploring):
    """There are no walls."""


class FramedClaims(Claims, FramedExploring):
    """It will soon see the whole of what is worth most."""


class FreeClaims(Claims, FramedFree):
    """The same, where there are no walls, and it shows what it claims."""


class FramedFar(Far, FramedExploring):
    """There is a free place far away."""


class Insider(ExploreSimulation):
    """A team of three that signs and shares no frame, whose last one is an insider."""

    def __init__(self, liar: type[Exploring], seconds: float) -> None:
        self.liar, self.now = liar, 0.0
        self.named: set[int] = set()  # of whom somebody honest has complained
        world, specs = small_office(7), robots(3)
        starts = choose_starts(world, specs, np.random.default_rng([7, 1]), None)
        super().__init__(world, specs, starts, ExploreSetup(seed=7, frames="unknown", max_time=seconds))
        frames = cast(FramedRobots, self.robots).frames
        self.watch = FrameWatch(self, [spec.name for spec in specs], frames)

    def _explorer(self, robot: int, boot: int) -> Agent:
        how: dict[str, Any] = {"explorer": self.liar} if robot == LIAR else {}
        team = self.lattice, self.specs[robot], self.setup.options, robot, boot
        notary = PlainNotary(robot, lambda: self.now)
        return assemble(*team, robots=3, most=Most.of(self.specs), notary=notary, **how)

    @property
    def over(self) -> Outcome | None:
        """When the honest are done."""
        done = all(self.network.agents[i].done for i in range(LIAR))
        return Outcome.COMPLETE if done else super().over

    def look(self) -> None:
        """Note who is joined, and whom the honest complain of."""
        self.found = self.watch.look()
        for agent in self.network.agents[:LIAR]:
            self.named |= agent.complaints.keys()


def played(liar: type[Exploring], seconds: float) -> Insider:
    """Play a mission; check what must hold whatever the insider says."""
    team = Insider(liar, seconds)
    team.run(team.look, 2.0)
    assert team.named <= {LIAR}
    first, second = (cast(FramedExploring, mission) for mission in team.missions[:LIAR])
    assert first.frames.own(1) is not None
    assert second.frames.own(0) is not None
    assert team.found is not None
    for join in team.found.joins:
        if "robot-3" not in join.robots or liar is FalseMatches:
            assert join.error_m < 0.15
            assert join.error_deg < 1.5
    assert first.signed is not None
    assert first.signed.out <= {LIAR}
    for view in views(team)[:LIAR]:
        wrong, known = map_errors(team.world, np.where(_looked(team), view.classes_on(team.world.frame), 0))
        assert wrong <= 0.01 * known
    return team


def _looked(team: Insider) -> Any:
    """Return ``(R, C)`` where the honest have looked themselves."""
    return np.logical_or.reduce([view.seen_on(team.world.frame) for view in views(team)[:LIAR]])


def test_an_insiders_false_matches_join_nobody_and_it_is_named() -> None:
    team = played(FalseMatches, 120.0)
    assert team.named == {LIAR}
    told = team.missions[0].fusion.told[team.network.agents[LIAR].robot, team.network.agents[LIAR].boot]  # type: ignore[attr-defined]
    assert any(edge.weight == HEAVY for edge in told)


@pytest.mark.slow
@pytest.mark.parametrize("liar", [FramedOccupied, FramedFree])
def test_what_an_insider_says_of_walls_spoils_nobodys_map_and_nobody_honest_is_named(
    liar: type[Exploring],
) -> None:
    played(liar, 120.0)


@cache
def without() -> float:
    """Return when the others are done where the insider is dead from the beginning [s]."""
    team = Insider(FramedExploring, 300.0)
    team.field.kill(LIAR)
    team.network.killed(LIAR, 0.0)
    assert team.run(team.look, 2.0) is Outcome.COMPLETE
    return team.now


@pytest.mark.parametrize(
    "liar",
    [
        FreeClaims,
        *(
            pytest.param(each, marks=pytest.mark.slow)
            for each in (FramedFree, FramedOccupied, FramedFar, FramedClaims)
        ),
    ],
)
def test_what_an_insider_claims_of_a_map_of_its_own_keeps_nobody_else_at_work(liar: type[Exploring]) -> None:
    team = Insider(liar, 300.0)
    assert team.run(team.look, 2.0) is Outcome.COMPLETE
    assert team.now <= 1.2 * without()
    for agent, view in zip(team.network.agents[:LIAR], views(team), strict=False):
        assert agent.ending in (Outcome.COMPLETE, Outcome.UNJOINED)
        assert agent.signed is not None
        assert agent.signed.out <= {LIAR}
        seen = np.where(_looked(team), view.classes_on(team.world.frame), 0)
        wrong, known = map_errors(team.world, seen)
        assert wrong <= 0.01 * known
        assert known > 0.9 * np.count_nonzero(~team.world.solid)
