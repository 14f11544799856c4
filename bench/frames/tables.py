"""The tables: joined and wrong by overlap, by place, and among places that differ or look alike."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from statistics import median

from bench.frames.trial import Trial
from bench.table import figure, markdown

EDGES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.01)  # of the overlap
MUCH = 0.4  # overlap from which on places are compared
JOINED = ((0.4, 0.98), (0.2, 0.85))  # overlap from which on this share is asked
ERROR_M, ERROR_DEG = 0.05, 0.3  # asked at most, in the median
TIMES = ((25.0, 35.0, 0.3), (55.0, 65.0, 2.0))  # sides [m], and the CPU time that is asked at most [s]


def tables(trials: Sequence[Trial]) -> str:
    """Return all tables in Markdown."""
    one = counted(trials)
    apart = [trial for trial in trials if trial.sort == "one" and trial.repetitive]
    others = [trial for trial in trials if trial.sort != "one"]
    enough = [trial for trial in one if trial.overlap >= MUCH]
    parts = [
        "What was asked:\n",
        _asked(trials),
        "Two maps of one place that does not repeat itself, by overlap:\n",
        _table("overlap", _by_overlap(one)),
        f"The same, from an overlap of {MUCH:g} on, by place:\n",
        _table("place", _by(enough, lambda trial: trial.place)),
        "Mazes, and maps of which half fits elsewhere on themselves, by overlap:\n",
        _table("overlap", _by_overlap(apart)),
        "The same, by place:\n",
        _table("place", _by(apart, lambda trial: trial.place)),
        "Different places, and one place that looks alike in parts:\n",
        _table("places", _by(others, lambda trial: "different" if trial.sort == "two" else trial.place)),
        f"Commits: {', '.join(sorted({trial.commit for trial in trials}))}\n",
    ]
    return "\n".join(parts)


def counted(trials: Sequence[Trial]) -> list[Trial]:
    """Return those of one place that does not repeat itself."""
    return [trial for trial in trials if trial.sort == "one" and not trial.repetitive]


def _asked(trials: Sequence[Trial]) -> str:
    """Return what was asked beside what was measured."""
    one = counted(trials)
    joined = [trial for trial in trials if trial.outcome == "joined"]
    wrong = sum(trial.outcome == "wrong" for trial in trials)
    rows = [
        *(
            _row(f"joined from an overlap of {least:g} on", _joined(one, least), share, "{:.1%}", True)
            for least, share in JOINED
        ),
        _row("joined wrongly", float(wrong), 0.0, "{:.0f}", False),
        _row("median error [m]", _median(trial.error_m for trial in joined), ERROR_M, "{:.3f}", False),
        _row("median error [deg]", _median(trial.error_deg for trial in joined), ERROR_DEG, "{:.3f}", False),
        *(
            _row(
                f"CPU of a pair of {low:g} to {high:g} m [s]",
                _median(trial.time_s for trial in trials if low <= trial.side_m < high),
                most,
                "{:.2f}",
                False,
            )
            for low, high, most in TIMES
        ),
    ]
    return markdown(("what", "asked", "measured", ""), rows, "lrrl")


def _row(
    what: str, measured: float | None, asked: float, form: str, least: bool
) -> tuple[str, str, str, str]:
    sign = ">=" if least else "<="
    if measured is None:
        return what, f"{sign} {form.format(asked)}", "-", "NOT MEASURED"
    met = measured >= asked if least else measured <= asked
    return what, f"{sign} {form.format(asked)}", form.format(measured), "MET" if met else "MISSED"


def _joined(one: Sequence[Trial], least: float) -> float | None:
    some = [trial.outcome == "joined" for trial in one if trial.overlap >= least]
    return sum(some) / len(some) if some else None


def _median(values: Iterable[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return median(known) if known else None


def _by_overlap(trials: Sequence[Trial]) -> list[tuple[str, list[Trial]]]:
    return [
        (f"{low:.2f} to {min(high, 1.0):.2f}", [trial for trial in trials if low <= trial.overlap < high])
        for low, high in pairwise(EDGES)
    ]


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
