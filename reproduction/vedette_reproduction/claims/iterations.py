"""Claim C8: what does the number of iterations depend on?"""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vedette.negotiation import Tree, negotiate
from vedette.problem import Coverage
from vedette.record.canvas import DPI, picture, save
from vedette_reproduction import teams
from vedette_reproduction.content import Section, Table, column, judge, table
from vedette_reproduction.plots import colour, label_axes, log_scale, over_team_size
from vedette_reproduction.quadratic import jacobi_step, spectral_radius, steps_to_optimum, token_step
from vedette_reproduction.run import ReproductionRun
from vedette_reproduction.teams import Kind

OBJECTIVE = Coverage()
MAX_SWEEPS = 60
PICTURE = "claim-8.png"
COUPLING = 0.122  # of every two platforms in the quadratic example
Float = NDArray[np.float64]


def c8(run: ReproductionRun) -> Section:
    """Count iterations against the team's size: separable, at constant density, in a fixed area."""
    sweeps = _sweeps(run)
    coupled = _coupled(run)
    with picture():
        figure = Figure(figsize=(9.8, 4.0), dpi=DPI)
        left, right = figure.subplots(1, 2)
        _draw_sweeps(left, sweeps, run)
        _draw_coupled(right, coupled, run)
        figure.tight_layout()
        save(figure, run.figures / PICTURE)
    single = {row[3] for row in sweeps.rows if row[0] == "separable"}
    dense = [row for row in sweeps.rows if row[0] == "constant density"]
    first, last = dense[0], dense[-1]
    never = [int(row[1] or 0) for row in coupled.rows if row[0] == "all pairs" and row[3] is None]
    return Section(
        "c8",
        "C8: the number of iterations depends on the problem's coupling, not on the size of the group",
        "The number of iterations depends on the inherent complexity of the problem only. A fully "
        "separable J is solved in a single iteration whatever the team's size, and the same holds if only "
        "a few members are coupled.",
        (
            "Fully separable: one sweep, always, with either scheme; the bound equals the value after it, "
            "which ends the round. Where each platform is coupled to its neighbours alone (constant "
            "density), the token's sweeps, the quiet one that proves the end included, grow slowly, from "
            f"{first[3]:.1f} at n = {first[1]} to {last[3]:.1f} at n = {last[1]}: the slowest neighbourhood "
            "sets the number, and there are more of them. The paper's own scheme mostly does not end at "
            "all there: it cycles, sooner or later.",
            "If everybody is coupled to everybody, the claim is wrong even for smooth J. With a pairwise "
            f"coupling of {COUPLING} in a quadratic J, the problem is concave for every n; replies at once "
            f"have a spectral radius of {COUPLING} (n − 1), so they take ever more iterations and diverge "
            f"from n = {math.ceil(1.0 + 1.0 / COUPLING)} on. With the same coupling to two neighbours only, "
            "the number is constant. A sweep's time is not: it takes as many hops as the tree is deep, or "
            "2(n − 1) for the token, as the paper says too.",
        ),
        judge(single == {1.0}, not never and float(last[3] or 0) <= float(first[3] or 0)),
        f"separable: {'/'.join(f'{float(x or 0):g}' for x in sorted(single, key=str))} sweep for all n; "
        f"constant density: {first[3]:.1f} → {last[3]:.1f} sweeps from n = {first[1]} to {last[1]}; all "
        f"coupled: {f'diverges from n = {never[0]} on' if never else 'converges for all n'}",
        (sweeps, coupled),
        (PICTURE,),
        but="for a separable J, not where many are coupled",
    )


def _sweeps(run: ReproductionRun) -> Table:
    kinds: dict[str, Kind] = {
        "separable": teams.separable,
        "constant density": teams.constant_density,
        "fixed area": teams.fixed_area,
    }
    rows = []
    for k, (name, make) in enumerate(kinds.items()):
        for n in run.scale.dense_teams:
            run.tell(f"sweeps, {name}: {n} platforms")
            token, jacobi, cycles = [], [], 0
            for trial in range(run.scale.trials):
                team = make(n, run.rng(108, k, n, trial))
                args = (OBJECTIVE, team.weights, team.candidates, Tree.balanced(n))
                token.append(negotiate(*args, "token").sweeps)
                at_once = negotiate(*args, "jacobi", max_sweeps=MAX_SWEEPS)
                cycles += at_once.cycle > 0
                jacobi += [at_once.sweeps] if at_once.converged else []
            settled = float(np.mean(jacobi)) if jacobi else None
            rows.append(
                (
                    name,
                    n,
                    run.scale.trials,
                    float(np.mean(token)),
                    max(token),
                    settled,
                    cycles / run.scale.trials,
                )
            )
    return table(
        "c8_sweeps",
        "Sweeps until the round ends",
        (
            "coupling", "platforms", "teams", "token: mean", "token: most", "paper's, if it settles: mean",
            "paper's: share that cycles",
        ),
        rows,
    )  # fmt: skip


def _coupled(run: ReproductionRun) -> Table:
    """Iterations on quadratics in which everybody is coupled, or each to two neighbours."""
    rows = []
    for name in ("all pairs", "two neighbours"):
        for n in run.scale.teams:
            q = np.eye(n) + COUPLING * _pattern(name, n)
            b = run.rng(108, 7, n).standard_normal(n)
            at_once, in_turn = (
                steps_to_optimum(q, b, jacobi_step, 1e-6),
                steps_to_optimum(q, b, token_step, 1e-6),
            )
            rows.append((name, n, spectral_radius(q), at_once, in_turn))
    return table(
        "c8_quadratic",
        f"Quadratic J, coupling {COUPLING}: iterations to 1e-6 of the optimum (empty: never)",
        ("coupled", "platforms", "spectral radius", "all at once", "in turn"),
        rows,
    )


def _pattern(name: str, n: int) -> Float:
    if name == "all pairs":
        return np.ones((n, n)) - np.eye(n)
    return np.asarray(np.eye(n, k=1) + np.eye(n, k=-1))


def _draw_sweeps(axes: Axes, sweeps: Table, run: ReproductionRun) -> None:
    for k, (name, own) in enumerate(sweeps.groups().items()):
        axes.plot(column(own, 1), column(own, 3), "o-", color=colour(k), lw=1.6, label=name)
    label_axes(axes, "sweeps of the token, mean", "", "sweeps")
    over_team_size(axes, run.scale.dense_teams)
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, fontsize=8.5)


def _draw_coupled(axes: Axes, coupled: Table, run: ReproductionRun) -> None:
    styles = {"all pairs": 1, "two neighbours": 0}
    for name, own in coupled.groups().items():
        for place, style, label in ((3, "o-", "all at once"), (4, "s--", "in turn")):
            settled = [row for row in own if row[place] is not None]
            values = column(settled, 1), column(settled, place)
            axes.plot(*values, style, ms=4.5, color=colour(styles[name]), lw=1.5, label=f"{name}, {label}")
    axes.axvline(1 + 1 / COUPLING, color="black", lw=0.9, ls=(0, (4, 2)))
    axes.text(
        1.06 + 1 / COUPLING, 0.97, "from here all pairs\nat once diverge", fontsize=8.5, va="top",
        transform=axes.get_xaxis_transform(),
    )  # fmt: skip
    label_axes(axes, f"quadratic J, coupling {COUPLING}", "", "iterations to 1e-6")
    over_team_size(axes, run.scale.teams)
    log_scale(axes)
    axes.legend(frameon=False, fontsize=8, ncols=2, loc="upper center", bbox_to_anchor=(0.45, -0.16))
