"""Claims C4 to C7: what an iteration costs a platform and the group, on a chain, a star and random trees."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vedette.record.canvas import DPI, picture, save
from vedette_reproduction import teams
from vedette_reproduction.content import Section, Value, judge, table, wall_table
from vedette_reproduction.costs import FIXED, GROWING, SCHEMES, TREES, Cost, measure
from vedette_reproduction.plots import colour, label_axes, log_scale, over_team_size
from vedette_reproduction.run import ReproductionRun

PICTURE = "claims-4-to-7.png"
MOST_ON_A_CHAIN = 6.0  # combinations of a platform with two neighbours, an iterate
MOST_SENT = 2.0  # messages of a platform with two neighbours, an iterate
ON_A_CHAIN = "on a chain, not at a star's hub"
FEW_BYTES = 32  # of counters, by which messages may differ


def c4_to_c7(run: ReproductionRun) -> list[Section]:
    """Record negotiations of growing teams once, and read four claims off them."""
    costs = [
        measure(run, scheme, area, tree, n)
        for scheme in SCHEMES
        for area in (FIXED, GROWING)
        for tree in TREES
        for n in (run.scale.teams if area == FIXED else run.scale.dense_teams)
    ]
    with picture():
        _draw(costs, run)
    return [c4(costs), c5(costs), c6(costs), c7(costs)]


def _row(cost: Cost) -> tuple[Value, ...]:
    return cost.scheme, cost.area, cost.tree, cost.n


_KEYS = ("scheme", "area", "tree", "platforms")


def c4(costs: list[Cost]) -> Section:
    """Computation of a platform in an iteration."""
    fixed = [cost for cost in costs if cost.area == FIXED]
    counted = table(
        "c4_computation",
        "What one platform computes in a sweep, area fixed",
        (*_KEYS, "replies, most", "combinations, mean", "combinations, most of any"),
        [(*_row(c), c.replies, c.combinations, c.most_combinations) for c in fixed],
        shown=False,
    )
    timed = wall_table(
        "c4_cpu_time",
        "CPU time of a platform in a sweep, mean [ms]",
        (*_KEYS, "CPU [ms]"),
        [(*_row(c), 1e3 * c.seconds) for c in costs],
    )
    chain, star = _pair(fixed, "chain"), _pair(fixed, "star")
    return Section(
        "c4",
        "C4: the computation of a platform in an iteration does not depend on n",
        "Computational requirements per iteration for each platform are independent of the size of the "
        "group.",
        (
            "A platform replies once in an iteration, to one combined impact, whatever n is: "
            f"{teams.CANDIDATES} candidates scored. What is left is combining messages: on a chain "
            f"{chain[0].combinations:.1f} a platform and iterate at n = {chain[0].n}, "
            f"{chain[1].combinations:.1f} at {chain[1].n}. It follows a platform's number of neighbours, "
            "not n; only where one platform has them all, the hub of a star, does it grow "
            f"({star[0].most_combinations:.0f} → {star[1].most_combinations:.0f}). CPU times, which depend "
            "on the machine and its load, are in a file of their own. The claim needs impacts of a fixed "
            "size; over an area that grows with the team each combination and each reply grows with it "
            "(C6).",
        ),
        judge(chain[1].most_combinations <= MOST_ON_A_CHAIN, star[1].most_combinations <= MOST_ON_A_CHAIN),
        f"chain: {chain[0].combinations:.1f} → {chain[1].combinations:.1f} combinations and 1 reply a "
        f"platform and iterate, n = {chain[0].n} → {chain[1].n}; a star's hub: "
        f"{star[1].most_combinations:.0f}",
        (counted, timed),
        (PICTURE,),
        but=ON_A_CHAIN,
    )


def c5(costs: list[Cost]) -> Section:
    """Messages of a platform in an iteration."""
    fixed = [cost for cost in costs if cost.area == FIXED]
    rows = [(*_row(c), c.messages, c.most_messages, 2.0 * (c.n - 1) / c.n) for c in fixed]
    chain, star = _pair(fixed, "chain"), _pair(fixed, "star")
    return Section(
        "c5",
        "C5: the number of messages that a platform sends does not depend on n",
        "Number of messages each platform must send is independent of n.",
        (
            "On average a platform sends fewer than two messages an iterate on any tree, 2(n − 1)/n. On "
            f"the paper's chain no platform sends more than two: {chain[1].most_messages:.2f} at n = "
            f"{chain[1].n}, stopping included. But the claim depends on the tree: the hub of a star sends n "
            f"− 1 of them, {star[1].most_messages:.0f} at n = {star[1].n}.",
        ),
        judge(chain[1].most_messages <= MOST_SENT, star[1].most_messages <= MOST_SENT),
        f"chain: at most {chain[1].most_messages:.1f} a platform and iterate at n = {chain[1].n}; a star's "
        f"hub: {star[1].most_messages:.0f}",
        (
            table(
                "c5_messages",
                "Messages that a platform sends in an iterate or sweep",
                (*_KEYS, "mean", "most of any", "2 (n - 1) / n"),
                rows,
                shown=False,
            ),
        ),
        but=ON_A_CHAIN,
    )


def c6(costs: list[Cost]) -> Section:
    """Size of a message."""
    rows = [(*_row(c), c.median, c.longest) for c in costs]
    fixed, grown = (
        _pair([c for c in costs if c.area == FIXED], "chain"),
        _pair([c for c in costs if c.area == GROWING], "chain"),
    )
    return Section(
        "c6",
        "C6: the size of a message does not depend on n",
        "Size of each message each platform must send is independent of n.",
        (
            f"For an impact space that is fixed, here {teams.SIDE**2} cells, it holds: the longest message "
            f"is {fixed[0].longest} bytes at n = {fixed[0].n} and {fixed[1].longest} at n = {fixed[1].n} (a "
            "few bytes of counters more). But an impact can be no smaller than what it describes. Teams of "
            "constant density work in an area that grows with them, and then the longest message on a "
            f"chain, which holds the footprints of all platforms but one, grows from {grown[0].longest} to "
            f"{grown[1].longest} bytes, n = {grown[0].n} to {grown[1].n}, though only touched cells are "
            "sent. The remedy is to clip messages to what the receivers can reach (docs/theory.md, (V14)).",
        ),
        judge(_flat(fixed), _flat(grown)),
        f"fixed area: {fixed[0].longest} → {fixed[1].longest} B, n = {fixed[0].n} → {fixed[1].n}; area "
        f"growing with the team: {grown[0].longest} → {grown[1].longest} B, n = {grown[0].n} → {grown[1].n}",
        (
            table(
                "c6_bytes",
                "Messages that hold an impact [bytes]",
                (*_KEYS, "median", "longest"),
                rows,
                shown=False,
            ),
        ),
        but="in a fixed area, not in one that grows with the team",
    )


def c7(costs: list[Cost]) -> Section:
    """Messages of the group."""
    fixed = [cost for cost in costs if cost.area == FIXED]
    rows = [(*_row(c), c.sweeps, c.total, expected_total(c.n, c.sweeps)) for c in fixed]
    papers = [c for c in fixed if c.scheme == SCHEMES["jacobi"]]
    exact = sum(c.total == expected_total(c.n, c.sweeps) for c in papers)
    bounded = sum(c.total <= expected_total(c.n, c.sweeps) for c in fixed if c.scheme == SCHEMES["token"])
    tokens = len(fixed) - len(papers)
    return Section(
        "c7",
        "C7: the group sends O(n) messages in all",
        "Total number of messages the group must send is only O(n).",
        (
            "The paper's scheme sends 2(n − 1) messages an iterate, one each way on every link, the last "
            f"time to stop, and the counts are exactly that in {exact} of {len(papers)} recorded rounds. "
            "The token gathers (n − 1), walks 2(n − 1) a sweep, and stops (n − 1): at most the sum in "
            f"{bounded} of {tokens} rounds, less where it ends before it is home. With the number of sweeps "
            "growing as C8 says, a whole round is a little more than O(n).",
        ),
        judge(exact == len(papers), bounded == tokens),
        f"exactly 2(n − 1) an iterate in {exact} of {len(papers)} rounds",
        (
            table(
                "c7_total",
                "Messages of whole rounds",
                (*_KEYS, "sweeps", "messages", "formula (token: at most)"),
                rows,
                shown=False,
            ),
        ),
        but="for the paper's scheme, not for the token",
    )


def expected_total(n: int, sweeps: int) -> int:
    """Messages of a round: the paper's iterates 0 ... ``sweeps``; the token's gathering, sweeps, stop.

    The way down of the paper's last iterate is the stop, so both come to the same.
    """
    return 2 * (n - 1) * (sweeps + 1)


def _flat(pair: tuple[Cost, Cost]) -> bool:
    """Tell whether the longest message of the largest team is that of the smallest, but for counters."""
    return pair[1].longest - pair[0].longest < FEW_BYTES


def _pair(costs: list[Cost], tree: str) -> tuple[Cost, Cost]:
    """Return the paper's scheme on a tree with the smallest and the largest team."""
    own = [cost for cost in costs if cost.tree == tree and cost.scheme == SCHEMES["jacobi"]]
    return own[0], own[-1]


