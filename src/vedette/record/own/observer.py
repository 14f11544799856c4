"""What is seen of a mission of an own domain from outside, step by step, measured against what is true."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from vedette.errors import PartError
from vedette.fusion.steps import SparseIntegers
from vedette.missions.flights import FlightTeam
from vedette.missions.own.case import OwnCase
from vedette.outcome import Outcome
from vedette.record.figures import TeamFigures
from vedette.record.flights import FlightLog, FlightObserver, FlightScene, FlightSnapshot
from vedette.record.log import Sink
from vedette.record.own.summary import OwnSummary
from vedette.record.summary import Setting, Timing

_MOST = 1 << 24  # bytes


class OwnContent(msgspec.Struct, frozen=True, array_like=True, tag=1):
    """What a vehicle's evidence adds up to."""

    total: Annotated[bytes, Meta(max_length=_MOST)]  # as ``SparseIntegers`` has it


def content_of(total: NDArray[np.int64]) -> OwnContent:
    """Return the sum of a vehicle's evidence as it is told."""
    places = np.flatnonzero(total)
    elements = SparseIntegers(len(total))
    return OwnContent(elements.encode(elements.of(places, total[places])))


def total_of(content: OwnContent, size: int) -> NDArray[np.int64]:
    """Return the sum that is told; ValueError if it is none."""
    told, total = SparseIntegers(size).decode(content.total), np.zeros(size, np.int64)
    total[told.index] = told.value
    return total


@dataclass(frozen=True, kw_only=True)
class OwnScene(FlightScene):
    """What stays the same all through a mission."""

    area: tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y [m]

    @classmethod
    def of(cls, case: OwnCase) -> OwnScene:
        """Return the scene of a case."""
        names = tuple(case.names)
        return cls(
            name=case.name,
            vehicles=names,
            ranges=(0.0,) * len(names),
            dt=case.scenario.step,
            area=case.scenario.area,
        )


@dataclass(frozen=True, eq=False)
class OwnSnapshot(FlightSnapshot):
    """A mission at one step, as the first living vehicle knows it."""

    figures: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class OwnReport:
    """What a mission leaves: its figures, its log, a picture of what is known, the others beside it."""

    summary: OwnSummary
    timing: Timing
    log: FlightLog[OwnScene, OwnSnapshot]
    image: NDArray[np.float64] | None  # (R, C) over the area
    others: Mapping[str, FlightLog[OwnScene, OwnSnapshot]] = field(default_factory=dict)


class OwnObserver(FlightObserver[OwnContent, OwnSnapshot, OwnReport]):
    """Measures a mission by the theory's own figures."""

    def __init__(
        self, team: FlightTeam[OwnCase], setting: Setting, sinks: Sequence[Sink[OwnSnapshot]] = ()
    ) -> None:
        """Prepare to observe a mission that has not begun."""
        self.log: FlightLog[OwnScene, OwnSnapshot] = FlightLog(OwnScene.of(team.case), sinks)
        super().__init__(self.log)
        self._team, self._case, self._setting = team, team.case, setting
        self._truth = team.case.truth(setting.seed)
        self._total = np.zeros(team.case.theory.size, np.int64)

    def snapshot(self) -> OwnSnapshot:
        """Return the step that is logged next."""
        told = next((view.content for view in self.views if view.content is not None), None)
        if told is not None:
            self._total = total_of(told, len(self._total))
        theory = self._case.theory
        figures = dict(theory.figures(theory.belief(self._total.copy()), self._truth))
        if self.log.snapshots and list(figures) != list(self.log.snapshots[0].figures):
            raise PartError(f"domain {self._team.domain}: figures: has other names than at first")
        time = self.log.step * self._case.scenario.step
        return OwnSnapshot(time, tuple(view.sample for view in self.views), figures)

    def report(self, outcome: Outcome, timing: Timing, now: float) -> OwnReport:
        """Return what the mission leaves."""
        scene, theory = self.log.scene, self._case.theory
        figures, samples = zip(*((view.figures, view.sample) for view in self.views), strict=True)
        summary = OwnSummary(
            completed=outcome.completed,
            outcome=outcome,
            domain=self._team.domain,
            scenario=scene.name,
            vehicles=len(scene.vehicles),
            time_s=now,
            figures=self.log.snapshots[-1].figures,
            mean_figures=means(self.log),
            **vars(self._setting),
            **self._team.options.told,
            **vars(TeamFigures.of(scene.vehicles, figures, samples)),
        )
        image = theory.image(theory.belief(self._total.copy()))
        return OwnReport(summary, timing, self.log, None if image is None else np.asarray(image, float))


def means(log: FlightLog[OwnScene, OwnSnapshot]) -> dict[str, float]:
    """Return each figure's mean over time."""
    names = log.snapshots[0].figures
    return {name: float(np.mean([each.figures[name] for each in log.snapshots])) for name in names}


def compared(report: OwnReport, others: Mapping[str, OwnReport], outcome: Outcome) -> OwnReport:
    """Return a report with those of other ways of coordination beside it."""
    summary = replace(
        report.summary,
        outcome=outcome,
        completed=outcome.completed,
        comparison={name: other.summary.mean_figures for name, other in others.items()},
    )
    return replace(report, summary=summary, others={name: other.log for name, other in others.items()})
