"""What is seen of a tracking team from outside, step by step, measured against the targets' true states.

Where the views come from makes no difference: from vehicles simulated in this process, or from what vehicles
on a network report.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from msgspec import structs

from vedette.agent.flight import Itinerary
from vedette.domains.tracking.belief import Tracks
from vedette.domains.tracking.filter import nees, predict
from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.scenario import TrackScenario
from vedette.outcome import Outcome
from vedette.record.figures import RobotFigures, TeamFigures
from vedette.record.log import Floats, Sink
from vedette.record.summary import Setting, Timing
from vedette.record.track.log import TrackLog, TrackSample, TrackScene, TrackSnapshot
from vedette.record.track.summary import (
    TrackQuality,
    TrackSummary,
    consistency,
    dimensions,
    nees_band,
    squared_position_error,
)


@dataclass(frozen=True, eq=False)
class TrackView:
    """All that can be told of one vehicle from outside; nothing in it changes after it is made."""

    sample: TrackSample
    tracks: Tracks  # as it holds them, at a step of its own
    skipped: int  # measurements that it left out
    figures: RobotFigures


@dataclass(frozen=True, eq=False)
class TrackReport:
    """What a mission leaves: its figures and its log, and the logs of those it is compared with."""

    summary: TrackSummary
    timing: Timing
    log: TrackLog
    others: Mapping[str, TrackLog] = field(default_factory=dict)  # by coordination
    left_out: Mapping[str, str] = field(default_factory=dict)  # coordination: why it was not computed


class TrackObserver:
    """Measures a mission from views of its vehicles: it knows the truth, the agents do not."""

    def __init__(
        self,
        team: TrackTeam,
        name: str,
        setting: Setting,
        truth: Callable[[int], Floats],
        sinks: Sequence[Sink[TrackSnapshot]] = (),
    ) -> None:
        """Prepare to observe a mission that has not begun; ``truth(step)``: the true states (T, 4)."""
        self._team, self._setting, self._truth = team, setting, truth
        self._views: tuple[TrackView, ...] = ()  # of the last look
        self.log = TrackLog(TrackScene.of(team.scenario, name), sinks)

    def look(self, views: Sequence[TrackView]) -> None:
        """Log the next step from views of all vehicles at it, in the order of the team."""
        self._views = tuple(views)
        self.log.add(self._snapshot(self.log.step))

    def finish(self, views: Sequence[TrackView]) -> None:
        """Take what the team has counted in the end; log at least one step, however soon it ended."""
        self._views = tuple(views)
        if not self.log.snapshots:
            self.look(views)

    def _snapshot(self, step: int) -> TrackSnapshot:
        alive = [i for i, view in enumerate(self._views) if view.sample.alive]
        holders = alive or list(range(len(self._views)))
        truth = self._truth(step)
        beliefs = [_at(self._views[i].tracks, step) for i in holders]
        numbers = dimensions(self.log.scene)
        return TrackSnapshot(
            t=step * self.log.scene.dt,
            vehicles=tuple(view.sample for view in self._views),
            holder=holders[0],
            truth=truth,
            means=beliefs[0].means,
            covariances=beliefs[0].covariances,
            entropy=float(np.mean([each.entropies.sum() for each in beliefs])),
            nees=float(np.mean([nees(each, truth).sum() / numbers for each in beliefs])),
            squared_error=float(np.mean([squared_position_error(each.means, truth) for each in beliefs])),
        )

    def report(self, outcome: Outcome, timing: Timing, now: float) -> TrackReport:
        """Return what the mission leaves that ended at ``now`` [s]."""
        return TrackReport(self._summary(outcome, now), timing, self.log)

    def _summary(self, outcome: Outcome, now: float) -> TrackSummary:
        log, scene, team = self.log, self.log.scene, self._team
        options = structs.replace(
            team.options,
            objective=team.options.objective or team.scenario.objective,
            scheme=team.options.negotiates_by,
        )
        figures, samples = zip(*((view.figures, view.sample) for view in self._views), strict=True)
        quality, band = TrackQuality.of(log), nees_band(dimensions(scene))
        return TrackSummary(
            completed=outcome.completed,
            outcome=outcome,
            scenario=scene.name,
            vehicles=len(scene.vehicles),
            targets=len(scene.targets),
            time_s=now,
            steps=len(log.snapshots),
            in_view=dict(zip(scene.targets, log.in_view().tolist(), strict=True)),
            nees_band=band,
            consistency=consistency(quality.nees, band),
            skipped=sum(view.skipped for view in self._views),
            **vars(self._setting),
            **structs.asdict(options),
            **quality.of_team(),
            **vars(TeamFigures.of(scene.vehicles, figures, samples)),
        )


def ahead(flight: Itinerary, pose: Floats, scenario: TrackScenario, vehicle: int, step: int) -> Floats:
    """Return where a flight takes a vehicle, (k, 2) [m], up to the end of a plan that starts a step later."""
    ways = [pose]
    for k in range(step, step + scenario.horizon + 1):
        begin, end = k * scenario.step, (k + 1) * scenario.step
        ways.append(flight.fly(ways[-1], scenario.vehicles[vehicle].speed, begin, end))
    return np.array(ways)[:, :2]


def _at(known: Tracks, step: int) -> Tracks:
    return predict(known, max(0, step - known.k0))
