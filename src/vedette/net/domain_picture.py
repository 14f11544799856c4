"""The reports of a team of a declared domain as one picture, without knowing the truth."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec
import numpy as np

from vedette import wire
from vedette.missions.flights import FlightCase
from vedette.net.domain import AnyDomain
from vedette.net.gather import UNHEARD, now_of, sample_of
from vedette.net.report import Report
from vedette.net.shown import ShownVehicles
from vedette.record.log import VehicleSample
from vedette.record.mcap import McapFile, Medium, Place
from vedette.window.picture import Beside, Picture


class DomainOnlooker(ShownVehicles):
    """``vedette.net.feed.Onlooker``: what is known is what the first vehicle that is heard tells."""

    def __init__(self, domain: AnyDomain, case: FlightCase, only: int | None = None) -> None:
        """Look at a team of a domain; ``only``: at one vehicle, by its index."""
        from vedette.window.declared import pictures  # who looks at none does not wait for SciPy

        scene = domain.scene(case)
        super().__init__(scene.vehicles, only)
        self._domain, self._case = domain, case
        self._scene = scene if only is None else scene.only(only)
        self._decoder: msgspec.msgpack.Decoder[Any] = msgspec.msgpack.Decoder(domain.content)
        self._draw = pictures(self._scene)
        self._told: tuple[bytes, Any] | None = None  # what was told last, and what it comes to

    def see(self, reports: Mapping[int, Report], states: Mapping[int, str]) -> tuple[Any, Any]:
        """Return where vehicles are, and what is known; that is worked out anew when it has changed."""
        first = next((robot for robot in reports if robot not in states), next(iter(reports)))
        packed = reports[first].content
        if self._told is None or self._told[0] != packed:
            content = wire.decode(self._decoder, packed, "report")
            self._domain.check(content, self._case)
            self._told = packed, self._domain.known(content, self._case)
        vehicles = []
        for i in self._shown:
            if i in reports:
                vehicles.append(sample_of(reports[i].condition, states.get(i)))
            else:
                vehicles.append(
                    VehicleSample(*self._case.scenario.vehicles[i].pose, UNHEARD, True, np.empty((0, 2)))
                )
        return self._scene, self._domain.seen(now_of(reports), vehicles, self._told[1])

    def draw(self, scene: Any, snapshot: Any, beside: Beside) -> Picture:
        """Return it as the page shows it."""
        return self._draw(snapshot, beside)

    def recorder(self, place: Place | Medium, scene: Any) -> McapFile[Any]:
        """Return what tells it in messages."""
        return self._domain.recorder(place, scene)
