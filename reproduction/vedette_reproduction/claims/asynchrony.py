"""Claim C9: any order of messages, any tree, stale replies, and a ring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from vedette.negotiation import Tree
from vedette.problem import CountedCoverage, Coverage, counted
from vedette_reproduction.content import Section, Table, judge, table
from vedette_reproduction.links import Member, members_of, team_on, tell
from vedette_reproduction.post import record
from vedette_reproduction.run import ReproductionRun
from vedette_reproduction.teams import Team, constant_density, fixed_area

Float = NDArray[np.float64]
LAPS = 40  # of news around a ring
_ROUNDING = 1e-12  # of values


def c9(run: ReproductionRun) -> Section:
    """Deliver in any order on any tree; let everybody reply whenever they like; close a ring."""
    order = _orders(run)
    stale = _stale(run)
    ring = _ring()
    exact, same, trials = (int(value or 0) for value in order.rows[0][1:4][::-1])
    fell, guarded = (float(row[2] or 0) for row in stale.rows)
    changes, of_token = int(stale.rows[1][1] or 0), float(stale.rows[1][5] or 0)
    confirmed = (
        f"scheme `async` confirms each change before it counts: {100 * guarded:.1f} % of {changes} lower it, "
        f"{stale.rows[1][3]} of {stale.rows[1][4]} teams settle, at {of_token:.3f} of the token's value"
    )
    return Section(
        "c9",
        "C9: asynchronous updates over an arbitrary acyclic network are possible",
        "The algorithm as presented needs a synchronous chain; it can be extended to asynchronous updates "
        "over an arbitrary acyclic network. (Left for future work.)",
        (
            f"On {trials} random trees, with messages of different links delivered in random order, the "
            f"rest of the team was exact for everybody in {exact}, certain sightings included, and both "
            f"schemes ended with the same choices as in order in {same}. So neither a chain nor synchrony "
            "of the links is needed: a platform waits for what it needs.",
            "Truly asynchronous updates, where everybody replies whenever they like to the last they "
            f"heard, also run, but the value may fall: {100 * fell:.1f} % of the changes lowered it, as two "
            "that move at once each count on the other's old place. Once replies stop, what everybody "
            "holds is exact again after each link has carried a message. The token avoids the fall by "
            f"letting one platform reply at a time; {confirmed}.",
            "Acyclic it must be: on a ring of four, news comes back as if it were somebody else's, is "
            "multiplied in again, and the probability that the team misses a cell decays to 0 by itself.",
        ),
        judge(same == exact == trials and guarded == 0.0, fell == 0.0),
        f"{same} of {trials} shuffled rounds end alike, leave-one-out exact in {exact}; stale replies: "
        f"{100 * fell:.1f} % of changes lower J; on a ring a miss of {ring.rows[-1][2]} becomes "
        f"{float(ring.rows[-1][1] or 0):.2g}",
        (order, stale, ring),
        but=f"messages may come in any order; replies at any time lower J in {100 * fell:.1f} % of changes; "
        + confirmed,
    )


def _orders(run: ReproductionRun) -> Table:
    """Compare shuffled with ordered delivery, and what everybody holds in the end with brute force."""
    same = exact = 0
    trials = 2 * run.scale.trials
    for k in range(trials):
        rng = run.rng(109, k)
        n = int(rng.integers(2, 16))
        team = constant_density(n, rng)
        tree = Tree.random(n, seed=rng)
        args = (Coverage(), [team.weights], team.candidates, tree)
        alike = True
        for scheme in ("token", "jacobi"):
            ordered = record(*args, scheme, max_sweeps=20)
            shuffled = record(*args, scheme, max_sweeps=20, shuffle=rng)
            alike &= ordered.choice == shuffled.choice
        same += alike
        exact += leave_one_out_is_exact(n, tree, rng)
    return table(
        "c9_order",
        "Random trees of 2 to 15 platforms, deliveries in random order",
        ("what", "trees", "same choices, token and paper's scheme", "leave-one-out exact"),
        [("random order", trials, same, exact)],
    )


def leave_one_out_is_exact(n: int, tree: Tree, rng: np.random.Generator) -> bool:
    """Send everybody's impact over random links until nothing is news, and compare with brute force."""
    objective = CountedCoverage()
    misses = rng.uniform(size=(n, 12))
    misses[rng.uniform(size=misses.shape) < 0.3] = 0.0
    impacts = [counted(miss) for miss in misses]
    members = team_on(tree, objective, np.ones(12), [[impact] for impact in impacts], [0] * n)
    ways = [(i, k) for i in range(n) for k in tree.neighbours(i)]
    for _ in range(n):  # news travels at least one link a lap
        for way in rng.permutation(len(ways)):
            tell(members, *ways[way])
    rest = [reduce(objective.combine, [impacts[j] for j in range(n) if j != i]) for i in range(n)]
    return all(np.array_equal(member.links.others(), rest[i]) for i, member in enumerate(members))


