"""How a mission went: all figures of its summary as attributes, and what it leaves beside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Generic, Protocol, Self, TypeVar

from vedette.record.folder import OutputFolder
from vedette.record.summary import Figures, MissionSummary, Timing


class MissionReport(Protocol):
    """What a mission of any domain leaves."""

    @property
    def summary(self) -> MissionSummary:
        """Figures in simulated time."""

    @property
    def timing(self) -> Timing:
        """Figures in wall-clock time."""


ReportT = TypeVar("ReportT", bound=MissionReport)


@dataclass(frozen=True, kw_only=True, eq=False)
class MissionResult(Figures, Generic[ReportT]):
    """Added to a summary; ``to_json`` and ``write`` make ``summary.json`` of it."""

    report: ReportT = field(repr=False)
    inputs: tuple[Path, ...] = field(repr=False)  # files that must not be written over

    @classmethod
    def of(cls, report: ReportT, inputs: Sequence[Path]) -> Self:
        """Return the result of a report."""
        return cls(**vars(report.summary), report=report, inputs=tuple(inputs))

    @property
    def timing(self) -> Timing:
        """Figures in wall-clock time: they differ from run to run."""
        return self.report.timing

    def to_json(self) -> str:
        """Return the text of ``summary.json``."""
        return self.report.summary.to_json()

    def _folder(self, folder: Path | str) -> OutputFolder:
        return OutputFolder.make(Path(folder), True, "", self.inputs)
