"""The tables: joined and wrong by overlap, by place, and among places that differ or look alike."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from statistics import median

from bench.frames.trial import Trial
from bench.table import figure, markdown

EDGES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.01)  # of the overlap


def tables(trials: Sequence[Trial]) -> str:
    """Return all tables in Markdown."""
    one = [trial for trial in trials if trial.sort == "one"]
    others = [trial for trial in trials if trial.sort != "one"]
    by_overlap = [
        (f"{low:.2f} to {min(high, 1.0):.2f}", [trial for trial in one if low <= trial.overlap < high])
        for low, high in pairwise(EDGES)
    ]
    enough = [trial for trial in one if trial.overlap >= 0.4]
    parts = [
        "Two maps of one place, by overlap:\n",
        _table("overlap", by_overlap),
        "The same, from an overlap of 0.4 on, by place:\n",
        _table("place", _by(enough, lambda trial: trial.place)),
        "Different places, and one place that looks alike in parts:\n",
        _table("places", _by(others, lambda trial: "different" if trial.sort == "two" else trial.place)),
        f"Commits: {', '.join(sorted({trial.commit for trial in trials}))}\n",
    ]
    return "\n".join(parts)


def _by(trials: Sequence[Trial], of: Callable[[Trial], str]) -> list[tuple[str, list[Trial]]]:
    names = sorted({of(trial) for trial in trials})
    return [(name, [trial for trial in trials if of(trial) == name]) for name in names]


def _table(first: str, groups: Sequence[tuple[str, Sequence[Trial]]]) -> str:
    header = (first, "pairs", "joined", "share", "wrong", "error [m]", "error [deg]", "CPU [s]")
    rows = []
    for name, trials in groups:
        if not trials:
            continue
        joined = [trial for trial in trials if trial.outcome == "joined"]
        shifts = [trial.error_m for trial in joined if trial.error_m is not None]
        turns = [trial.error_deg for trial in joined if trial.error_deg is not None]
        rows.append(
            (
                name,
                str(len(trials)),
                str(len(joined)),
                f"{len(joined) / len(trials):.1%}",
                str(sum(trial.outcome == "wrong" for trial in trials)),
                f"{median(shifts):.3f}" if shifts else "-",
                f"{median(turns):.3f}" if turns else "-",
                figure(median(trial.time_s for trial in trials)),
            )
        )
    return markdown(header, rows, "lrrrrrrr")
