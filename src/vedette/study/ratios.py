"""What a study says in a few lines: planners over the reference, and how many worlds more would be needed."""

from __future__ import annotations

import math
from collections.abc import Sequence

from vedette.study.compare import Difference, difference
from vedette.study.facets import planners
from vedette.study.metrics import TIMES, TOTAL
from vedette.study.rows import Row

_TOLD = (*(metric for metric in TIMES if metric.column in ("t90_s", "t99_s")), TOTAL)


def ratios(rows: Sequence[Row], reference: str) -> list[str]:
    """Return a line for each planner but the reference that has pairs with it."""
    lines = []
    for name in planners(rows):
        found = {metric.title: difference(rows, name, reference, metric) for metric in _TOLD}
        told = [f"{title} {_said(each)}" for title, each in found.items() if math.isfinite(each.ratio.value)]
        if name != reference and told:
            lines.append(f"{name} over {reference}: {'; '.join(told)}")
    return lines


def _said(found: Difference) -> str:
    ratio, text = found.ratio, f"{found.ratio.value:.2f}"
    if math.isfinite(ratio.low):
        text += f" ({ratio.low:.2f} to {ratio.high:.2f})"
    if found.needed is not None and found.needed > found.draws:
        text += f", within 5 % with {found.needed} draws instead of {found.draws}"
    return text