def _stale(run: ReproductionRun) -> Table:
    """Reply at any time to what links have carried in random order, unconfirmed and confirmed."""
    columns = (
        "changes", "changes of strategy", "share that lowers the value", "teams that settled", "of",
        "value, of the token's", "least",
    )  # fmt: skip
    loose, confirmed = zip(*(_stale_team(run.rng(109, 1, k)) for k in range(run.scale.trials)), strict=True)
    rows = [
        ("count at once, a reply to four deliveries", *_summary(loose)),
        ("count once confirmed, scheme async", *_summary(confirmed)),
    ]
    return table("c9_stale", "10 platforms reply whenever they like to what they last heard", columns, rows)


@dataclass(frozen=True)
class _Run:
    """What one team did."""

    changes: int
    falls: int  # of those, how many lowered the value
    settled: bool
    of_token: float  # value in the end


def _summary(runs: Sequence[_Run]) -> tuple[int, float, int, int, float, float]:
    changes = sum(each.changes for each in runs)
    values = [each.of_token for each in runs]
    return (
        changes,
        sum(each.falls for each in runs) / changes,
        sum(each.settled for each in runs),
        len(runs),
        float(np.mean(values)),
        min(values),
    )


def _stale_team(rng: np.random.Generator) -> tuple[_Run, _Run]:
    """Let one team reply at any time, without and with confirmation."""
    team, tree = fixed_area(10, rng), Tree.random(10, seed=rng)
    start = rng.integers(6, size=10).tolist()
    args = (Coverage(), [team.weights], team.candidates, tree)
    token = record(*args, "token", start=start).outcome.value
    loose = _at_any_time(team, tree, start, token, rng)
    confirmed = record(*args, "async", start=start, shuffle=rng)
    steps = np.diff(confirmed.values)
    outcome = confirmed.outcome
    falls = int((steps < -_ROUNDING).sum())
    return loose, _Run(len(steps), falls, outcome.converged, outcome.value / token)


def _at_any_time(team: Team, tree: Tree, start: list[int], token: float, rng: np.random.Generator) -> _Run:
    """Let platforms reply and links carry news at random: how often does a change lower the value?"""
    objective = Coverage()
    members = team_on(tree, objective, team.weights, team.candidates, start)
    ways = [(i, j) for i in range(10) for j in tree.neighbours(i)]
    before = _value(objective, team.weights, members)
    changes = falls = quiet = 0
    for _ in range(2000):
        tell(members, *ways[int(rng.integers(len(ways)))])
        i = int(rng.integers(10))
        if rng.uniform() < 0.25:
            quiet += 1
            if members[i].seat.reply(members[i].links.others()):
                members[i].links.changed()
                now = _value(objective, team.weights, members)
                changes, falls, quiet = changes + 1, falls + (now < before - _ROUNDING), 0
                before = now
    return _Run(changes, falls, quiet > 100, before / token)


def _value(objective: Coverage, weights: Float, members: Sequence[Member]) -> float:
    return objective.value(weights, reduce(objective.combine, [member.seat.impact for member in members]))


def _ring() -> Table:
    """Let four platforms on a ring pass on what they hear: what the first takes the others to miss."""
    objective = Coverage()
    near = [(3, 1), (0, 2), (1, 3), (2, 0)]
    misses = [[np.array([0.5 if i == 2 else 1.0])] for i in range(4)]  # only the platform opposite looks
    members = members_of(objective, np.ones(1), misses, near, [0] * 4)
    rows = []
    for lap in range(LAPS + 1):
        if lap % 8 == 0:
            rows.append((lap, float(members[0].links.others()[0]), 0.5))
        for i in range(4):
            for k in near[i]:
                tell(members, i, k)
    return table(
        "c9_ring", "A ring of four, one platform of miss 0.5", ("laps", "held by another", "truth"), rows
    )
