"""Vehicles in the window: trackers with what they know of their targets, searchers with their pdf."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.record.explore.log import RobotSample
from vedette.record.log import VehicleSample
from vedette.record.search.log import SearchScene, SearchSnapshot
from vedette.record.track.ellipse import ellipse_axes
from vedette.record.track.log import TrackScene, TrackSnapshot
from vedette.window.picture import NOTHING, SHADES, Beside, Mark, Picture, drawn

ACROSS = 200  # cells of the ground under vehicles


def track_picture(scene: TrackScene, snapshot: TrackSnapshot, beside: Beside = NOTHING) -> Picture:
    """Return a moment of tracking: targets as ellipses in which they are to 95 %."""
    frame, ground = plain_ground(scene.area)
    marks = [
        Mark(float(mean[0]), float(mean[1]), *ellipse_axes(covariance), name)
        for name, mean, covariance in zip(scene.targets, snapshot.means, snapshot.covariances, strict=True)
    ]
    figures = [("entropy", f"{snapshot.entropy:.1f} nat")]
    if isfinite(snapshot.squared_error):
        figures.append(("error", f"{float(np.sqrt(snapshot.squared_error)):.1f} m"))
    vehicles = named(scene.vehicles, snapshot.vehicles)
    return drawn(snapshot.t, frame, ground, vehicles, figures, marks=marks, beside=beside)


def search_picture(scene: SearchScene, snapshot: SearchSnapshot, beside: Beside = NOTHING) -> Picture:
    """Return a moment of a search: the likelier the target is somewhere, the deeper the shade."""
    most = float(snapshot.mass.max(initial=0.0)) or 1.0
    shade = np.ceil(snapshot.mass / most * SHADES - 0.5).astype(np.uint8)
    ground = np.where(shade > 0, OCCUPIED + shade, UNKNOWN).astype(np.uint8)
    figures, share = [("entropy", f"{snapshot.entropy:.1f} nat")], None
    if isfinite(snapshot.detection):
        share = snapshot.detection
        figures.insert(0, ("detected", f"{100 * share:.1f} %"))
    if snapshot.outside:
        figures.append(("has left", f"{100 * snapshot.outside:.1f} %"))
    side = 2.0 * scene.frame.resolution
    marks = [] if snapshot.declared is None else [Mark(*snapshot.declared, side, side, 0.0, "declared found")]
    vehicles = named(scene.vehicles, snapshot.vehicles)
    return drawn(snapshot.t, scene.frame, ground, vehicles, figures, share=share, marks=marks, beside=beside)


def plain_ground(area: tuple[float, float, float, float]) -> tuple[GridFrame, NDArray[np.uint8]]:
    """Return the ground over x0, y0, x1, y1 [m], where there is nothing but it."""
    x0, y0, x1, y1 = area
    side = (x1 - x0) / ACROSS
    frame = GridFrame(side, max(round((y1 - y0) / side), 1), ACROSS, x0, y0)
    return frame, np.full(frame.shape, FREE, np.uint8)


def named(names: Sequence[str], vehicles: Sequence[VehicleSample]) -> list[RobotSample]:
    """Return vehicles with their names, as the page draws them."""
    return [
        RobotSample(each.x, each.y, each.heading, each.state, each.alive, each.path, name, None)
        for name, each in zip(names, vehicles, strict=True)
    ]
