"""Fig. 3: the probability that a cell is observed against its distance: two models and two measurements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray

from vedette.domains.mapping.sightings import BIN, P_OCCUPIED, beam_model, berths_in, measured_model
from vedette.kernels.coverage import footprints
from vedette.maps import FREE, UNKNOWN
from vedette.maps.world import standable
from vedette.record.canvas import DPI, picture, save
from vedette.sim.worlds import office
from vedette_reproduction.content import Section, table
from vedette_reproduction.missions import specs
from vedette_reproduction.plots import colour, label_axes
from vedette_reproduction.run import ReproductionRun
from vedette_reproduction.scans import scan, spaced

RANGE = 8.0  # of the figure and the sensor [m]
CELL = 0.1  # [m]
USED = round(RANGE / BIN)  # distance bins in the figure
STEP = 2.0  # between a mission's scans that count [m], as robots learn in a mission
FIRST_OFFICE = 1000  # seed: none of the missions' offices
PICTURE = "figure-3.png"
Float = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Measured:
    """Unknown cells tried and seen, by distance."""

    tried: NDArray[np.int64]  # (offices, USED)
    seen: NDArray[np.int64]

    @property
    def share(self) -> Float:
        """(USED,) pooled over the offices; NaN where nothing was tried."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.seen.sum(axis=0) / self.tried.sum(axis=0))

    @property
    def band(self) -> tuple[Float, Float]:
        """Least and greatest share of any office, (USED,) each."""
        with np.errstate(invalid="ignore"):
            shares = self.seen / self.tried
        return np.nanmin(shares, axis=0), np.nanmax(shares, axis=0)


def figure_3(run: ReproductionRun) -> Section:
    """Scan unknown offices, count, and set the counts against the occupancy grid's own prediction."""
    at: Float = (np.arange(USED, dtype=np.float64) + 0.5) * BIN
    exact = analytic(at)
    cells: Float = (np.arange(round(RANGE / CELL), dtype=np.float64) + 0.5) * CELL
    beams = _beam_model(len(cells))
    fresh = _fresh(run)
    underway, learned = _underway(run)
    rows = [
        (
            float(at[k]), float(exact[k]),
            int(fresh.seen[:, k].sum()), int(fresh.tried[:, k].sum()), float(fresh.share[k]),
            int(underway.seen[0, k]), int(underway.tried[0, k]),
            float(underway.share[k]) if underway.tried[0, k] else None, float(learned[k]),
        )
        for k in range(USED)
    ]  # fmt: skip
    curves = table(
        "figure_3",
        "Probability that a cell is observed, by distance",
        (
            "distance [m]", "0.5^(10 d)", "first scans: seen", "tried", "share",
            "mission: seen", "tried", "share", "the planner's curve",
        ),
        rows,
    )  # fmt: skip
    models = table(
        "figure_3_models",
        "What the occupancy grid predicts, cell by cell",
        ("distance [m]", "0.5^(10 d)", "beam model"),
        np.column_stack((cells, analytic(cells), beams)).tolist(),
        shown=False,
    )
    with picture():
        figure = Figure(figsize=(8.2, 5.6), dpi=DPI)
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3.2, 1))
        _curves(upper, at, (cells, beams), fresh, underway, learned)
        _counts(lower, at, fresh, underway)
        figure.tight_layout()
        save(figure, run.figures / PICTURE)
    one, four = np.searchsorted(at, (1.0, 4.0))
    return Section(
        "fig-3",
        "Figure 3: how far the prediction of the occupancy grid is from what a scan sees",
        "With P(occupied) = 0.5 for every unknown cell, the independent grid predicts that nothing beyond "
        "a metre is seen; measured in the environment of Fig. 6, the probability falls slowly to about 8 m.",
        (
            f"First scans: {run.scale.scans} places in each of {run.scale.scan_offices} generated offices, "
            f"{int(fresh.tried.sum()):,} cells tried; every scan begins with an unknown building. Mission: "
            f"the unknown cells that the scans of a mission of three robots tried, {STEP:g} m apart on "
            f"their ways, {int(underway.tried.sum()):,} cells; cells behind a known wall are not tried. A "
            "cell counts once for each beam that crosses it or would have.",
            f"At 1 m the grid's own prediction is {exact[one]:.1e}, and {fresh.share[one]:.2f} of the cells "
            f"are seen; at 4 m it is {exact[four]:.0e} against {fresh.share[four]:.2f}. The paper's point "
            "holds: the full probabilistic analysis (eq. (36)) on an independent grid is useless for "
            "planning, and the curve has to be measured. The beam model is the code's own product over "
            "rays, averaged over all cells at a distance; it lies a cell farther out, for neither the "
            "sensor's own cell nor the one to be seen need be crossed (eq. (32)). The paper prints no "
            "numbers, so shapes can be compared, not values.",
        ),
        tables=(curves, models),
        pictures=(PICTURE,),
    )


