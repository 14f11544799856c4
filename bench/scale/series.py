"""The rows of the table: one team size after another, for each domain, area and tree."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from bench.scale import mapping, monitoring, search, tracking, trees
from bench.scale.edges import whole_sizes
from bench.scale.post import Tally, run_round
from bench.scale.team import Lots, Team
from vedette.negotiation import Tree

SIZES = tuple(2**k for k in range(1, 11))
QUICK_SIZES = (4, 16, 64)
FIXED_FROM, DENSE_FROM = 16, 256  # sizes that the largest is judged against: area covered; mostly middle
FIXED, SQUARE, STRIP = "fixed", "square", "strip"  # the area stays; grows both ways; grows one way
WHOLE_UP_TO = 32  # rounds with whole messages over an area that grows are not run beyond
MOST_SWEEPS = 20
ROUNDS = 16  # platforms times repeats: small teams negotiate again, and each platform's least time counts
LONGEST = 20.0  # a round that is expected to take longer is not run [s of CPU time]
SEED = 0


class Domain(Protocol):
    """A module that makes teams."""

    @property
    def LOT(self) -> float:
        """Side of a platform's lot where density is constant [m]."""

    def fixed(self, n: int, rng: np.random.Generator) -> Team:
        """Return n platforms in a fixed area."""

    def dense(self, lots: Lots, rng: np.random.Generator) -> Team:
        """Return a platform a lot."""


DOMAINS: dict[str, Domain] = {
    "mapping": mapping,
    "tracking": tracking,
    "search": search,
    "monitoring": monitoring,
}


@dataclass(frozen=True)
class Row:
    """One team on one tree; where figures are a sweep's, the gathering and the stop count as one more."""

    domain: str
    area: str
    tree: str
    clipped: bool  # messages leave out what their receivers cannot reach
    n: int
    sweeps: int
    converged: bool
    value: float
    share: float  # of the bound
    cpu_median: float  # a platform and sweep [ms]
    cpu_mean: float
    cpu_hub: float
    messages_mean: float  # a platform and sweep
    messages_most: float  # of any but the hub, the platform with most neighbours
    messages_hub: float
    bytes_mean: float  # a platform and sweep
    bytes_most: float
    bytes_hub: float
    edge_median: float  # impact that went over a link last, each way [bytes]
    edge_largest: float
    bound: int  # no impact on this belief takes more [bytes]
    whole_median: float | None = None  # the same if nothing were left out
    whole_largest: float | None = None


def rows(names: Sequence[str], sizes: Sequence[int], progress: Callable[[str], None]) -> Iterator[Row]:
    """Yield all rows of some domains, one after the other."""
    for name in names:
        domain = DOMAINS[name]
        crowd = domain.fixed(max(sizes), np.random.default_rng(SEED))
        for tree in trees.TREES:
            progress(f"scale: {name}, fixed area, {tree}")
            yield from _series(name, FIXED, tree, [(crowd.first(n), False) for n in sizes])
        for area, layout, names in ((SQUARE, Lots.square, trees.TREES), (STRIP, Lots.strip, ("chain",))):
            progress(f"scale: {name}, {area} of constant density, making the teams")
            teams = [domain.dense(layout(n, domain.LOT), np.random.default_rng(SEED)) for n in sizes]
            for tree in names:
                progress(f"scale: {name}, {area} of constant density, {tree}")
                small = [(team, False) for team in teams if len(team) <= WHOLE_UP_TO]
                yield from _series(name, area, tree, small)
                yield from _series(name, area, tree, [(team, True) for team in teams])


def _series(domain: str, area: str, name: str, teams: Sequence[tuple[Team, bool]]) -> Iterator[Row]:
    """Yield a row a team, each about twice as large as the one before, until it would take too long."""
    before = last = 0.0
    for team, clipped in teams:
        growth = np.clip(last / before, 2.0, 4.0) if before else 2.0
        if last * growth > LONGEST:
            return
        tree = trees.make(name, team.places)
        tally = run_round(team, tree, clipped=clipped, max_sweeps=MOST_SWEEPS)
        before, last = last, float(tally.seconds.sum())
        for _ in range(ROUNDS // len(team)):
            again = run_round(team, tree, clipped=clipped, max_sweeps=MOST_SWEEPS)
            tally = replace(tally, seconds=np.minimum(tally.seconds, again.seconds))
        row = _row(domain, area, name, clipped, team, tree, tally)
        if clipped:
            median, largest = whole_sizes(team, tree, tally.choice)
            row = replace(row, whole_median=median, whole_largest=largest)
        yield row


def _row(domain: str, area: str, name: str, clipped: bool, team: Team, tree: Tree, tally: Tally) -> Row:
    outcome, passes = tally.outcome, tally.turns / tree.n + 1
    hub = max(range(tree.n), key=lambda i: len(tree.neighbours(i)))
    cpu, sent, size = 1e3 * tally.seconds / passes, tally.messages / passes, tally.bytes / passes
    return Row(
        domain,
        area,
        name,
        clipped,
        tree.n,
        outcome.sweeps,
        outcome.converged,
        outcome.value,
        outcome.value / outcome.bound if outcome.bound else math.nan,
        float(np.median(cpu)),
        float(cpu.mean()),
        float(cpu[hub]),
        float(sent.mean()),
        float(np.delete(sent, hub).max()),
        float(sent[hub]),
        float(size.mean()),
        float(np.delete(size, hub).max()),
        float(size[hub]),
        float(np.median(tally.edges)),
        float(tally.edges.max()),
        team.bound,
    )
