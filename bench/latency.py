"""``python -m bench.latency``: how long a round takes by the token, forked and asynchronously."""

from __future__ import annotations

import heapq
import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import fmean, median
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

from bench import command, machine
from bench.criteria import BenchReport, Criterion, Measurement, verdicts
from bench.scale import trees
from bench.scale.series import DOMAINS
from bench.scale.team import Lots, Team
from bench.table import figure, markdown
from vedette.negotiation import Chooser, Outgoing, RoundOutcome, Tree, messages, node_of
from vedette.negotiation.negotiate import tell_reaches
from vedette.record.files import write_text

SCHEMES = ("token", "fork", "async")
HOPS = (1.0, 20.0, 100.0)  # [ms]
SIZES, QUICK_SIZES = (8, 16, 64, 256, 1024), (8, 16)
JUDGED, JUDGED_HOP = 64, 20.0
WHOLE = (JUDGED, 256)  # sizes with a star and a chain
ASYNC_UP_TO = 256
SEEDS = 3  # of what is judged
RADIO = 2.0  # [lots]
MOST_SWEEPS = 50
HEADER = ("domain", "tree", "depth", "n", "scheme", "sweeps", "messages each", "kB each")
COLUMNS = (*HEADER, *(f"at {hop:g} ms [s]" for hop in HOPS), "of the token's at 20 ms", "value")


@dataclass(frozen=True)
class Row:
    """Rounds of one scheme on teams of one size, and on one kind of tree; means over the seeds."""

    domain: str
    tree: str
    depth: int
    n: int
    scheme: str
    sweeps: float
    messages: float  # a platform
    kilobytes: float  # a platform
    seconds: tuple[float, ...]  # a round takes, at each of the hops
    of_token: float  # at 20 ms, the largest over the seeds
    value: float  # of the token's, mean
    least: float  # the same, least

    def cells(self) -> tuple[str, ...]:
        """Return the row of the table."""
        numbers = (self.sweeps, self.messages, self.kilobytes, *self.seconds, self.of_token)
        head = (self.domain, self.tree, str(self.depth), str(self.n), self.scheme)
        return (*head, *(figure(number) for number in numbers), f"{self.value:.4f}")


@dataclass(frozen=True, eq=False)
class Trip:
    """One round."""

    outcome: RoundOutcome
    seconds: NDArray[np.float64]  # (H,) until the last platform has heard the end, by hop
    messages: int
    bytes: int


@dataclass(frozen=True, kw_only=True)
class LatencyReport(BenchReport):
    """``latency.json``."""

    rows: tuple[Row, ...]


def play(team: Team, tree: Tree, root: int, scheme: str, hops: Sequence[float]) -> Trip:
    """Run a round in which a message takes a hop [ms], and a platform the CPU time that it takes here.

    All hops at once where the order of messages changes nothing: each then has a clock of its own.
    """
    parents = tree.parents(root)
    heard, _, _ = tell_reaches(tree, parents, team.reaches)
    nodes = [
        node_of(
            scheme,
            tree.neighbours(i),
            parents[i],
            Chooser(team.objective, team.belief, own),
            max_sweeps=MOST_SWEEPS,
            reaches=heard[i],
        )
        for i, own in enumerate(team.candidates)
    ]
    delay, free = np.asarray(hops) / 1000.0, np.zeros((tree.n, len(hops)))
    number, under_way = itertools.count(), list[tuple[float, int, NDArray[np.float64], int, int, bytes]]()
    sent = size = 0

    def work(i: int, arrived: NDArray[np.float64], act: Callable[[], list[Outgoing[Any]]]) -> None:
        nonlocal sent, size
        began = time.thread_time()
        out = [(send.to, messages.encode(send.message, team.codec)) for send in act()]
        free[i] = np.maximum(free[i], arrived) + (time.thread_time() - began)
        for to, data in out:
            sent, size = sent + 1, size + len(data)
            there = free[i] + delay
            heapq.heappush(under_way, (float(there[0]), next(number), there, i, to, data))

    def hear(i: int, sender: int, data: bytes) -> list[Outgoing[Any]]:
        return nodes[i].receive(sender, messages.decode(data, team.codec))

    for i, node in enumerate(nodes):
        work(i, np.zeros(len(hops)), node.start)
    while under_way:
        _, _, arrived, sender, to, data = heapq.heappop(under_way)
        work(to, arrived, partial(hear, to, sender, data))
    outcome = nodes[root].finished
    assert outcome is not None  # every scheme ends
    return Trip(outcome, free.max(axis=0), sent, size)


def trips(team: Team, tree: Tree, root: int, scheme: str) -> Trip:
    """Run a round for all hops."""
    if scheme != "async":
        return play(team, tree, root, scheme, HOPS)
    apart = [play(team, tree, root, scheme, (hop,)) for hop in HOPS]
    middle = apart[HOPS.index(JUDGED_HOP)]
    return Trip(middle.outcome, np.concatenate([t.seconds for t in apart]), middle.messages, middle.bytes)


def make_tree(name: str, places: NDArray[np.float64], lot: float) -> Tree:
    """Return a tree of the scale table, or the breadth-first one over radios that reach two lots."""
    if name != "radio":
        return trees.make(name, places)
    away = np.hypot(*(places[:, None] - places).transpose(2, 0, 1))
    edges, ahead, found = [], [0], {0}
    for i in ahead:  # grows as it is walked
        for k in np.flatnonzero(away[i] <= RADIO * lot).tolist():
            if k not in found:
                found.add(k)
                ahead.append(k)
                edges.append((i, k))
    return Tree(len(places), tuple(edges))


