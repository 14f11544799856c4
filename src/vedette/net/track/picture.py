"""A tracking team's reports as one picture, without knowing where its targets truly are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import nan

import numpy as np

from vedette.agent.flight import step_of
from vedette.domains.tracking.filter import predict
from vedette.missions.track.scenario import TrackScenario
from vedette.net.gather import UNHEARD, now_of
from vedette.net.report import Report
from vedette.net.shown import ShownVehicles
from vedette.net.track.content import view_of
from vedette.record.mcap import Medium, Place
from vedette.record.track.log import TrackSample, TrackScene, TrackSnapshot
from vedette.record.track.mcap import TrackMcapWriter
from vedette.window.flights import track_picture
from vedette.window.picture import Beside, Picture


class TrackOnlooker(ShownVehicles):
    """``vedette.net.feed.Onlooker``: the tracks are those of the first vehicle that is heard."""

    def __init__(self, scenario: TrackScenario, name: str, only: int | None = None) -> None:
        """Look at a team that follows the targets of a scenario; ``only``: at one vehicle, by its index."""
        self._scenario, self._prior = scenario, scenario.prior()
        scene = TrackScene.of(scenario, name)
        super().__init__(scene.vehicles, only)
        self._scene = scene if only is None else scene.only(only)

    def see(
        self, reports: Mapping[int, Report], states: Mapping[int, str]
    ) -> tuple[TrackScene, TrackSnapshot]:
        """Return where vehicles are, and what is known of the targets."""
        t = now_of(reports)
        views = {
            robot: view_of(report.condition, report.content, self._prior) for robot, report in reports.items()
        }
        holder = next((robot for robot in views if robot not in states), next(iter(views)))
        known = views[holder].tracks
        known = predict(known, max(0, step_of(t, known.dt) - known.k0))
        samples = []
        for i in self._shown:
            if i not in views:
                samples.append(
                    TrackSample(*self._scenario.vehicles[i].pose, UNHEARD, True, np.empty((0, 2)), ())
                )
            elif i in states:
                samples.append(replace(views[i].sample, state=states[i], alive=False))
            else:
                samples.append(views[i].sample)
        snapshot = TrackSnapshot(
            t=t,
            vehicles=tuple(samples),
            holder=list(self._shown).index(holder),
            truth=np.full_like(known.means, nan),
            means=known.means,
            covariances=known.covariances,
            entropy=float(known.entropies.sum()),
            nees=nan,
            squared_error=nan,
        )
        return self._scene, snapshot

    def draw(self, scene: TrackScene, snapshot: TrackSnapshot, beside: Beside) -> Picture:
        """Return it as the page shows it."""
        return track_picture(scene, snapshot, beside)

    def recorder(self, place: Place | Medium, scene: TrackScene) -> TrackMcapWriter:
        """Return what tells it in messages."""
        return TrackMcapWriter(place, scene)
