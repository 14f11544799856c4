"""Tables in Markdown that also read well as they are."""

from __future__ import annotations

import math
from collections.abc import Sequence

from vedette.study.intervals import Interval


def figure(value: float | None) -> str:
    """Return a number with four digits that count, ``-`` where there is none."""
    if value is None or not math.isfinite(value):
        return "-"
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.4g}"


def ratio_cell(interval: Interval) -> str:
    """Return a ratio; its interval if there were draws enough for one, ``-`` if there was none to compare."""
    if math.isnan(interval.value):
        return "-"
    return f"{interval.value:.2f} {interval_cell(interval)}".rstrip()


def interval_cell(interval: Interval) -> str:
    """Return the interval of a ratio in brackets; nothing where there is none."""
    return f"({interval.low:.2f}-{interval.high:.2f})" if math.isfinite(interval.low) else ""


def markdown(header: Sequence[str], rows: Sequence[Sequence[str]], align: str) -> str:
    """Return a table; ``align`` holds ``l`` or ``r`` for each column."""
    lines = [tuple(header), *map(tuple, rows)]
    widths = [max(2, *map(len, column)) for column in zip(*lines, strict=True)]
    rule = [
        "-" * (width - 1) + (":" if side == "r" else "-") for width, side in zip(widths, align, strict=True)
    ]
    padded = [
        [
            cell.rjust(width) if side == "r" else cell.ljust(width)
            for cell, width, side in zip(line, widths, align, strict=True)
        ]
        for line in lines
    ]
    return "".join(f"| {' | '.join(line)} |\n" for line in (padded[0], rule, *padded[1:]))
