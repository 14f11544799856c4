"""Teams that go through faults, all of which follow from a seed, while every law is checked at every step.

A failing schedule replays with ``python -m tests.support.faulty_team SEED``; ``--trace`` tells what happens.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tests.support.faulty_laws import EvidenceLaw, RoundLaw, check_strategy, mission_of, versions_of
from tests.support.faulty_world import FRAME, LEAST_GAIN, Life, SiteMission, Sites, check
from tests.support.overlay_network import Edge, random_graph
from tests.support.site_team import PACE, SiteTeam
from vedette.agent import Agent, NetworkedAgent, State
from vedette.agent.patience import patience
from vedette.agent.round import Round
from vedette.agent.rounds import CALL_AGAIN
from vedette.negotiation import TokenNode
from vedette.outcome import Outcome
from vedette.sim.datagrams import Datagrams
from vedette.sim.faults import Schedule, faults_from_seed
from vedette.sim.network import Act
from vedette.sim.setup import Setup

FAULTY = 12.0  # then everything that can heal is healed [s]
LEASES = (2.0, 5.0)  # [s]: frozen robots are missed before they are cut from a round, or after it
ECHOES = 0.02  # share of datagrams that come again
LATEST_ECHO = 6.0  # after the datagram [s]
LOOK = 0.5  # robots that stand idle are looked for so often [s]
AT_MOST = 150.0  # a mission may last [s]


class EchoingDatagrams(Datagrams):
    """Some datagrams come again much later, when all that they are about is past."""

    def __init__(self, robots: int, rng: np.random.Generator) -> None:
        """Lose nothing."""
        super().__init__(robots, rng, (0.002, 0.02))

    def send(self, sender: int, to: int, payload: bytes, now: float) -> None:
        """Put a datagram under way, and perhaps an echo of it."""
        super().send(sender, to, payload, now)
        if self._chance() < ECHOES:
            super().send(sender, to, payload, now + LATEST_ECHO * self._chance())


@dataclass(frozen=True, eq=False)
class Plan:
    """A team and what befalls it."""

    seed: int
    edges: list[Edge]
    sites: Sites
    places: NDArray[np.float64]  # (n, 2) starts [m]
    scheme: str
    lease: float  # [s]
    faults: Schedule

    @classmethod
    def of(cls, seed: int) -> Plan:
        """Return the plan of a seed."""
        rng = np.random.default_rng((seed, 6))
        n = int(rng.integers(2, 9, size=2).min())  # small teams are cheap, and break as well
        edges = random_graph(n, rng, float(rng.choice([0.0, 0.3, 1.0])))
        sites = Sites.random(n, int(rng.integers(2, 3 + 3 * n)), rng)
        places = rng.uniform(0.0, FRAME.cols * FRAME.resolution, (n, 2))
        scheme = ("jacobi", "fork", "async", "token", "token")[int(5.0 * rng.random())]
        lease = float(rng.choice(LEASES))
        return cls(seed, edges, sites, places, scheme, lease, faults_from_seed(seed, n, FAULTY))


class FaultyTeam(SiteTeam):
    """A toy team; after whatever one of its agents does, all laws are checked."""

    suffers = False  # from somebody who says what is not so
    forged = False  # evidence among it

    def __init__(self, plan: Plan, trace: bool = False) -> None:
        """Bring the team to life."""
        self.plan, self.trace = plan, trace
        self.evidence = EvidenceLaw(plan.sites)
        self.missions: dict[Life, SiteMission] = {}
        self.round_law = RoundLaw(self.missions)
        self.idle_since = np.full(len(plan.places), np.inf)
        self.longest_idle = 0.0  # with something worth doing, after the healing [s]
        self._looked = 0.0
        self._healed: dict[Life, dict[Life, int]] | None = None  # what everybody held when all was healed
        super().__init__(
            plan.sites,
            plan.places,
            plan.edges,
            EchoingDatagrams(len(plan.places), np.random.default_rng((plan.seed, 7))),
            Setup(plan.scheme, plan.seed, AT_MOST, faults=plan.faults),
            lease=plan.lease,
            published=self.evidence.published,
            live=self._program,
        )

    def _program(self, i: int, agent: Agent, now: float, lease: float) -> NetworkedAgent:
        return NetworkedAgent(agent, now, lease=lease, admitted=len(self.plan.places))

    @property
    def honest(self) -> list[int]:
        """The living members that behave: all of them."""
        return self.living

    def _spawn(self, robot: int, boot: int) -> Agent:
        agent = super()._spawn(robot, boot)
        self.missions[robot, boot] = mission_of(agent)
        mission_of(agent).suffers = self.suffers
        return agent

    # -- what happens --------------------------------------------------------------------------------

    def _let(self, i: int, act: Act) -> None:
        rounds = self.network.agents[i].rounds
        seen, decisions, cuts = rounds.round, rounds.decisions, rounds.cuts
        turns, negotiator = _turns_in(seen), None if seen is None else seen.negotiator
        super()._let(i, act)
        agent = self.network.agents[i]
        mission = mission_of(agent)
        check(self.suffers or agent.dropped == 0, "an agent's message makes no sense to its neighbour", i)
        if rounds.cuts > cuts and mission.last is not None and seen is not None:
            self.round_law.cut.add((seen.tree.epoch, seen.sequence))
        if rounds.decisions > decisions:
            assert seen is not None
            if not self.suffers:
                self.round_law.decided(
                    mission, seen, ended=_turns_in(seen) > (turns if seen.negotiator is negotiator else 0)
                )
            self._say(f"{i} decides {mission.strategy} in {rounds.stamp}, quiet {agent.quiet}")
        if not self.forged and self.evidence.check(mission):
            self._say(f"{i} holds {versions_of(mission)}")
        if i in self.honest and not self.forged:
            check_strategy(agent, self.sites)

    def _tick(self) -> None:
        super()._tick()
        if self._healed is None and self.now >= FAULTY:
            self._healed = {mission.life: versions_of(mission) for mission in self._honest_missions()}
        if self._healed is not None and self.now >= self._looked + LOOK:
            self._looked = self.now
            self._check_idle()

    @property
    def over(self) -> Outcome | None:
        """How it ends, once all that was healed agree."""
        if self._healed is None:
            return None
        done = all(self.network.agents[i].done for i in self.honest)
        if done and all(self._agrees(part) and not self._wakes(part) for part in self.parts()):
            return Outcome.COMPLETE
        return Outcome.TIME_LIMIT if self.now >= AT_MOST else None

    def _agrees(self, part: Sequence[int]) -> bool:
        """Tell whether a part holds one map, and everybody all that anybody held when the faults ended.

        Equal maps alone do not say so: what a robot saw again after a restart changes none.
        """
        assert self._healed is not None
        missions = [self._mission(i) for i in part]
        held = [self._healed.get(mission.life, {}) for mission in missions]
        return len({mission.fusion.digest for mission in missions}) == 1 and all(
            versions_of(mission).get(life, 0) >= version
            for mission in missions
            for versions in held
            for life, version in versions.items()
        )

    def _wakes(self, part: Sequence[int]) -> bool:
        """Tell whether news has come to robots that were done, of work that they have yet to plan for.

        They have a while for that, and no longer: ``_check_idle``.
        """
        return any(self._worthwhile(i, part) for i in part)

    def _mission(self, i: int) -> SiteMission:
        return mission_of(self.network.agents[i])

    def _honest_missions(self) -> list[SiteMission]:
        return [self._mission(i) for i in self.honest]

    def _say(self, what: str) -> None:
        if self.trace:
            print(f"{self.now:8.3f} {what}")

    # -- what must hold ------------------------------------------------------------------------------

    def parts(self) -> list[list[int]]:
        """Return the living robots that behave, by who can reach whom by these alone."""
        left, parts = set(self.honest), []
        while left:
            part, ahead = [], [left.pop()]
            while ahead:
                part.append(i := ahead.pop())
                near = {b if a == i else a for a, b in self.plan.edges if i in (a, b)} & left
                left -= near
                ahead += near
            parts.append(sorted(part))
        return parts

    def _check_idle(self) -> None:
        """Nobody stands about for long while there is something worth doing."""
        for part in self.parts():
            allowed = tolerance(len(part), self.plan.lease)
            for i in part:
                agent = self.network.agents[i]
                if agent.state is State.DRIVING or not self._worthwhile(i, part):
                    self.idle_since[i] = np.inf
                    continue
                self.idle_since[i] = min(self.idle_since[i], self.now)
                idle = self.now - self.idle_since[i]
                self.longest_idle = max(self.longest_idle, idle)
                check(idle <= allowed, "a robot is idle for too long", i, agent.state, idle)

    def heard_by(self, part: Sequence[int]) -> Sequence[int]:
        """Return whose plans a part may know of: its own robots'."""
        return part

    def _worthwhile(self, i: int, part: Sequence[int]) -> bool:
        sites, mission = self.sites, self._mission(i)
        seen = sites.seen(mission.fusion.classes.window())
        ahead = sites.open_to(i, seen).tolist()
        if not ahead:
            return False
        left = 1.0 - seen
        for k in self.heard_by(part):
            if k != i and (site := self._mission(k).strategy) is not None:
                left *= sites.misses(*self.bodies.places[k], site)
        return any(
            float(left @ (1.0 - sites.misses(*self.bodies.places[i], site))) > LEAST_GAIN for site in ahead
        )

    def check_end(self) -> None:
        """All hold the same map, which nothing is missing from, and nothing reachable is left."""
        assert self._healed is not None
        for part in self.parts():
            for i in part:
                mission = self._mission(i)
                seen, now = self.sites.seen(mission.fusion.classes.window()), versions_of(mission)
                left = self.sites.open_to(i, seen)
                check(len(left) == 0, "the mission ends and leaves sites out", i, left)
                for k in part:
                    mate = self._mission(k)
                    check(bool((seen >= (mate.counts > 0)).all()), "what a robot saw is missing", i, k)
                    for life, version in self._healed.get(mate.life, {}).items():
                        check(now.get(life, 0) >= version, "evidence is missing", i, k, life)


