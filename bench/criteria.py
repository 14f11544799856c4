"""What is asked, what was measured, and whether that is enough."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass

from bench.table import figure, markdown
from vedette.record.summary import Figures


@dataclass(frozen=True)
class Criterion:
    """A figure that must not be passed, upwards or, with ``at_least``, downwards."""

    name: str
    asked: float
    unit: str
    at_least: bool = False

    def met(self, measured: float) -> bool:
        """Tell whether a figure is good enough; one that is not a number is not."""
        return measured >= self.asked if self.at_least else measured <= self.asked

    def ratio(self, measured: float) -> float:
        """Return how many times better than asked a figure is: 1 and more is met."""
        better, worse = (measured, self.asked) if self.at_least else (self.asked, measured)
        return better / worse if worse else math.inf

    def limit(self) -> str:
        """Say what is asked: ``<= 40 ms``."""
        return f"{'>=' if self.at_least else '<='} {figure(self.asked)} {self.unit}".rstrip()


@dataclass(frozen=True)
class Measurement:
    """One criterion's figure, with a note on what stands behind it."""

    criterion: Criterion
    measured: float | None  # None: nothing was measured that the criterion could be held against
    note: str

    @property
    def verdict(self) -> str:
        """MET, MISSED, or NOT MEASURED."""
        if self.measured is None:
            return "NOT MEASURED"
        return "MET" if self.criterion.met(self.measured) else "MISSED"

    def cells(self) -> tuple[str, str, str, str, str, str]:
        """Return the row of :func:`verdicts`."""
        criterion = self.criterion
        measured = math.nan if self.measured is None else self.measured
        ratio = criterion.ratio(measured) if criterion.asked else math.nan
        return (
            criterion.name,
            criterion.limit(),
            f"{figure(measured)} {criterion.unit}".rstrip() if math.isfinite(measured) else "-",
            figure(ratio),
            self.verdict,
            self.note,
        )

    def judged(self) -> Judged:
        """Return what is written as JSON."""
        return Judged(**asdict(self.criterion), measured=self.measured, verdict=self.verdict, note=self.note)


@dataclass(frozen=True, kw_only=True)
class Judged(Criterion):
    """A criterion with its figure, as a file has it."""

    measured: float | None  # None: nothing, or no finite number
    verdict: str
    note: str


@dataclass(frozen=True, kw_only=True)
class BenchReport(Figures):
    """The file of a bench."""

    about: Mapping[str, str]  # machine, versions, commit
    quick: bool
    measurements: tuple[Judged, ...]


def verdicts(measurements: list[Measurement]) -> str:
    """Return the table asked | measured | ratio | verdict."""
    header = ("", "asked", "measured", "ratio", "", "")
    return markdown(header, [measurement.cells() for measurement in measurements], "lrrrll")
