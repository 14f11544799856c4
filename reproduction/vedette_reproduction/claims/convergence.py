"""Claim C3: does the paper's scheme converge?"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vedette.negotiation import Negotiation, Tree, negotiate
from vedette.problem import Coverage
from vedette.record.canvas import DPI, picture, save
from vedette_reproduction import teams
from vedette_reproduction.content import Section, Table, column, judge, table
from vedette_reproduction.plots import colour, label_axes, over_team_size
from vedette_reproduction.quadratic import (
    MOST_STEPS,
    jacobi_step,
    random_hessian,
    spectral_radius,
    steps_to_optimum,
)
from vedette_reproduction.run import ReproductionRun
from vedette_reproduction.teams import Kind

OBJECTIVE = Coverage()
MAX_SWEEPS = 60
PICTURE = "claim-3.png"


def c3(run: ReproductionRun) -> Section:
    """A 2-cycle of two robots; how often teams cycle; and the condition where it means something."""
    duel = two_robots()
    iterates = table(
        "c3_two_cycle",
        "Two robots, two frontiers worth 1 and 0.8: iterates of the paper's scheme",
        ("iterate", "value", "optimum"),
        [(step.sweep, step.value, 1.8) for step in duel.history],
    )
    shares = _cycling(run)
    quadratic = _quadratic(run)
    with picture():
        figure = Figure(figsize=(9.8, 4.0), dpi=DPI)
        left, right = figure.subplots(1, 2)
        _draw_duel(left)
        _draw_shares(right, shares, run)
        figure.tight_layout()
        save(figure, run.figures / PICTURE)
    last = shares.rows[-1]
    return Section(
        "c3",
        "C3: the scheme converges to the optimum if ∇²J is diagonally dominant",
        "The algorithm of Table 1 will converge to the optimal group solution if the matrix ∇²J satisfies "
        "a diagonal dominance condition.",
        (
            "For continuous controls and a concave quadratic J the claim is right, and the condition "
            "sufficient: all random problems that meet it converged to the optimum. It is not necessary: "
            "many converge without. But strategies in the paper's own application are frontiers. A finite "
            "set has no Hessian, so there the condition says nothing, and the scheme need not converge.",
            "The smallest example: both robots see the better frontier free and take it; both see it taken "
            f"and take the other; and so on for ever (period {duel.cycle}, found by the negotiation "
            f"itself). Among random teams of {last[1]} platforms, {100 * float(last[2] or 0):.0f} % of the "
            f"rounds cycle ({last[0]}). The token, where one platform replies at a time, always ends, at an "
            "equilibrium (docs/theory.md, (V10)).",
        ),
        judge(
            quadratic.rows[0][1] == quadratic.rows[0][2],
            not duel.cycle and not any(float(row[2] or 0) for row in shares.rows),
        ),
        f"dominant quadratics: {quadratic.rows[0][2]} of {quadratic.rows[0][1]} converge; discrete "
        f"strategies: a {duel.cycle}-cycle of two robots, {100 * float(last[2] or 0):.0f} % of rounds "
        f"cycle at n = {last[1]}",
        (iterates, shares, quadratic),
        (PICTURE,),
        but="for continuous controls, not for frontiers to choose from",
    )


def two_robots(scheme: str = "jacobi") -> Negotiation:
    """Let two robots choose between two frontiers; a second visit is worth nothing."""
    misses = [np.array([0.0, 1.0]), np.array([1.0, 0.0])]
    return negotiate(OBJECTIVE, np.array([1.0, 0.8]), [misses, misses], Tree.chain(2), scheme, max_sweeps=6)


def _cycling(run: ReproductionRun) -> Table:
    """How often the paper's scheme cycles, and what its last and best iterates are worth, by team."""
    rows = []
    kinds: list[tuple[str, Kind]] = [
        ("one list, all begin at its best", teams.same_list),
        ("own frontiers, constant density", teams.constant_density),
    ]
    for k, (name, make) in enumerate(kinds):
        for n in run.scale.dense_teams:
            run.tell(f"{name}: {n} platforms")
            cycles, last, best = 0, [], []
            for trial in range(run.scale.trials):
                rng = run.rng(103, k, n, trial)
                team = make(n, rng)
                start = (
                    [0] * n if make is teams.same_list else rng.integers(teams.CANDIDATES, size=n).tolist()
                )
                args = (OBJECTIVE, team.weights, team.candidates, Tree.balanced(n))
                at_once = negotiate(*args, "jacobi", start=start, max_sweeps=MAX_SWEEPS)
                by_token = negotiate(*args, "token", start=start, max_sweeps=MAX_SWEEPS)
                cycles += at_once.cycle > 0
                last.append(at_once.history[-1].value / by_token.value)
                best.append(at_once.value / by_token.value)
            rows.append((name, n, cycles / run.scale.trials, float(np.mean(last)), float(np.mean(best))))
    return table(
        "c3_cycles",
        f"The paper's scheme on random teams, {run.scale.trials} each; values relative to the token's",
        ("strategies", "platforms", "share that cycles", "last iterate", "best iterate"),
        rows,
    )