def _turns_in(seen: Round | None) -> int:
    """Return how often a robot has had the token in a round: whoever ends a round does so in its turn."""
    return len(seen.negotiator.turns) if seen and isinstance(seen.negotiator, TokenNode) else 0


def tolerance(n: int, lease: float) -> float:
    """Return T: how long a robot may be idle after the last news that there is something to do [s].

    The robots that take the mission for finished wait for a call, which comes when a round is overdue and is
    repeated; the round before may have to be given up first, and cut from the next one somebody may be.
    """
    return lease + PACE.overdue + CALL_AGAIN + PACE.interval + 1.5 * patience(n) + patience(n)


def play(seed: int, trace: bool = False) -> FaultyTeam:
    """Play one schedule to its end; a failure names the command that replays it."""
    team = FaultyTeam(Plan.of(seed), trace)
    try:
        outcome = team.run(lambda: None)
        check(outcome is Outcome.COMPLETE, "the mission does not end", outcome)
        team.check_end()
    except Exception as error:
        faults = "\n  ".join(map(str, team.plan.faults.faults))
        replay = f"replay: python -m tests.support.faulty_team {seed} --trace"
        raise AssertionError(f"{replay}\n  {faults}\nat {team.now:.3f} s: {error}") from error
    return team


if __name__ == "__main__":
    played = play(int(sys.argv[1]), "--trace" in sys.argv)
    print(f"complete after {played.now:.1f} s; {played.round_law.rounds} rounds checked")