def root_of(name: str, tree: Tree) -> tuple[int, int]:
    """Return the root and the tree's depth: platform 0 for radios, in a corner; the middle of other trees."""
    roots = [0] if name == "radio" else range(tree.n)
    return min(((root, _depth(tree, root)) for root in roots), key=lambda each: each[1])


def _depth(tree: Tree, root: int) -> int:
    """Return how many links the farthest platform is from a root."""
    depths, at = {root: 0}, [root]
    for i in at:  # grows as it is walked
        for k in tree.neighbours(i):
            if k not in depths:
                depths[k] = depths[i] + 1
                at.append(k)
    return depths[at[-1]]


def cases(sizes: Sequence[int]) -> Iterator[tuple[str, str, int]]:
    """Yield domain, tree and size of each group of rows."""
    for n in sizes:
        for tree in ("radio", "balanced", "random", *(("star", "chain") if n in WHOLE else ())):
            for domain in DOMAINS if (n, tree) == (JUDGED, "radio") else ("tracking",):
                yield domain, tree, n


def measure(sizes: Sequence[int], progress: Callable[[str], None]) -> list[Row]:
    """Return all rows, by size."""
    rows: list[Row] = []
    for domain, name, n in cases(sizes):
        progress(f"{domain}, {name}, {n}")
        lot = DOMAINS[domain].LOT
        runs: dict[str, list[Trip]] = {}
        deep = 0
        for seed in range(SEEDS if (n, name) == (JUDGED, "radio") else 1):
            team = DOMAINS[domain].dense(Lots.square(n, lot), np.random.default_rng([n, seed]))
            tree = make_tree(name, team.places, lot)
            root, depth = root_of(name, tree)
            deep = max(deep, depth)
            for scheme in SCHEMES if n <= ASYNC_UP_TO else SCHEMES[:2]:
                runs.setdefault(scheme, []).append(trips(team, tree, root, scheme))
        rows += [_row(domain, name, deep, n, scheme, own, runs["token"]) for scheme, own in runs.items()]
        progress(" | ".join(", ".join(row.cells()[4:]) for row in rows[-len(runs) :]))
    return rows


def _row(
    domain: str, tree: str, depth: int, n: int, scheme: str, own: Sequence[Trip], token: Sequence[Trip]
) -> Row:
    pairs = list(zip(own, token, strict=True))
    at = HOPS.index(JUDGED_HOP)
    values = [a.outcome.value / b.outcome.value for a, b in pairs]
    return Row(
        domain,
        tree,
        depth,
        n,
        scheme,
        fmean(a.outcome.sweeps for a in own),
        fmean(a.messages for a in own) / n,
        fmean(a.bytes for a in own) / n / 1000.0,
        tuple(float(median(a.seconds[k] for a in own)) for k in range(len(HOPS))),
        max(float(a.seconds[at] / b.seconds[at]) for a, b in pairs),
        fmean(values),
        min(values),
    )


def judge(rows: Sequence[Row]) -> list[Measurement]:
    """Hold forks of teams of 64, on trees as agents have, against what is asked for an agent to take them."""
    own = [row for row in rows if (row.n, row.scheme, row.tree) == (JUDGED, "fork", "radio")]
    asked = Criterion("fork, n=64, 20 ms a hop: of the token's time", 0.5, "")
    value = Criterion("fork, n=64: of the token's value", 0.995, "", at_least=True)
    if not own:
        return [Measurement(each, None, "no team of 64") for each in (asked, value)]
    slowest, poorest = max(own, key=lambda row: row.of_token), min(own, key=lambda row: row.value)
    return [
        Measurement(asked, slowest.of_token, f"worst: {slowest.domain}, radio tree {slowest.depth} deep"),
        Measurement(
            value,
            poorest.value,
            f"worst mean: {poorest.domain}; single rounds from {min(r.least for r in own):.4f}",
        ),
    ]


@click.command()
@click.option("--quick", is_flag=True, help="A smoke run: teams of 8 and 16.")
@command.out_option("JSON and table")
def bench(quick: bool, out: Path) -> None:
    """Measure how long rounds take over slow links. Exit status 0 whatever comes out."""
    folder = command.results_folder(out)
    machine.stay_on_one_core()
    about = machine.describe()
    rows = measure(QUICK_SIZES if quick else SIZES, lambda text: click.echo(f"  {text} ...", err=True))
    judged = judge(rows)
    text = (
        markdown(COLUMNS, [row.cells() for row in rows], "ll" + "r" * 2 + "l" + "r" * 8)
        + "\n"
        + verdicts(judged)
    )
    click.echo("\n" + text)
    path = folder / ("latency-quick.json" if quick else "latency.json")
    write_text(path.with_suffix(".md"), text)
    verdicts_ = tuple(each.judged() for each in judged)
    LatencyReport(about=about, quick=quick, measurements=verdicts_, rows=tuple(rows)).write(path)
    click.echo(f"written: {path}, and beside it .md")


if __name__ == "__main__":
    command.run(bench, "bench.latency")
