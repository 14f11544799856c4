"""``field.png`` and the film: truth, mean and standard deviation beside each other, with the ways."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from vedette.domains.monitoring.planning import deviations_of
from vedette.number import many, short
from vedette.record import palette
from vedette.record.canvas import picture, save
from vedette.record.film import flight_gif
from vedette.record.key import LINE, Key, badges, with_fate
from vedette.record.log import evenly
from vedette.record.monitor.log import MonitorLog, MonitorSnapshot
from vedette.record.monitor.observer import MonitorReport
from vedette.record.panels import MARGIN, STACKED, Panels
from vedette.record.signs import DASHES, FAINT, VEHICLE, draw_vehicle, explain, scale_bar

_WIDE = 3.5  # of a panel [inch]
_HIGHEST = 5.5  # [inch]
_NARROWEST = 2.6  # of what a panel takes up, its title and its colours [inch]
_LEAST = 9.0  # width of the figure, for the signs in one line [inch]
_RAMP = 0.42  # under a panel, for its colours [inch]
_COLOURS = 200  # of the film


def field_png(report: MonitorReport, path: Path | str) -> None:
    """Draw the field as it is, as it is taken to be, and how well it is known, with all ways."""
    summary, log = report.summary, report.log
    mean, deviation = report.known.mean, deviations_of(report.known)
    low, high = (float(of(report.truth)) for of in (np.min, np.max))
    same = Normalize(low, high if high > low else low + 1.0)
    mean_scale = same
    if log.scene.ages:
        most = float(np.abs(mean).max()) or 1.0
        mean_scale = Normalize(-most, most)
    sure = Normalize(0.0, float(deviation.max()))
    fields = (
        ("last looked at [s ago]" if log.scene.ages else "the field", report.truth, "viridis", same),
        (f"taken to be, error {short(summary.rmse)}", mean, "viridis", mean_scale),
        ("standard deviation", deviation, "magma", sure),
    )
    layout = _layout(log)
    with picture():
        figure = layout.figure()
        for corner, (title, values, colours, norm) in zip(layout.corners, fields, strict=True):
            axes = layout.add(figure, *corner, *layout.panel)
            _draw(axes, log, log.snapshots[-1], values, colours, norm)
            axes.set_title(title, fontsize=10, loc="left", pad=5)
            _ramp(figure, layout, corner, colours, norm)
        title = f"{log.scene.name}: {many(len(log.scene.vehicles), 'vehicle')}"
        layout.head(figure, title, f"{summary.coordination}, {summary.outcome.said}, {summary.time_s:.0f} s")
        _legend(figure, layout, log)
        save(figure, path)


def stages_png(log: MonitorLog, path: Path | str) -> None:
    """Draw what the field was taken to be at the first, a middle and the last moment it was worked out."""
    known = [snapshot for snapshot in log.snapshots if snapshot.mean is not None]
    stages = [known[i] for i in evenly(len(known), 3)]
    means = [np.asarray(stage.mean) for stage in stages]
    low, high = min(float(mean.min()) for mean in means), max(float(mean.max()) for mean in means)
    norm, layout = Normalize(low, high if high > low else low + 1.0), _layout(log)
    with picture():
        figure = layout.figure()
        for corner, stage, mean in zip(layout.corners, stages, means, strict=False):
            axes = layout.add(figure, *corner, *layout.panel)
            _draw(axes, log, stage, mean, "viridis", norm)
            axes.set_title(f"taken to be, {stage.t:.0f} s", fontsize=10, loc="left", pad=5)
            _ramp(figure, layout, corner, "viridis", norm)
        layout.head(figure, f"{log.scene.name}: {many(len(log.scene.vehicles), 'vehicle')}", "as recorded")
        _legend(figure, layout, log)
        save(figure, path)


def monitor_gif(log: MonitorLog, path: Path | str, frames: int = 150) -> None:
    """Write at most ``frames`` of the moments at which the field was worked out as a film."""
    stages = [log.measured[i] for i in evenly(len(log.measured), frames)]
    means = [stage.mean for stage in stages if stage.mean is not None]
    low, high = min(float(mean.min()) for mean in means), max(float(mean.max()) for mean in means)
    norm, frame = Normalize(low, high if high > low else low + 1.0), log.scene.frame

    def draw(axes: Axes, stage: MonitorSnapshot) -> None:
        assert stage.mean is not None
        assert stage.rmse is not None
        _draw(axes, log, stage, stage.mean, "viridis", norm)
        axes.set_title(f"{stage.t:.0f} s    error {short(stage.rmse)}", fontsize=10, loc="left", pad=5)

    flight_gif(stages, draw, frame.cols / frame.rows, _COLOURS, path)


def _draw(
    axes: Axes,
    log: MonitorLog,
    snapshot: MonitorSnapshot,
    values: NDArray[np.floating],
    colours: str,
    norm: Normalize,
) -> None:
    """Draw a field with everybody on it, and the ways up to then."""
    extent = log.scene.frame.extent
    axes.imshow(values, cmap=colours, norm=norm, extent=extent, origin="lower", aspect="equal", zorder=0)
    if log.scene.blocked.any():
        shade = np.zeros((*log.scene.blocked.shape, 4))
        shade[log.scene.blocked] = (*palette.unit(palette.INK), 0.45)
        axes.imshow(shade, extent=extent, origin="lower", aspect="equal", zorder=1)
    axes.set(xticks=(), yticks=(), xlim=extent[:2], ylim=extent[2:])
    trails = log.trails(snapshot.t)
    for i in range(len(snapshot.vehicles)):
        colour = palette.unit(palette.robot_colour(i))
        axes.plot(*trails[:, i].T, color="white", lw=2.2, alpha=0.7, solid_joinstyle="round", zorder=2)
        axes.plot(*trails[:, i].T, color=colour, lw=1.1, alpha=0.9, solid_joinstyle="round", zorder=3)
    disc = VEHICLE.among(len(snapshot.vehicles))
    for i, vehicle in enumerate(snapshot.vehicles):
        draw_vehicle(axes, i, vehicle, disc)


def _layout(log: MonitorLog) -> Panels:
    aspect = log.scene.frame.cols / log.scene.frame.rows
    panel = (_WIDE, _WIDE / aspect) if _WIDE / aspect <= _HIGHEST else (_HIGHEST * aspect, _HIGHEST)
    if aspect > STACKED:
        return _stacked(log, aspect)
    room = (max(panel[0], _NARROWEST), panel[1])
    row = Panels.in_a_row(
        room, 3, False, _LEAST, lambda width: _RAMP + 0.66 + LINE * (_team(log, width).lines + 1)
    )
    return replace(row, panel=panel)


def _stacked(log: MonitorLog, aspect: float) -> Panels:
    """Lay out panels of a wide area one above the other, each over its colours."""
    panel = (_LEAST, _LEAST / aspect)
    below = _RAMP + 0.66 + LINE * (_team(log, _LEAST + 2 * MARGIN).lines + 1)
    step = panel[1] + _RAMP + 0.3
    corners = tuple((MARGIN, below + (2 - k) * step) for k in range(3))
    return Panels(_LEAST + 2 * MARGIN, below + 3 * step + 0.5 - _RAMP, panel, corners)


def _team(log: MonitorLog, width: float) -> Key:
    return Key.of(with_fate(log.scene.vehicles, log.snapshots[-1].vehicles), width - 2 * MARGIN)


def _ramp(figure: Figure, layout: Panels, corner: tuple[float, float], colours: str, norm: Normalize) -> None:
    """Show a panel's colours under it, the least and the most at their ends."""
    x, y = corner
    axes = layout.add(figure, x + 0.6, y - 0.24, max(layout.panel[0], _NARROWEST) - 1.2, 0.1)
    axes.imshow(np.linspace(0.0, 1.0, 200)[None], cmap=colours, aspect="auto", extent=(0, 1, 0, 1))
    axes.set(xticks=(), yticks=())
    axes.spines[:].set(color=palette.unit((200, 203, 207)), lw=0.5)
    for at, value, align in ((-0.03, norm.vmin or 0.0, "right"), (1.03, norm.vmax or 0.0, "left")):
        axes.text(at, 0.5, short(value), ha=align, va="center_baseline", fontsize=8, transform=axes.transAxes)


def _legend(figure: Figure, layout: Panels, log: MonitorLog) -> None:
    """Name the vehicles, and explain the signs."""
    frame = log.scene.frame
    scale_bar(figure, MARGIN, layout.lowest - _RAMP - 0.02, frame.cols * frame.resolution, layout.panel[0])
    team = _team(log, layout.width)
    y = team.write(figure, MARGIN, layout.lowest - _RAMP - 0.38, badges(log.snapshots[-1].vehicles))
    signs = [
        Line2D((), (), color=FAINT, lw=1.2, label="gone"),
        Line2D((), (), color=FAINT, lw=1.4, ls=DASHES, label="planned"),
    ]
    if log.scene.blocked.any():
        shade = (*palette.unit(palette.INK), 0.45)
        signs.append(Line2D((), (), color=shade, lw=7, label="no way on the ground"))
    explain(figure, MARGIN, y, signs)
