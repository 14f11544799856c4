"""The files that a study leaves beside its runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from vedette.record.files import write_text
from vedette.study.conduct import Conducted
from vedette.study.curves import CurvesOf
from vedette.study.provenance import Provenance
from vedette.study.report import Findings, report
from vedette.study.rows import Row, figure_rows, timing_rows, write_rows
from vedette.study.spec import COPY
from vedette.study.tables import difference_rows, mean_rows
from vedette.yaml_file import yaml_text

PICTURES = "curves.png", "metrics.png", "tradeoff.png"


def write_outputs(
    conducted: Conducted,
    spec: Path,
    reference: str,
    folder: Path,
    provenance: Provenance,
    *,
    pictures: bool = False,
) -> None:
    """Write results, statistics and report of the runs that are done, each file atomically.

    With ``pictures`` these are drawn, and in the report; without, those of an earlier report go.
    """
    rows, timing = figure_rows(conducted.results), timing_rows(conducted.results)
    text = yaml_text(spec, "spec")
    write_text(folder / COPY, text)
    write_rows(rows, folder / "results")
    write_rows(timing, folder / "timing")
    write_rows(mean_rows(rows), folder / "means")
    write_rows(difference_rows(rows, reference), folder / "differences")
    for name in PICTURES:
        (folder / name).unlink(missing_ok=True)
    if pictures:
        _draw(conducted, rows, folder)
    findings = Findings(
        title=f"Study {spec.stem}",
        rows=rows,
        timing=timing,
        missing=len(conducted.missing),
        reference=reference,
        spec=text,
        provenance=provenance,
        pictures=folder if pictures else None,
    )
    write_text(folder / "report.html", report(findings))


def _draw(conducted: Conducted, rows: Sequence[Row], folder: Path) -> None:
    """Draw the pictures, which takes a library that takes as long to import as a mission."""
    from vedette.study.pictures import curves_png, metrics_png, tradeoff_png

    curves: CurvesOf = {(run.case, run.setup.planner): each for run, each in conducted.results.items()}
    curves_png(rows, curves, folder / "curves.png")
    metrics_png(rows, folder / "metrics.png")
    tradeoff_png(rows, folder / "tradeoff.png")
