"""Teams with members that misbehave, all of which follows from a seed: the others keep the laws and finish.

A failing team replays with ``python -m tests.support.bad_member MODE SEED``; ``--trace`` tells what happens.
``python -m tests.support.bad_member MODE FIRST LAST`` plays many, and the same teams with those members dead.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from tests.support import misbehaving
from tests.support.faulty_team import FaultyTeam, Plan
from tests.support.faulty_world import FRAME, Sites, check
from tests.support.mutants import BEACONS, FROM_ABOVE, FROM_BELOW, SCHEMES, Mutant, mutants_of
from tests.support.overlay_network import random_graph
from vedette.agent import Agent, NetworkedAgent
from vedette.outcome import Outcome
from vedette.sim.faults import Schedule

Program = Callable[..., NetworkedAgent]
Make = Callable[[np.random.Generator], Program]

MODES: Mapping[str, Make] = {
    "slow": lambda rng: partial(misbehaving.Slow, takes=misbehaving.delay_of(rng)),
    "hung": lambda rng: partial(misbehaving.Slow, takes=misbehaving.NEVER),
    "mute": lambda rng: misbehaving.Mute,
    "fickle": lambda rng: misbehaving.Fickle,
    "endless": lambda rng: misbehaving.Endless,
    "reborn": lambda rng: misbehaving.Reborn,
    "truncating": lambda rng: misbehaving.Truncating,
    "wrong map": lambda rng: misbehaving.Disagreeing,
    "echo": lambda rng: misbehaving.Echoing,
    "epoch": lambda rng: partial(misbehaving.Raising, epoch=2 ** int(rng.integers(20, 64)) - 2),
    "mates": lambda rng: partial(misbehaving.Beaconing, robots=1000, points=2),
    "flood": lambda rng: partial(misbehaving.Beaconing, robots=1, points=500),
}


LIES = frozenset({"truncating", "endless", "mates", "mutant"})  # the others cannot tell what is so


class BadTeam(FaultyTeam):
    """A team some of whose members misbehave; the laws are for the others."""

    def __init__(
        self,
        plan: Plan,
        bad: Mapping[int, Program],
        suffers: bool,
        forged: bool,
        beacons: bool = False,
        trace: bool = False,
    ) -> None:
        """Bring the team to life; ``bad``: the programs of those that misbehave.

        ``beacons``: all say where they are, which costs time, and matters here for what is said then alone.
        """
        self.bad, self.suffers, self.forged, self.beacons = bad, suffers, forged, beacons
        super().__init__(plan, trace)

    def _spawn(self, robot: int, boot: int) -> Agent:
        agent = super()._spawn(robot, boot)
        if self.beacons:
            agent.due["beacon"] = 0.0
        return agent

    def _program(self, i: int, agent: Agent, now: float, lease: float) -> NetworkedAgent:
        if i in self.bad:
            return self.bad[i](agent, now, lease=lease)
        return super()._program(i, agent, now, lease)

    def heard_by(self, part: Sequence[int]) -> Sequence[int]:
        """Return whose plans a part may know of: those of others too, by way of who misbehaves."""
        return self.honest

    @property
    def honest(self) -> list[int]:
        """The living members that behave."""
        return [i for i in self.living if i not in self.bad]


def plan_of(mode: str, seed: int) -> tuple[Plan, dict[int, Program]]:
    """Return a team of three to six without faults but for its bad members: one, or sometimes two."""
    rng = np.random.default_rng((seed, 11))
    n = int(rng.integers(3, 7))
    edges = random_graph(n, rng, float(rng.choice([0.0, 0.5, 2.0])))
    sites = Sites.random(n, int(rng.integers(n, 3 + 3 * n)), rng)
    places = rng.uniform(0.0, FRAME.cols * FRAME.resolution, (n, 2))
    bad = rng.choice(n, 1 + int(n > 4 and rng.random() < 0.3), replace=False).tolist()
    plan = replace(Plan.of(seed), edges=edges, sites=sites, places=places, lease=3.0, faults=Schedule(()))
    if mode == "mutant":
        (case,) = mutants_of([seed])
        scheme = str(rng.choice(SCHEMES.get(case.message, (plan.scheme,))))
        plan, bad = replace(plan, scheme=scheme), [sayer_of(case.message, n, bad[0])]
        others = [i for i in range(n) if i not in bad]
        return plan, {bad[0]: partial(Mutant, case=case, another=int(rng.choice(others)))}
    return plan, {i: misbehaving.Dead if mode == "dead" else MODES[mode](rng) for i in bad}


def sayer_of(message: str, robots: int, else_: int) -> int:
    """Return a member that has cause to say such messages: the highest number becomes the root."""
    if message in FROM_ABOVE:
        return robots - 1
    return else_ % (robots - 1) if message in FROM_BELOW else else_


def play(mode: str, seed: int, trace: bool = False) -> BadTeam:
    """Play one team to its end; a failure names the command that replays it."""
    plan, bad = plan_of(mode, seed)
    about = mutants_of([seed])[0].message if mode == "mutant" else ""
    team = BadTeam(plan, bad, mode in LIES, about == "Evidence", about in BEACONS, trace)
    try:
        outcome = team.run(lambda: None)
        check(outcome is Outcome.COMPLETE, "the mission does not end", outcome)
        team.check_end()
    except Exception as error:
        replay = f"replay: python -m tests.support.bad_member {mode} {seed} --trace"
        if mode == "mutant":
            replay += f"  ({mutants_of([seed])[0]})"
        raise AssertionError(
            f"{replay}\n  {sorted(bad)} of {plan.edges}\nat {team.now:.3f} s: {error}"
        ) from error
    return team


def compare(mode: str, first: int, last: int) -> str:
    """Play many teams; tell how many fail, how many a minute, and how late the others are."""
    began, ratios, failures = time.monotonic(), [], list[str]()
    for seed in range(first, last):
        try:
            ratios.append(play(mode, seed).now / play("dead", seed).now)
        except AssertionError as error:
            failures.append(str(error))
    rate = 60.0 * (last - first) / (time.monotonic() - began)
    late = f"{np.median(ratios):.2f} (p90 {np.quantile(ratios, 0.9):.2f})" if ratios else "-"
    told = f"{mode}: {last - first} teams, {len(failures)} failed, {rate:.0f} a minute"
    told += f"; {late} of the time with those members dead"
    return "\n".join([told, *failures])


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[3].isdigit():
        print(compare(sys.argv[1], int(sys.argv[2]), int(sys.argv[3])))
    else:
        played = play(sys.argv[1], int(sys.argv[2]), "--trace" in sys.argv)
        print(f"complete after {played.now:.1f} s; {played.round_law.rounds} rounds checked")
