"""Claims C1 and C2: what a platform has to know of the others, in general and if J is partially separable."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Sequence
from functools import reduce

import numpy as np

from vedette.negotiation import Tree
from vedette.problem import CountedCoverage, counted
from vedette_reproduction.content import Section, Verdict, table
from vedette_reproduction.links import sweep, team_on
from vedette_reproduction.run import ReproductionRun
from vedette_reproduction.teams import fixed_area

LN2 = float(np.log(2.0))
Ray = Sequence[int]  # cells in the order in which a beam crosses them


def c1(run: ReproductionRun) -> Section:
    """Two teams of equal combined impact and unequal J: in general the impacts do not tell J."""
    near, far = [0, 1, 2, 6], [5, 4, 3, 6]  # two ways to look at cell 6, through three unknown cells each
    teams = {"through the same cells": [near, near], "from opposite sides": [near, far]}
    rows = []
    for name, rays in teams.items():
        truth = miss_of(rays, 6)
        alone = [miss_of([ray], 6) for ray in rays]
        rows.append((name, alone[0], alone[1], alone[0] * alone[1], truth, expected_entropy(rays, 7)))
    misses = table(
        "c1_two_teams",
        "Two robots look at a cell behind three unknown cells: eq. (9) by enumeration of all 128 maps",
        (
            "team", "miss of robot 1", "miss of robot 2", "product (eq. (35))", "truth: both miss",
            "expected posterior entropy [nat]",
        ),
        rows,
    )  # fmt: skip
    terms = [(n, outcomes([range(4 * i, 4 * i + 4) for i in range(n)]), 4 * n * n) for n in (1, 2, 3, 4)]
    growth = table(
        "c1_terms",
        "Joint observations that eq. (9) sums over, for robots with a beam of four cells each",
        ("platforms", "joint observations", "products in the separable form"),
        terms,
    )
    same, apart = rows[0][4], rows[1][4]
    return Section(
        "c1",
        "C1: the general problem must be solved centrally, with every platform's models",
        "To evaluate the general objective (9), the motion and observation models of all platforms are "
        "needed.",
        (
            f"Both teams have the same impacts, {rows[0][1]:.3f} each for the cell behind, so anything "
            "computed from combined impacts is the same for both. But if the two look through the same "
            f"cells they miss together with probability {same:.3f}, from opposite sides with {apart:.3f}: "
            "to know which, one has to know the rays, that is the other's sensor and pose. So the general "
            "J is no function of combined miss probabilities.",
            "The same numbers show the price of the paper's own separable form: eq. (35) takes "
            f"{rows[0][3]:.3f} for both. Where rays cross the same unknown cells the product overstates "
            "what a team sees together; it never understates it (docs/mapping.md, section 3). And the "
            "number of joint observations multiplies with every platform. That nothing but a centre can "
            "cope is a figure of speech: all models could also be sent to all.",
        ),
        Verdict.HOLDS if same != apart else Verdict.FAILS,
        f"equal impacts, unequal J: both miss with {same:.3f} or {apart:.3f}; "
        f"{terms[0][1]} to {terms[-1][1]} joint observations for 1 to {terms[-1][0]} platforms",
        (misses, growth),
    )


def observation(ray: Ray, occupied: Sequence[bool]) -> tuple[int, ...]:
    """Return the cells that a beam observes: up to and with the first occupied one (paper, eq. (32))."""
    seen: list[int] = []
    for cell in ray:
        seen.append(cell)
        if occupied[cell]:
            break
    return tuple(seen)


def miss_of(rays: Sequence[Ray], cell: int) -> float:
    """Probability, over all maps of P = 1/2 a cell, that no beam observes a cell."""
    cells = 1 + max(max(ray) for ray in rays)
    maps = list(itertools.product((False, True), repeat=cells))
    return sum(all(cell not in observation(ray, one) for ray in rays) for one in maps) / len(maps)


def expected_entropy(rays: Sequence[Ray], cells: int) -> float:
    """``-J`` of eq. (9) [nat]: the mean over all maps of the entropy of those that look the same."""
    alike: Counter[tuple[tuple[int, bool], ...]] = Counter()
    for one in itertools.product((False, True), repeat=cells):
        alike[_joint(rays, one)] += 1
    return float(sum(count * np.log(count) for count in alike.values()) / 2.0**cells)


def outcomes(rays: Sequence[Ray]) -> int:
    """Count the joint observations that some map makes."""
    cells = 1 + max(max(ray) for ray in rays)
    return len({_joint(rays, one) for one in itertools.product((False, True), repeat=cells)})


def _joint(rays: Sequence[Ray], occupied: Sequence[bool]) -> tuple[tuple[int, bool], ...]:
    seen = {cell for ray in rays for cell in observation(ray, occupied)}
    return tuple((cell, occupied[cell]) for cell in sorted(seen))


def c2(run: ReproductionRun) -> Section:
    """Replace all team-mates by one platform of the same combined impact: nobody can tell."""
    objective = CountedCoverage()
    trials = 5 * run.scale.trials
    same_reply = same_words = 0
    for k in range(trials):
        rng = run.rng(102, k)
        n = int(rng.integers(3, 12))
        team = fixed_area(n, rng)
        candidates = [[counted(miss) for miss in own] for own in team.candidates]
        start = rng.integers(0, [len(own) for own in candidates]).tolist()
        many = team_on(tree := Tree.random(n, seed=rng), objective, team.weights, candidates, start)
        sweep(many, tree)
        i = int(rng.integers(n))
        rest = reduce(objective.combine, [candidates[j][start[j]] for j in range(n) if j != i])
        pair = [candidates[i], [rest]]
        one = team_on(Tree.chain(2), objective, team.weights, pair, [start[i], 0])
        sweep(one, Tree.chain(2))
        heard = [member.links.others() for member in (many[i], one[0])]
        same_words += bool(np.array_equal(*heard))
        for member, others in zip((many[i], one[0]), heard, strict=True):
            member.seat.reply(others)
        same_reply += many[i].seat.index == one[0].seat.index
    rows = [(trials, same_words, same_reply)]
    holds = same_reply == same_words == trials
    return Section(
        "c2",
        "C2: each platform needs only the rest of the team's combined impact",
        "Partially separable objectives abstract the number and the models of the other platforms away: "
        "how many they are, how they sense and move, even their single impacts are irrelevant.",
        (
            f"{trials} random teams of 3 to 11 platforms on random trees. One platform replied once within "
            "its team, and once with a single made-up platform in place of all others, whose impact is "
            "their combination. What it held of the rest of the team was the same to the last bit, and so "
            "was its reply.",
            "A limit: the messages of this code also carry sums for the bound and the value (and the token "
            "the number of platforms, to know when all are content). No reply depends on them, but a "
            "curious platform could learn the size of its team.",
        ),
        Verdict.HOLDS if holds else Verdict.FAILS,
        f"{same_words} of {trials} rests of the team and {same_reply} of {trials} replies identical",
        (
            table(
                "c2_anonymity",
                "All team-mates replaced by one of the same impact",
                ("teams", "same rest of the team", "same reply"),
                rows,
            ),
        ),
    )
