"""Toy teams that sign, with one member that changes one field: the others finish, and accuse nobody honest.

A failing team replays with ``python -m tests.support.signed_team SEED``; ``--trace`` tells what happens.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import partial

import numpy as np

from tests.support import bad_member
from tests.support.bad_member import BadTeam, Program, sayer_of
from tests.support.faulty_team import Plan
from tests.support.faulty_world import FRAME, SPEED, check
from tests.support.mutants import Case
from tests.support.notaries import PlainNotary
from tests.support.signed_mutants import (
    CASES,
    MULTISTART,
    SIGNED_BEACON,
    SignedMutant,
    check_order,
    given_by_operator,
)
from vedette.agent import Agent, NetworkedAgent
from vedette.fusion.particulars import Capabilities
from vedette.fusion.signed import SignedEvidence
from vedette.negotiation import SCHEMES
from vedette.outcome import Outcome
from vedette.sim.network import Act

SEES = 2.0  # so far, at most, robots see sites [m]
PASSES = (
    "it is slow",
    "rounds go on without it",
    "no round gets anywhere by it",
)  # of links, and for a while


class SignedTeam(BadTeam):
    """A toy team with keys, and an order of the operator's that the member that misbehaves has been given."""

    def __init__(self, plan: Plan, bad: dict[int, Program], about: str, trace: bool = False) -> None:
        """Bring the team to life; ``about``: what is changed."""
        self.now = 0.0
        self.lives: dict[int, NetworkedAgent] = {}
        beacons = about in ("Vouched", SIGNED_BEACON)
        super().__init__(plan, bad, suffers=True, forged=False, beacons=beacons, trace=trace)

    def _fusion(self, robot: int, boot: int) -> SignedEvidence:
        fusion = SignedEvidence(
            robot,
            boot,
            FRAME.shape,
            len(self.sites.cells),
            notary=PlainNotary(robot, lambda: self.now),
            limits=Capabilities(FRAME.resolution, SEES, SPEED),
        )
        x, y = self.bodies.places[robot]
        fusion.set_out(int(y / FRAME.resolution), int(x / FRAME.resolution))
        return fusion

    def _spawn(self, robot: int, boot: int) -> Agent:
        agent = super()._spawn(robot, boot)
        agent.check_order = check_order
        if robot in self.bad:
            agent.orders.take(given_by_operator())
        return agent

    def _program(self, i: int, agent: Agent, now: float, lease: float) -> NetworkedAgent:
        self.lives[i] = super()._program(i, agent, now, lease)
        return self.lives[i]

    def _let(self, i: int, act: Act) -> None:
        super()._let(i, act)
        if i in self.honest:
            self._check_trust(self.network.agents[i])

    def _check_trust(self, agent: Agent) -> None:
        """Nobody honest is out, convicted, caught in an audit, or known for a word that was not taken."""
        signed, auditor = agent.signed, agent.rounds.scrutiny.auditor
        assert signed is not None
        assert auditor is not None
        accused = signed.out | signed.standing.said.keys() | auditor.caught.keys()
        wrongly = accused & set(self.honest)
        check(not wrongly, "somebody honest is accused", agent.robot, wrongly, agent.complaints)

    def check_end(self) -> None:
        """And nobody honest is named for good."""
        super().check_end()
        for i in self.honest:
            said = {k: what for k, what in self.lives[i].complaints.items() if k in self.honest}
            named = {k: what for k, what in said.items() if not what.startswith(PASSES)}
            check(not named, "somebody honest is named for good", i, named)


def case_of(seed: int) -> Case:
    """Return the case of a seed, spread over all."""
    return CASES[seed * 7919 % len(CASES)]


def plan_of(seed: int) -> tuple[Plan, dict[int, Program]]:
    """Return a team of three to six, one of which says what the seed says."""
    plan, bad = bad_member.plan_of("dead", seed)
    case, n, rng = case_of(seed), len(plan.places), np.random.default_rng((seed, 12))
    scheme = "multistart" if case.message in MULTISTART else str(rng.choice(SCHEMES))
    liar = sayer_of(case.message, n, min(bad))
    another = int(rng.choice([i for i in range(n) if i != liar]))
    program = partial(SignedMutant, case=case, another=another)
    return replace(plan, scheme=scheme), {liar: program}


def play(seed: int, trace: bool = False) -> SignedTeam:
    """Play one team to its end; a failure names the command that replays it."""
    plan, bad = plan_of(seed)
    team = SignedTeam(plan, bad, case_of(seed).message, trace)
    try:
        outcome = team.run(lambda: None)
        check(outcome is Outcome.COMPLETE, "the mission does not end", outcome)
        team.check_end()
    except Exception as error:
        replay = f"replay: python -m tests.support.signed_team {seed} --trace  ({case_of(seed)})"
        raise AssertionError(
            f"{replay}\n  {sorted(bad)} of {plan.edges}, {plan.scheme}\nat {team.now:.3f} s: {error}"
        ) from error
    return team


if __name__ == "__main__":
    played = play(int(sys.argv[1]), "--trace" in sys.argv)
    print(f"complete after {played.now:.1f} s")
