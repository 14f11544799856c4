"""The whole scale section: measured, judged, written and told."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.criteria import BenchReport, verdicts
from bench.scale.picture import scale_png
from bench.scale.series import DOMAINS, QUICK_SIZES, SIZES, Row, rows
from bench.scale.tables import brief, full
from bench.scale.verdicts import judge
from vedette.record.files import write_text


@dataclass(frozen=True, kw_only=True)
class ScaleReport(BenchReport):
    """``scale.json``."""

    rows: tuple[Row, ...]


def run(
    folder: Path,
    about: Mapping[str, str],
    quick: bool,
    progress: Callable[[str], None],
    domains: Sequence[str] = tuple(DOMAINS),
) -> str:
    """Measure, write ``scale.json``, ``scale.md`` and ``scale.png``, and return what to show."""
    table = list(rows(domains, QUICK_SIZES if quick else SIZES, progress))
    judged = judge(table)
    path = folder / ("scale-quick.json" if quick else "scale.json")
    measurements = tuple(each.judged() for each in judged)
    ScaleReport(about=about, quick=quick, measurements=measurements, rows=tuple(table)).write(path)
    write_text(path.with_suffix(".md"), f"{full(table)}\n{verdicts(judged)}")
    scale_png(table, path.with_suffix(".png"))
    return f"{brief(table)}\n{verdicts(judged)}\nwritten: {path}, and beside it .md and .png"