def _draw(costs: list[Cost], run: ReproductionRun) -> None:
    figure = Figure(figsize=(10.4, 6.4), dpi=DPI)
    panels = figure.subplots(2, 2)
    papers = [cost for cost in costs if cost.scheme == SCHEMES["jacobi"]]
    _lines(panels[0, 0], papers, FIXED, ("combinations", "most_combinations"))
    label_axes(panels[0, 0], "C4: combinations a platform and iterate", "", "combinations")
    _lines(panels[0, 1], papers, FIXED, ("messages", "most_messages"))
    label_axes(panels[0, 1], "C5: messages a platform and iterate", "", "messages")
    _lines(panels[1, 0], papers, FIXED, ("longest",))
    _lines(panels[1, 0], papers, GROWING, (None, "longest"))
    label_axes(panels[1, 0], "C6: longest message (dashed: area grows with the team)", "", "bytes")
    _lines(panels[1, 1], papers, FIXED, ("total_an_iterate",))
    sizes = np.array(run.scale.teams)
    panels[1, 1].plot(sizes, 2 * (sizes - 1), "k:", lw=1.0, zorder=5)
    panels[1, 1].text(
        0.97, 0.06, "2(n − 1), all trees alike", ha="right", fontsize=8.5, transform=panels[1, 1].transAxes
    )
    label_axes(panels[1, 1], "C7: messages of the group in an iterate", "", "messages")
    for axes in panels.ravel():
        over_team_size(axes, run.scale.teams)
        log_scale(axes)
    handles = [
        panels[0, 0].plot((), (), color=colour(k), lw=1.6, label=tree)[0] for k, tree in enumerate(TREES)
    ]
    handles += [
        panels[0, 0].plot((), (), "-", color="grey", label="mean of all platforms")[0],
        panels[0, 0].plot((), (), "--", color="grey", label="most of any platform")[0],
    ]
    figure.legend(handles=handles, loc="lower center", ncols=5, frameon=False)
    figure.tight_layout(rect=(0.0, 0.04, 1.0, 1.0))
    save(figure, run.figures / PICTURE)


def _lines(axes: Axes, costs: list[Cost], area: str, figures: tuple[str | None, ...]) -> None:
    """Draw figures of costs over n, the first solid and the second dashed, a colour a tree."""
    for k, tree in enumerate(TREES):
        own = [cost for cost in costs if cost.tree == tree and cost.area == area]
        for name, style in zip(figures, ("o-", "s--"), strict=False):
            if name is not None:
                values = [getattr(cost, name) for cost in own]
                axes.plot([c.n for c in own], values, style, ms=3.5, lw=1.5, color=colour(k))
