"""Missions of vehicles in the window, by their scene: of declared domains, fields or who moves where, too."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial, singledispatch
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from vedette.maps import FREE, OCCUPIED
from vedette.record.flights import FlightScene
from vedette.record.monitor.log import MonitorScene, MonitorSnapshot
from vedette.record.own.observer import OwnScene, OwnSnapshot
from vedette.record.search.log import SearchScene
from vedette.record.track.log import TrackScene
from vedette.window.flights import named, plain_ground, search_picture, track_picture
from vedette.window.picture import NOTHING, SHADES, Beside, Picture, drawn


@singledispatch
def pictures(scene: FlightScene) -> Callable[..., Picture]:
    """Return who draws the snapshots of a mission in turn, with what is told ``Beside`` them.

    Raises:
        TypeError: nothing is known of such missions' ground.
    """
    raise TypeError(f"no picture of {type(scene).__name__}")


@pictures.register
def _(scene: TrackScene) -> Callable[..., Picture]:
    return partial(track_picture, scene)


@pictures.register
def _(scene: SearchScene) -> Callable[..., Picture]:
    return partial(search_picture, scene)


@pictures.register
def _(scene: OwnScene) -> Callable[..., Picture]:
    frame, ground = plain_ground(scene.area)

    def draw(snapshot: OwnSnapshot, beside: Beside = NOTHING) -> Picture:
        figures = [(name.replace("_", " "), f"{value:.4g}") for name, value in snapshot.figures.items()]
        vehicles = named(scene.vehicles, snapshot.vehicles)
        return drawn(snapshot.t, frame, ground, vehicles, figures, beside=beside)

    return draw


@pictures.register
def _(scene: MonitorScene) -> Callable[..., Picture]:
    """The higher the field is taken to be, the deeper the shade; where robots must not go it is black."""
    latest = MonitorSnapshot(0.0, (), 0.0, 0.0, 0.0)

    def draw(snapshot: MonitorSnapshot, beside: Beside = NOTHING) -> Picture:
        nonlocal latest
        latest = latest if snapshot.mean is None else snapshot
        figures = []
        if isfinite(snapshot.mean_age):
            age = f"{snapshot.mean_age:.0f} s ago, {snapshot.worst_age:.0f} s at worst"
            figures.append(("last looked at", age))
        if latest.rmse is not None:
            figures.append(("error", f"{latest.rmse:.3g}"))
        if latest.entropy is not None:
            figures.append(("entropy", f"{latest.entropy:.0f} nat"))
        ground = np.full(scene.frame.shape, FREE, np.uint8) if latest.mean is None else _shaded(latest.mean)
        ground[scene.blocked] = OCCUPIED
        vehicles = named(scene.vehicles, snapshot.vehicles)
        return drawn(snapshot.t, scene.frame, ground, vehicles, figures, beside=beside)

    return draw


def _shaded(mean: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return a shade of each cell, (R, C): of the lowest the first, of the highest the last."""
    low, high = float(mean.min()), float(mean.max())
    share = (mean - low) / (high - low) if high > low else np.zeros_like(mean)
    return np.asarray(OCCUPIED + 1 + np.minimum(share * SHADES, SHADES - 1).astype(np.uint8), np.uint8)
