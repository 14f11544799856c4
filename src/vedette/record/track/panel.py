"""One moment of a tracking mission on a map: vehicles, what they view, and what is known of the targets."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Ellipse, Wedge

from vedette.record import palette
from vedette.record.film import flight_gif
from vedette.record.lettering import write_labels
from vedette.record.log import Floats, evenly
from vedette.record.signs import VEHICLE, draw_vehicle
from vedette.record.track.ellipse import ellipse_axes
from vedette.record.track.letters import letter
from vedette.record.track.log import TrackLog, TrackSample, TrackScene, TrackSnapshot

INK = palette.unit(palette.INK)
TRUTH = palette.unit((150, 153, 157))
KNOWN = palette.unit((255, 183, 0))  # of an ellipse's inside
RECENT = 20.0  # a vehicle's way of so long stands out from the rest of it [s]
_MARGIN = 0.02  # of the larger side
_COLOURS = 128  # of the film
_VIEW = 0.06  # opacity of a view
_NAMED, _SHORT, _LETTERED = 8, 12, 52  # targets with names, letters of these, targets with a letter; at most

Box = tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y [m]


def window(log: TrackLog) -> Box:
    """Return the box that holds the area, everybody's way and the targets', with a margin."""
    last = log.snapshots[-1].t
    ways = np.concatenate([log.trails(last).reshape(-1, 2), log.truths(last).reshape(-1, 2)])
    ways = ways[np.isfinite(ways).all(axis=1)]  # where nobody knows the targets' true ways
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
    opacity = _opacity(log, snapshot, box)
    for i, vehicle in enumerate(snapshot.vehicles):
        _view(axes, log, i, vehicle, opacity)
        colour = palette.unit(palette.robot_colour(i))
        late = trails[log.times[: len(trails)] >= snapshot.t - RECENT, i]
        axes.plot(*trails[:, i].T, color=colour, lw=0.9, alpha=0.22, solid_joinstyle="round", zorder=3)
        axes.plot(*late.T, color=colour, lw=1.4, alpha=0.85, solid_joinstyle="round", zorder=3)
    for t in range(len(log.scene.targets)):
        axes.plot(*truths[:, t].T, color=TRUTH, lw=0.9, zorder=2)
        axes.plot(*truths[-1, t], "x", color=TRUTH, ms=5, mew=1.2, zorder=5)
        _track(axes, snapshot.means[t], snapshot.covariances[t])
    disc = VEHICLE.among(len(snapshot.vehicles))
    for i, vehicle in enumerate(snapshot.vehicles):
        draw_vehicle(axes, i, vehicle, disc)
    if labels := labels_of(log.scene):
        discs = np.array([(vehicle.x, vehicle.y) for vehicle in snapshot.vehicles])
        write_labels(axes, snapshot.means[:, :2], labels, discs, disc.size / 2.0 + 1.0)


def labels_of(scene: TrackScene) -> Sequence[str]:
    """Return how targets are called in a picture: names where few and short, else letters, else not."""
    if len(scene.targets) <= _NAMED and max(map(len, scene.targets)) <= _SHORT:
        return scene.targets
    return [letter(t) for t in range(len(scene.targets))] if len(scene.targets) <= _LETTERED else []


def track_gif(log: TrackLog, path: Path | str, frames: int = 150) -> None:
    """Write at most ``frames`` snapshots of a log that is not empty as a film, evenly chosen."""
    box = window(log)
    stages = [log.snapshots[k] for k in evenly(len(log.snapshots), frames)]
    aspect = (box[2] - box[0]) / (box[3] - box[1])
    flight_gif(stages, lambda axes, stage: draw(axes, log, stage, box), aspect, _COLOURS, path)


def _opacity(log: TrackLog, snapshot: TrackSnapshot, box: Box) -> float:
    """Return the opacity of a view: less where views together would grey the picture."""
    ranges, views = np.array(log.scene.ranges), np.radians(log.scene.views)
    alive = np.array([vehicle.alive for vehicle in snapshot.vehicles])
    area = (box[2] - box[0]) * (box[3] - box[1])
    shares = np.minimum(ranges**2 * views / 2.0 / area, 1.0)
    return _VIEW / max(1.0, float(shares[alive].sum()))


def _view(axes: Axes, log: TrackLog, i: int, vehicle: TrackSample, opacity: float) -> None:
    """Shade what a living vehicle's sensor views."""
    if not vehicle.alive:
        return
    half, facing = log.scene.views[i] / 2.0, math.degrees(vehicle.heading)
    colour = palette.unit(palette.robot_colour(i))
    at, reach = (vehicle.x, vehicle.y), log.scene.ranges[i]
    for fill, ink, width in (((*colour, opacity), "none", 0.0), ("none", (*colour, 0.35), 0.6)):
        axes.add_patch(Wedge(at, reach, facing - half, facing + half, fc=fill, ec=ink, lw=width))


def _track(axes: Axes, mean: Floats, covariance: Floats) -> None:
    """Draw the estimate of a target with its 95 % ellipse."""
    width, height, angle = ellipse_axes(covariance)
    at = float(mean[0]), float(mean[1])
    ellipse = Ellipse(at, width, height, angle=angle, fc=(*KNOWN, 0.28), ec=INK, lw=0.9, zorder=4)
    axes.add_patch(ellipse)
    axes.plot(*at, "o", color=INK, ms=2.2, zorder=5)