def _quadratic(run: ReproductionRun) -> Table:
    """``J = b'u - u'Qu/2``: does ``u <- D^-1 (b - (Q - D) u)`` reach ``Q^-1 b``?"""
    kinds = {"diagonally dominant": (0.3, 0.99), "concave, not dominant": (1.01, 3.0)}
    rows = []
    for k, (name, span) in enumerate(kinds.items()):
        converged = count = 0
        predicted = 0
        while count < 5 * run.scale.trials:
            rng = run.rng(103, 9, k, count, converged)
            q = random_hessian(rng, span)
            count += 1
            b = rng.standard_normal(len(q))
            reached = steps_to_optimum(q, b, jacobi_step)
            converged += reached is not None
            predicted += spectral_radius(q) < 1.0
        rows.append((name, count, converged, predicted))
    return table(
        "c3_quadratic",
        "Random concave quadratics in 10 variables: runs that reach the optimum to 1e-9 within "
        f"{MOST_STEPS} iterates",
        ("Hessian", "problems", "converge", "spectral radius below 1"),
        rows,
    )


def _draw_duel(axes: Axes) -> None:
    for k, scheme in enumerate(("jacobi", "token")):
        values = [step.value for step in two_robots(scheme).history]
        if scheme == "jacobi":  # the negotiation stops at the recurrence; what follows repeats it
            values += values[-2:] * 2
        label = "all at once (the paper)" if scheme == "jacobi" else "one after the other, by turns"
        axes.plot(range(len(values)), values, "o-", color=colour(1 - k), lw=1.6, label=label)
    axes.axhline(1.8, color="black", lw=0.9, ls=(0, (4, 2)))
    axes.text(5.4, 1.83, "optimum", ha="right", va="bottom", fontsize=9)
    label_axes(axes, "two robots, frontiers worth 1 and 0.8", "iterate, or turn", "value")
    axes.set(ylim=(-0.05, 2.1))
    axes.legend(frameon=False, loc="center right", fontsize=8.5, bbox_to_anchor=(1.0, 0.22))


def _draw_shares(axes: Axes, shares: Table, run: ReproductionRun) -> None:
    for k, (name, own) in enumerate(shares.groups().items()):
        axes.plot(
            column(own, 1),
            column(own, 2),
            "o-",
            color=colour(k),
            lw=1.6,
            label=f"cycling: {name}",
        )
        axes.plot(
            column(own, 1), column(own, 3), "s--", color=colour(k), lw=1.2, ms=4,
            label="its last value / the token's",
        )  # fmt: skip
    label_axes(axes, "the paper's scheme on random teams", "", "share")
    over_team_size(axes, run.scale.dense_teams)
    axes.set(ylim=(0, 1.05))
    axes.legend(frameon=False, fontsize=8, ncols=2, loc="upper center", bbox_to_anchor=(0.45, -0.16))
