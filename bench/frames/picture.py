"""The curve: shares of pairs joined and joined wrongly, against how much the maps have in common."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from bench.frames.tables import EDGES, counted
from bench.frames.trial import Trial
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save, tidy


def curve_png(trials: Sequence[Trial], path: Path) -> None:
    """Draw both shares by overlap, for pairs that count; the numbers of pairs stand above."""
    one = counted(trials)
    middles, joined, wrong, counts = [], [], [], []
    for low, high in pairwise(EDGES):
        some = [trial for trial in one if low <= trial.overlap < high]
        if some:
            middles.append((low + min(high, 1.0)) / 2.0)
            joined.append(np.mean([trial.outcome == "joined" for trial in some]))
            wrong.append(np.mean([trial.outcome == "wrong" for trial in some]))
            counts.append(len(some))
    with picture():
        figure = Figure(figsize=(7.0, 4.0), dpi=DPI)
        axes = figure.subplots()
        good, bad = palette.unit(palette.ROBOTS[0]), palette.unit(palette.ROBOTS[1])
        axes.plot(middles, joined, "o-", color=good, label="joined rightly")
        axes.plot(middles, wrong, "s-", color=bad, label="joined wrongly")
        for x, y, count in zip(middles, joined, counts, strict=True):
            axes.annotate(str(count), (x, y), (0, 6), textcoords="offset points", ha="center", fontsize=7)
        axes.set(xlabel="overlap: share of the smaller map that the other knows too", ylabel="share of pairs")
        axes.set(xlim=(0.0, 1.0), ylim=(-0.02, 1.08))
        axes.legend(frameon=False, loc="center right")
        tidy(axes)
        figure.tight_layout()
        save(figure, path)
