"""``progress.png``: the mission in three stages, as in Figs. 4 and 6 of the paper."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vedette.maps import UNKNOWN
from vedette.number import many
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save
from vedette.record.explore.log import ExploreLog, ExploreSnapshot, RobotSample
from vedette.record.explore.raster import Window, enlarge, known_window, paint
from vedette.record.explore.told import caption
from vedette.record.key import LINE, Key, badges, with_fate
from vedette.record.panels import MARGIN, STACKED, Panels
from vedette.record.signs import (
    DASHES,
    ROBOT,
    draw_disc,
    draw_links,
    explain,
    link_signs,
    map_signs,
    scale_bar,
)

_NARROW, _WIDE = 6.4, 10.0  # least width of a figure, and of one with all signs in one line [inch]


def progress_png(log: ExploreLog, path: Path | str) -> None:
    """Draw map, team impact, robots, paths and goals at three stages of a log that is not empty."""
    stages = log.stages()
    window = known_window(log.scene.frame, stages[-1].classes)
    layout = _layout(window.frame.cols / window.frame.rows, len(stages), stages[-1])
    with picture():
        figure = layout.figure()
        for corner, stage in zip(layout.corners, stages, strict=True):
            _panel(figure, corner, layout, log, window, stage)
        joins = "" if stages[-1].frames is None else stages[-1].frames.joined_after
        layout.head(figure, f"{log.scene.name}: {many(len(log.scene.vehicles), 'robot')}{joins}")
        metres = window.frame.cols * window.frame.resolution
        scale_bar(figure, MARGIN, layout.lowest - 0.16, metres, layout.panel[0])
        _legend(figure, layout, stages[-1])
        save(figure, path)


def _layout(aspect: float, panels: int, last: ExploreSnapshot) -> Panels:
    """Fit the panels: side by side, or one above the other where the map is far wider than high."""
    stacked = aspect > STACKED
    width = 9.0 if stacked else max(0.3, min(4.2, 6.5 * aspect))
    panel = width, max(0.2, min(6.5, width / aspect))
    return Panels.in_a_row(panel, panels, stacked, _NARROW, lambda width: 0.42 + LINE * _lines(width, last))


def _panel(
    figure: Figure,
    corner: tuple[float, float],
    layout: Panels,
    log: ExploreLog,
    window: Window,
    stage: ExploreSnapshot,
) -> None:
    """Draw one stage."""
    axes = layout.add(figure, *corner, *layout.panel)
    size = max(1, round(layout.panel[0] * DPI)), max(1, round(layout.panel[1] * DPI))
    colours = paint(stage, log.scene.planning, window, size[::-1])
    axes.imshow(
        np.asarray(enlarge(colours, size)),
        extent=window.frame.extent,
        origin="lower",
        aspect="auto",
        zorder=0,
    )
    axes.set(xticks=(), yticks=(), xlim=window.frame.extent[:2], ylim=window.frame.extent[2:])
    axes.set_title(caption(stage), fontsize=10, loc="left", pad=5)
    so_far = int(np.searchsorted(log.times, stage.t, side="right"))
    trails = log.poses[:so_far, :, :2]
    for i, robot in enumerate(stage.robots):
        _ways(axes, palette.unit(palette.robot_colour(i)), trails[:, i], robot)
    draw_links(axes, stage.robots, stage.links or ())
    disc = ROBOT.among(len(stage.robots))
    for i, robot in enumerate(stage.robots):
        draw_disc(axes, i, robot, disc)


def _ways(
    axes: Axes, colour: tuple[float, float, float], trail: NDArray[np.float64], robot: RobotSample
) -> None:
    """Draw where a robot has been, and where it is going."""
    axes.plot(*trail.T, color=colour, lw=1.3, alpha=0.75, solid_joinstyle="round", zorder=2)
    axes.plot(*trail[0], "o", color="white", mec=colour, mew=1.0, ms=3.5, zorder=3)
    if not robot.alive:
        return
    if len(robot.path) > 1:
        axes.plot(*robot.path.T, color="white", lw=2.6, alpha=0.7, zorder=3)
        axes.plot(*robot.path.T, color=colour, lw=1.4, ls=DASHES, zorder=4)
    if robot.goal is not None:
        axes.plot(*robot.goal, "s", color="white", mec=colour, mew=1.8, ms=6.5, zorder=5)


def _legend(figure: Figure, layout: Panels, last: ExploreSnapshot) -> None:
    """Explain robots, links, ways, cell classes and the impact's colour under the panels."""
    team = _team(layout.width, last)
    y = team.write(figure, MARGIN, layout.lowest - 0.42, badges(last.robots))
    if last.links is not None:
        explain(figure, MARGIN, y, link_signs())
        y -= LINE
    explain(figure, MARGIN, y, map_signs())
    if last.frames is None:  # else impacts lie on planes of their own
        _impact_ramp(figure, layout, y if layout.width >= _WIDE else y - LINE)


def _team(width: float, last: ExploreSnapshot) -> Key:
    return Key.of(with_fate([robot.name for robot in last.robots], last.robots), width - 2 * MARGIN)


def _lines(width: float, last: ExploreSnapshot) -> int:
    """Count the lines of the legend: robots, links if they are simulated, all else."""
    return _team(width, last).lines + (last.links is not None) + (1 if width >= _WIDE else 2)


def _impact_ramp(figure: Figure, layout: Panels, y: float) -> None:
    """Show the colours of impacts 0 to 1 at the right of the line at ``y`` [inch]."""
    share = np.linspace(0, 1, 64, dtype=np.float32)[None, :]
    colours = palette.blend_impact(np.broadcast_to(palette.CLASSES[UNKNOWN], (1, 64, 3)), share)
    x = layout.width - MARGIN - 1.1 if layout.width >= _WIDE else MARGIN + 2.95
    axes = layout.add(figure, x, y - 0.06, 0.9, 0.12)
    axes.imshow(colours, aspect="auto", extent=(0, 1, 0, 1))
    axes.set(xticks=(), yticks=())
    for x, text, align in (
        (-0.06, "probability that the team will observe it   0", "right"),
        (1.06, "1", "left"),
    ):
        axes.text(x, 0.5, text, ha=align, va="center_baseline", fontsize=9)
