"""What is asked, what was measured, and whether that is enough."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bench.table import figure, markdown


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
    measured: float
    note: str

    @property
    def verdict(self) -> str:
        """MET or MISSED."""
        return "MET" if self.criterion.met(self.measured) else "MISSED"

    def cells(self) -> tuple[str, str, str, str, str, str]:
        """Return the row of :func:`verdicts`."""
        criterion = self.criterion
        ratio = criterion.ratio(self.measured) if criterion.asked else math.nan
        return (
            criterion.name,
            criterion.limit(),
            f"{figure(self.measured)} {criterion.unit}".rstrip(),
            figure(ratio),
            self.verdict,
            self.note,
        )


def verdicts(measurements: list[Measurement]) -> str:
    """Return the table asked | measured | ratio | MET or MISSED."""
    header = ("", "asked", "measured", "ratio", "", "")
    return markdown(header, [measurement.cells() for measurement in measurements], "lrrrll")
