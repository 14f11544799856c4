"""Make the paper's figures and claims anew: run every part, keep what is done, write the report."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from vedette.record.files import write_text
from vedette.study.provenance import Provenance
from vedette_reproduction.claims.asynchrony import c9
from vedette_reproduction.claims.convergence import c3
from vedette_reproduction.claims.cost import c4_to_c7
from vedette_reproduction.claims.definition import c1, c2
from vedette_reproduction.claims.fusion import c10
from vedette_reproduction.claims.iterations import c8
from vedette_reproduction.claims.mapping import c11, c12
from vedette_reproduction.claims.search import c13
from vedette_reproduction.content import Section, Table, table, wall_table, write_csv
from vedette_reproduction.figures.figure_1 import figure_1
from vedette_reproduction.figures.figure_2 import figure_2
from vedette_reproduction.figures.figure_3 import figure_3
from vedette_reproduction.figures.figure_4 import figure_4
from vedette_reproduction.figures.figure_6 import figure_6
from vedette_reproduction.missions import Missions
from vedette_reproduction.report import About, report_html
from vedette_reproduction.run import ReproductionRun, RunScale

Made = Callable[[ReproductionRun], Section | list[Section]]

CONTENTS: dict[str, Made] = {
    "Figure 1": figure_1,
    "Figure 2": figure_2,
    "Figure 3": figure_3,
    "Figure 4": figure_4,
    "Figure 6": figure_6,
    "C1": c1,
    "C2": c2,
    "C3": c3,
    "C4 to C7": c4_to_c7,
    "C8": c8,
    "C9": c9,
    "C10": c10,
    "C11": c11,
    "C12": c12,
    "C13": c13,
}
REPORT, FIGURES, DATA, TIMING = "report.html", "figures", "data", "timing"


class ReproductionProgress(Protocol):
    """What the caller shows of how far it is."""

    def begin(self, number: int, of: int, name: str) -> None:
        """Part ``number`` (from 1) of so many begins."""

    def tell(self, text: str) -> None:
        """It has come so far."""

    def end(self, seconds: float) -> None:
        """It is done."""


@dataclass(frozen=True)
class Reproduction:
    """What a reproduction has come to."""

    sections: tuple[Section, ...]
    missing: tuple[str, ...]  # parts that were interrupted or not begun
    report: Path

    @property
    def complete(self) -> bool:
        """Whether all parts are done."""
        return not self.missing


def reproduce(
    folder: Path,
    scale: RunScale,
    seed: int,
    source: Provenance,
    progress: ReproductionProgress,
    contents: dict[str, Made] | None = None,
) -> Reproduction:
    """Run all parts and leave ``report.html``, ``figures``, ``data`` and ``timing`` in an existing folder.

    Ctrl-C ends it in good order: what is done is written, and what is not is named in the report. Files are
    moved into place when all of them are complete.

    Args:
        folder: for the results; files of the same name are replaced.
        scale: how much is computed.
        seed: of all chance; the same seed gives the same data, byte for byte, on the same machine.
        source: what made it, for the report.
        progress: is told how far it is.
        contents: the parts by name, other than all.
    """
    parts = contents or CONTENTS
    with _workshop(folder) as workshop:
        run = ReproductionRun(scale, seed, workshop / FIGURES, Missions(progress.tell), progress.tell)
        run.figures.mkdir()
        sections, seconds = _make(run, parts, progress)
        missing = tuple(list(parts)[len(seconds) :])
        about = About(source, seed, sum(seconds), missing)
        _write(workshop, sections, list(zip(parts, seconds, strict=False)), about)
        _move(workshop, folder)
    return Reproduction(tuple(sections), missing, folder / REPORT)


def _make(
    run: ReproductionRun, parts: dict[str, Made], progress: ReproductionProgress
) -> tuple[list[Section], list[float]]:
    """Run the parts one after the other; stop at Ctrl-C with those that are done."""
    sections: list[Section] = []
    seconds: list[float] = []
    try:
        for number, (name, make) in enumerate(parts.items(), start=1):
            progress.begin(number, len(parts), name)
            began = time.perf_counter()
            made = make(run)
            sections += made if isinstance(made, list) else [made]
            seconds.append(time.perf_counter() - began)
            progress.end(seconds[-1])
    except KeyboardInterrupt:
        progress.tell("interrupted")
    return sections, seconds


def _write(
    folder: Path, sections: Sequence[Section], seconds: Sequence[tuple[str, float]], about: About
) -> None:
    """Write the tables as CSV and the report with everything in it."""
    tables = [each for section in sections for each in section.tables]
    tables += [verdicts(sections), wall_table("parts", "Time that each part took", ("part", "[s]"), seconds)]
    for each in tables:
        place = folder / (TIMING if each.wall_clock else DATA)
        place.mkdir(exist_ok=True)
        write_csv(each, place / f"{each.name}.csv")
    write_text(folder / REPORT, report_html(sections, about, folder / FIGURES))


def verdicts(sections: Sequence[Section]) -> Table:
    """Return the claims with how they fared."""
    rows = [
        (
            section.name,
            section.statement,
            section.judgement,
            section.evidence,
        )
        for section in sections
        if section.verdict is not None
    ]
    return table("claims", "The claims", ("claim", "what it says", "verdict", "evidence"), rows)


@contextmanager
def _workshop(folder: Path) -> Iterator[Path]:
    """Yield an empty folder inside another; it is gone afterwards."""
    workshop = folder / ".part"
    shutil.rmtree(workshop, ignore_errors=True)
    workshop.mkdir()
    try:
        yield workshop
    finally:
        shutil.rmtree(workshop, ignore_errors=True)


def _move(workshop: Path, folder: Path) -> None:
    """Move all files to the same place in another folder, the report last."""
    files = [path for path in sorted(workshop.rglob("*")) if path.is_file()]
    for path in sorted(files, key=lambda path: path.name == REPORT):
        place = folder / path.relative_to(workshop)
        place.parent.mkdir(exist_ok=True)
        path.replace(place)
