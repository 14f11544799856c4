"""One moment of a tracking mission on a map: vehicles, what they view, and what is known of the targets."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Ellipse, Wedge
from numpy.typing import NDArray

from vedette.record import palette
from vedette.record.film import flight_gif
from vedette.record.log import evenly
from vedette.record.signs import draw_vehicle
from vedette.record.track.ellipse import ellipse_axes
from vedette.record.track.log import TrackLog, TrackSample, TrackSnapshot

INK = palette.unit(palette.INK)
TRUTH = palette.unit((150, 153, 157))
KNOWN = palette.unit((255, 183, 0))  # of an ellipse's inside
RECENT = 20.0  # a vehicle's way of so long stands out from the rest of it [s]
_MARGIN = 0.02  # of the larger side
_COLOURS = 128  # of the film

Box = tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y [m]


def window(log: TrackLog) -> Box:
    """Return the box that holds the area, everybody's way and the targets', with a margin."""
    last = log.snapshots[-1].t
    ways = np.concatenate([log.trails(last).reshape(-1, 2), log.truths(last).reshape(-1, 2)])
    x0, y0, x1, y1 = log.scene.area
    low, high = np.minimum(ways.min(axis=0), (x0, y0)), np.maximum(ways.max(axis=0), (x1, y1))
    margin = _MARGIN * float((high - low).max())
    (left, bottom), (right, top) = (low - margin).tolist(), (high + margin).tolist()
    return left, bottom, right, top


def draw(axes: Axes, log: TrackLog, snapshot: TrackSnapshot, box: Box) -> None:
    """Draw a snapshot and all ways up to it."""
    axes.set(xticks=(), yticks=(), xlim=(box[0], box[2]), ylim=(box[1], box[3]), aspect="equal")
    x0, y0, x1, y1 = log.scene.area
    frame = [(x0, x1, x1, x0, x0), (y0, y0, y1, y1, y0)]
    axes.plot(*frame, color=palette.unit((225, 227, 230)), lw=0.8, zorder=0)
    title = f"{snapshot.t:.0f} s    entropy {snapshot.entropy:.1f} nat"
    axes.set_title(title, fontsize=10, loc="left", pad=5)
    trails, truths = log.trails(snapshot.t), log.truths(snapshot.t)
    for i, vehicle in enumerate(snapshot.vehicles):
        _view(axes, log, i, vehicle)
        colour = palette.unit(palette.robot_colour(i))
        late = trails[log.times[: len(trails)] >= snapshot.t - RECENT, i]
        axes.plot(*trails[:, i].T, color=colour, lw=0.9, alpha=0.22, solid_joinstyle="round", zorder=3)
        axes.plot(*late.T, color=colour, lw=1.4, alpha=0.85, solid_joinstyle="round", zorder=3)
    for t, name in enumerate(log.scene.targets):
        axes.plot(*truths[:, t].T, color=TRUTH, lw=0.9, zorder=2)
        axes.plot(*truths[-1, t], "x", color=TRUTH, ms=5, mew=1.2, zorder=5)
        _track(axes, name, snapshot.means[t], snapshot.covariances[t])
    for i, vehicle in enumerate(snapshot.vehicles):
        draw_vehicle(axes, i, vehicle)


def track_gif(log: TrackLog, path: Path | str, frames: int = 150) -> None:
    """Write at most ``frames`` snapshots of a log that is not empty as a film, evenly chosen."""
    box = window(log)
    stages = [log.snapshots[k] for k in evenly(len(log.snapshots), frames)]
    aspect = (box[2] - box[0]) / (box[3] - box[1])
    flight_gif(stages, lambda axes, stage: draw(axes, log, stage, box), aspect, _COLOURS, path)


def _view(axes: Axes, log: TrackLog, i: int, vehicle: TrackSample) -> None:
    """Shade what a living vehicle's sensor views."""
    if not vehicle.alive:
        return
    half, facing = log.scene.views[i] / 2.0, math.degrees(vehicle.heading)
    colour = palette.unit(palette.robot_colour(i))
    at, reach = (vehicle.x, vehicle.y), log.scene.ranges[i]
    for fill, ink, width in (((*colour, 0.06), "none", 0.0), ("none", (*colour, 0.35), 0.6)):
        axes.add_patch(Wedge(at, reach, facing - half, facing + half, fc=fill, ec=ink, lw=width))


def _track(axes: Axes, name: str, mean: NDArray[np.float64], covariance: NDArray[np.float64]) -> None:
    """Draw the estimate of a target with its 95 % ellipse and its name."""
    width, height, angle = ellipse_axes(covariance)
    at = float(mean[0]), float(mean[1])
    ellipse = Ellipse(at, width, height, angle=angle, fc=(*KNOWN, 0.28), ec=INK, lw=0.9, zorder=4)
    axes.add_patch(ellipse)
    axes.plot(*at, "o", color=INK, ms=2.2, zorder=5)
    axes.annotate(
        name, at, (5, 4), textcoords="offset points", fontsize=7, color=INK, zorder=8, annotation_clip=True
    )
