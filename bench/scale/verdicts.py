"""What must stay flat while the team grows, and whether it does."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from bench.criteria import Criterion, Measurement
from bench.scale.series import DENSE_FROM, FIXED, FIXED_FROM, SQUARE, STRIP, Row

FRAME = 60  # of a message around its impact at most [bytes]
FLAT, FLAT_CPU = 1.25, 1.5
FOLLOW_SPACE = ((STRIP, "chain"), (SQUARE, "balanced"))  # trees whose branches are compact in space


def judge(rows: Sequence[Row]) -> list[Measurement]:
    """Hold every domain against what is asked; of several trees the worst counts and is named."""
    return [verdict for name in dict.fromkeys(row.domain for row in rows) for verdict in _domain(name, rows)]


def _domain(name: str, rows: Sequence[Row]) -> list[Measurement]:
    own = [row for row in rows if row.domain == name]
    fixed = [row for row in own if row.area == FIXED]
    dense = [row for row in own if row.clipped and (row.area, row.tree) in FOLLOW_SPACE]
    sizes = {row.n for row in own}
    largest = max(sizes)

    def growth(what: str, limit: float, of: Callable[[Row], float], first: int, on: list[Row]) -> Measurement:
        title = f"{name}, {'fixed area' if on is fixed else 'constant density'}: {what}"
        if first not in sizes - {largest}:
            criterion = Criterion(f"{title}, from n={first} on", limit, "x")
            return Measurement(criterion, None, f"teams up to {largest}")
        criterion = Criterion(f"{title}, n={largest} to {first}", limit, "x")
        return _worst_growth(criterion, on, of, first, largest)

    biggest = max(fixed, key=lambda row: row.edge_largest)
    size = Criterion(f"{name}, fixed area: largest message", float(biggest.bound + FRAME), "B")
    return [
        growth("messages", FLAT, lambda row: row.messages_mean, FIXED_FROM, fixed),
        growth("bytes", FLAT, lambda row: row.bytes_mean, FIXED_FROM, fixed),
        growth("CPU, mean", FLAT_CPU, lambda row: row.cpu_mean, FIXED_FROM, fixed),
        Measurement(size, biggest.edge_largest, f"{biggest.tree}, n={biggest.n}; asked: the codec's bound"),
        growth("median link", FLAT, lambda row: row.edge_median, DENSE_FROM, dense),
    ]


def _worst_growth(
    criterion: Criterion, rows: Sequence[Row], of: Callable[[Row], float], first: int, last: int
) -> Measurement:
    """Judge the tree on which a figure grows most from ``first`` platforms to ``last``."""
    ratios: dict[str, float] = {}
    peak = 1.0
    for area, tree in dict.fromkeys((row.area, row.tree) for row in rows):
        sizes = {row.n: of(row) for row in rows if (row.area, row.tree) == (area, tree)}
        label = tree if area != STRIP else f"{tree} in a strip"
        growth = {n: size / sizes[first] for n, size in sizes.items() if n >= first}
        ratios[label] = growth.get(last, math.nan)
        peak = max([peak, *growth.values()])
    missing = [tree for tree, ratio in ratios.items() if math.isnan(ratio)]
    parts = [", ".join(f"{tree} {ratio:.2f}" for tree, ratio in ratios.items() if not math.isnan(ratio))]
    parts.append(f"at most {peak:.2f} on the way")
    if missing:
        parts.append(f"took too long: {', '.join(missing)}")
    return Measurement(criterion, math.nan if missing else max(ratios.values()), "; ".join(parts))