def analytic(distance: Float) -> Float:
    """``0.5^(d / 0.1 m)``: all cells before one at distance d are empty; paper, eq. (36)."""
    return np.asarray((1.0 - P_OCCUPIED) ** (distance / CELL))


def _beam_model(bins: int) -> Float:
    """The code's beam product into the unknown, (bins,): the mean over the cells of each distance."""
    cells = round(RANGE / CELL)
    side = 2 * cells + 1
    middle = cells * side + cells
    classes = np.full((side, side), UNKNOWN, np.uint8)
    classes[cells, cells] = FREE
    table = beam_model(2 * cells).table
    look = np.array([middle]), np.zeros(1), float(cells), 2.0 * np.pi
    _, seen, shares = footprints(classes, berths_in(classes, CELL), *look, table, False, 3600, 1, 1e-30)
    grid = np.zeros(side * side)
    grid[seen] = shares
    row, col = np.divmod(np.arange(side * side), side)
    place = np.hypot(row - cells, col - cells).astype(np.intp)
    inside = (place < bins) & (np.arange(side * side) != middle)
    number = np.bincount(place[inside], minlength=bins)
    total = np.bincount(place[inside], grid[inside], minlength=bins)
    return np.asarray(np.divide(total, number, out=np.ones(bins), where=number > 0))


def _fresh(run: ReproductionRun) -> Measured:
    """First scans from anywhere a robot can stand in offices that no mission uses."""
    spec = specs()[0]
    tried, seen = [], []
    for k in range(run.scale.scan_offices):
        run.tell(f"scanning office {k + 1} of {run.scale.scan_offices}")
        world = office(run.rng(3, k))
        places = np.flatnonzero(standable(world, spec.radius))
        rng = run.rng(3, k, 1)
        centres = world.frame.centres(rng.choice(places, run.scale.scans, replace=False))
        poses = np.column_stack((centres, rng.uniform(-np.pi, np.pi, len(centres))))
        counts = scan(world, poses, spec, rng, forget=True).counts
        tried.append(counts[0, :USED])
        seen.append(counts[1, :USED])
    return Measured(np.array(tried), np.array(seen))


def _underway(run: ReproductionRun) -> tuple[Measured, Float]:
    """What the scans of a mission tried of what was still unknown; and the curve learned from that (V25)."""
    mission = run.mission()
    poses = mission.report.log.poses  # all robots' scans in order of time, on one map
    kept = [spaced(poses[:, i], STEP) for i in range(poses.shape[1])]
    order = np.concatenate([np.linspace(0.0, 1.0, len(some)) for some in kept])
    way = np.concatenate(kept)[np.argsort(order, kind="stable")]
    counts = scan(mission.world, way, specs()[0], run.rng(3, 99)).counts
    learned = measured_model(counts, BIN, USED - 1, by_distance=True).table[0].astype(np.float64)
    return Measured(counts[:1, :USED], counts[1:2, :USED]), learned


def _curves(
    axes: Axes, at: Float, beams: tuple[Float, Float], fresh: Measured, underway: Measured, learned: Float
) -> None:
    fine = np.linspace(0.0, RANGE, 400)
    axes.plot(fine, analytic(fine), color="black", lw=1.8, label="occupancy grid, P = 0.5: $0.5^{10 d}$")
    axes.plot(*beams, ":", color=colour(1), lw=2.0, label="beam model of the code, all directions")
    axes.fill_between(
        at, *fresh.band, color=colour(0), alpha=0.18, lw=0, label="… least and most of any office"
    )
    axes.plot(at, fresh.share, color=colour(0), lw=1.8, label="measured: first scans of unknown offices")
    axes.plot(at, underway.share, "o", color=colour(2), ms=4, label="measured: unknown cells in a mission")
    axes.plot(at, learned, color=colour(2), lw=1.1, label="the planner's curve from these, (V25)")
    label_axes(axes, "", "", "probability that a cell is observed")
    axes.set(ylim=(0, 1.02), xlim=(0, RANGE))
    handles, labels = axes.get_legend_handles_labels()
    order = (0, 1, 3, 2, 4, 5)
    axes.legend([handles[i] for i in order], [labels[i] for i in order], frameon=False, fontsize=8.5)


def _counts(axes: Axes, at: Float, fresh: Measured, underway: Measured) -> None:
    axes.step(at, fresh.tried.sum(axis=0), where="mid", color=colour(0), lw=1.5)
    axes.step(at, underway.tried[0], where="mid", color=colour(2), lw=1.5)
    label_axes(axes, "", "distance [m], number of cells (× 10)", "cells tried")
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
