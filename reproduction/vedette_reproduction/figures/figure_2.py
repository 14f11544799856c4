"""Fig. 2 and claim C11: what a cell's posterior can be after n sensors have looked at it."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vedette.record.canvas import DPI, picture, save
from vedette_reproduction.content import Section, Table, table
from vedette_reproduction.plots import colour, label_axes
from vedette_reproduction.run import ReproductionRun

PRIOR = 0.35  # P(occupied), away from 1/2 so that the prior is seen to stay
MOST = 6  # sensors
PICTURE = "figure-2.png"
Float = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FigureSensor:
    """``P(z | x)`` for z in OCC, EMP, UNO and x in OCC, EMP."""

    name: str
    likelihood: Float  # (3, 2), columns sum to 1


PERFECT = FigureSensor("deterministic", np.array([(0.7, 0.0), (0.0, 0.7), (0.3, 0.3)]))
NOISY = FigureSensor("noisy", np.array([(0.6, 0.15), (0.1, 0.55), (0.3, 0.3)]))


def figure_2(run: ReproductionRun) -> Section:
    """Enumerate all joint observations by Bayes' rule and draw the posteriors that are possible."""
    sets = {sensor: [posteriors(sensor, n) for n in range(1, MOST + 1)] for sensor in (PERFECT, NOISY)}
    rows = [
        (sensor.name, n, float(value))
        for sensor, found in sets.items()
        for n, values in enumerate(found, start=1)
        for value in values
    ]
    with picture():
        figure = Figure(figsize=(9.4, 3.9), dpi=DPI)
        for i, (axes, (sensor, found)) in enumerate(
            zip(figure.subplots(1, 2, sharey=True), sets.items(), strict=True)
        ):
            _panel(axes, sensor, found, i)
        figure.tight_layout()
        save(figure, run.figures / PICTURE)
    return Section(
        "fig-2",
        "Figure 2: what a cell's posterior can be",
        "A perfect sensor either observes a cell fully (OCC or EMP) or not at all (UNO). So however many "
        "platforms look, a cell's posterior is one of three: known occupied, known empty, or the prior.",
        (
            f"All joint observations of 1 to {MOST} sensors were enumerated and each posterior computed by "
            f"Bayes' rule, eq. (3), with a prior of {PRIOR}. The deterministic sensor leaves three values "
            "whatever n is. A sensor that errs leaves (n + 1)(n + 2)/2, one for each number of reports of "
            "either kind: then the expectation of eq. (33) has ever more terms, and knowing that somebody "
            "saw the cell is no longer enough.",
        ),
        tables=(
            table(
                "figure_2",
                "Possible posteriors",
                ("sensor", "sensors looking", "P(occupied)"),
                rows,
                shown=False,
            ),
            counts_table(),
        ),
        pictures=(PICTURE,),
    )


def posteriors(sensor: FigureSensor, n: int) -> Float:
    """Return ``P(x = OCC | z_1 ... z_n)`` for all z of positive probability (paper, eq. (3))."""
    found = set()
    for reports in itertools.combinations_with_replacement(range(3), n):  # the order does not matter
        joint = np.array([PRIOR, 1.0 - PRIOR]) * np.prod(sensor.likelihood[list(reports)], axis=0)
        if joint.sum() > 0.0:
            found.add(round(float(joint[0] / joint.sum()), 12))
    return np.array(sorted(found))


def counts_table() -> Table:
    """Count the posteriors that are possible, with what combinatorics says."""
    rows = [
        (n, len(posteriors(PERFECT, n)), 3, len(posteriors(NOISY, n)), (n + 1) * (n + 2) // 2)
        for n in range(1, MOST + 1)
    ]
    columns = ("sensors looking", "deterministic", "expected: 3", "noisy", "expected: (n+1)(n+2)/2")
    return table("figure_2_counts", "How many posteriors are possible", columns, rows)


def _panel(axes: Axes, sensor: FigureSensor, found: list[Float], index: int) -> None:
    axes.axhline(PRIOR, color=colour(6), lw=0.9, ls=(0, (4, 2)), zorder=1)
    for n, values in enumerate(found, start=1):
        axes.plot(
            np.full(len(values), n), values, "o", ms=5, mec="white", mew=0.5, color=colour(index), zorder=3
        )
        axes.text(n, 1.07, str(len(values)), ha="center", fontsize=9, fontweight="bold", color=colour(index))
    label_axes(
        axes,
        f"{sensor.name} sensor",
        "sensors that look at the cell",
        "P(occupied) afterwards" if index == 0 else "",
    )
    axes.set(
        ylim=(-0.06, 1.16), yticks=(0, 0.25, 0.5, 0.75, 1), xlim=(0.5, MOST + 1.35), xticks=range(1, MOST + 1)
    )
    axes.text(MOST + 0.45, 1.07, "values", fontsize=9, va="baseline")
    axes.text(
        MOST + 0.45, PRIOR, "prior", fontsize=9, va="center", bbox={"fc": "white", "ec": "none", "pad": 1.0}
    )
