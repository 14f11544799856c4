"""A searching team's reports as one picture, without knowing where the target truly is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import nan

import numpy as np

from vedette.missions.search.case import SearchCase
from vedette.net.gather import UNHEARD, now_of
from vedette.net.report import Report
from vedette.net.search.content import view_of
from vedette.net.shown import ShownVehicles
from vedette.record.mcap import Medium, Place
from vedette.record.search.log import SearchSample, SearchScene, SearchSnapshot
from vedette.record.search.mcap import SearchMcapWriter
from vedette.record.search.observer import first_declared
from vedette.window.flights import search_picture
from vedette.window.picture import Beside, Picture


class SearchOnlooker(ShownVehicles):
    """``vedette.net.feed.Onlooker``: the pdf is that of the first vehicle that is heard."""

    def __init__(self, case: SearchCase, only: int | None = None) -> None:
        """Look at a team that searches; ``only``: at one vehicle, by its index."""
        scene = SearchScene.of(case, case.scenario.duration)
        super().__init__(scene.vehicles, only)
        self._case = case
        self._scene = scene if only is None else scene.only(only)

    def see(
        self, reports: Mapping[int, Report], states: Mapping[int, str]
    ) -> tuple[SearchScene, SearchSnapshot]:
        """Return where vehicles are, and how likely the target is where."""
        views = {
            robot: view_of(report.condition, report.content, self._case.pdf)[0]
            for robot, report in reports.items()
        }
        known = views[next((robot for robot in views if robot not in states), next(iter(views)))].pdf
        assert known is not None
        samples = []
        for i in self._shown:
            if i not in views:
                samples.append(
                    SearchSample(*self._case.scenario.vehicles[i].pose, UNHEARD, True, np.empty((0, 2)), None)
                )
            elif i in states:
                samples.append(replace(views[i].sample, state=states[i], alive=False))
            else:
                samples.append(views[i].sample)
        declared = first_declared([view.declared for view in views.values()])
        snapshot = SearchSnapshot(
            t=now_of(reports),
            vehicles=tuple(samples),
            mass=known.mass.astype(np.float32),
            entropy=known.entropy,
            detection=nan,
            target=(nan, nan),
            outside=known.outside if known.motion.leaves else None,
            declared=None if declared is None else (declared[1].x, declared[1].y),
        )
        return self._scene, snapshot

    def draw(self, scene: SearchScene, snapshot: SearchSnapshot, beside: Beside) -> Picture:
        """Return it as the page shows it."""
        return search_picture(scene, snapshot, beside)

    def recorder(self, place: Place | Medium, scene: SearchScene) -> SearchMcapWriter:
        """Return what tells it in messages."""
        return SearchMcapWriter(place, scene)
