"""``progress.png``: the mission in three stages, as in Figs. 4 and 6 of the paper."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from vedette.maps import UNKNOWN
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save
from vedette.record.explore.log import ExploreLog, ExploreSnapshot, RobotSample
from vedette.record.explore.raster import Window, enlarge, known_window, paint
from vedette.record.signs import DASHES, badge, draw_links, legend_line, link_signs, map_signs, scale_bar

_GAP, _MARGIN, _TOP = 0.14, 0.2, 0.72  # [inch]
_LINE = 0.25  # of the legend [inch]
_NARROW, _WIDE = 6.4, 10.0  # least width of a figure, and of one with all signs in one line [inch]


@dataclass(frozen=True)
class _Layout:
    """Sizes of the figure [inch]."""

    width: float
    height: float
    panel: tuple[float, float]
    corners: tuple[tuple[float, float], ...]  # lower-left of each panel


def progress_png(log: ExploreLog, path: Path | str) -> None:
    """Draw map, team impact, robots, paths and goals at three stages of a log that is not empty."""
    stages = log.stages()
    window = known_window(log.scene.frame, stages[-1].classes)
    layout = _layout(window.frame.cols / window.frame.rows, len(stages), stages[-1])
    with picture():
        figure = Figure(figsize=(layout.width, layout.height), dpi=DPI)
        for corner, stage in zip(layout.corners, stages, strict=True):
            _panel(figure, corner, layout, log, window, stage)
        _heading(figure, layout, log)
        lowest = min(corner[1] for corner in layout.corners)
        metres = window.frame.cols * window.frame.resolution
        scale_bar(figure, layout.corners[0][0], lowest - 0.16, metres, layout.panel[0])
        _legend(figure, layout, stages[-1])
        save(figure, path)


def _layout(aspect: float, panels: int, last: ExploreSnapshot) -> _Layout:
    """Fit the panels: side by side, or one above the other where the map is far wider than high."""
    stacked = aspect > 2.2
    panel_width = 9.0 if stacked else max(0.3, min(4.2, 6.5 * aspect))
    panel = panel_width, max(0.2, min(6.5, panel_width / aspect))
    across = 1 if stacked else panels
    width = max(_NARROW, across * panel_width + (across - 1) * _GAP + 2 * _MARGIN)
    bottom = 0.42 + _LINE * _legend_lines(width, last)
    if stacked:
        step = panel[1] + 0.3
        corners = tuple((_MARGIN, bottom + step * (panels - 1 - i)) for i in range(panels))
        return _Layout(width, bottom + step * panels + _TOP - 0.3, panel, corners)
    step = (width - 2 * _MARGIN - panel_width) / (panels - 1)
    corners = tuple((_MARGIN + i * step, bottom) for i in range(panels))
    return _Layout(width, bottom + panel[1] + _TOP, panel, corners)


def _panel(
    figure: Figure,
    corner: tuple[float, float],
    layout: _Layout,
    log: ExploreLog,
    window: Window,
    stage: ExploreSnapshot,
) -> None:
    """Draw one stage."""
    axes = figure.add_axes(_box(layout, *corner, *layout.panel))
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
    axes.set_title(f"{stage.t:.0f} s    {100 * stage.coverage:.1f} % covered", fontsize=10, loc="left", pad=5)
    so_far = int(np.searchsorted(log.times, stage.t, side="right"))
    trails = log.poses[:so_far, :, :2]
    for i, robot in enumerate(stage.robots):
        _ways(axes, palette.unit(palette.robot_colour(i)), trails[:, i], robot)
    draw_links(axes, stage.robots, stage.links or ())
    for i, robot in enumerate(stage.robots):
        _robot(axes, i, robot)


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


def _robot(axes: Axes, index: int, robot: RobotSample) -> None:
    """Draw a numbered disc with a nose that points where the robot looks; a cross if it is lost."""
    colour = palette.robot_colour(index)
    if not robot.alive:
        axes.plot(robot.x, robot.y, "X", color=palette.unit(colour), mec="white", mew=0.8, ms=11, zorder=6)
        return
    ahead = np.array((math.cos(robot.heading), math.sin(robot.heading))) * 7.2 / 72
    nose = axes.transData + ScaledTranslation(ahead[0], ahead[1], axes.figure.dpi_scale_trans)
    turned = (3, 0, math.degrees(robot.heading) - 90)
    axes.plot(
        robot.x, robot.y, marker=turned, ms=7, color=palette.unit(colour), mec="white", mew=0.7, zorder=6,
        transform=nose,
    )  # fmt: skip
    axes.plot(robot.x, robot.y, "o", color=palette.unit(colour), mec="white", mew=0.9, ms=11, zorder=7)
    axes.annotate(
        str(index + 1), (robot.x, robot.y), (0, -0.3), textcoords="offset points", ha="center", va="center",
        fontsize=7, fontweight="bold", color=palette.unit(palette.text_on(colour)), zorder=8,
    )  # fmt: skip


def _heading(figure: Figure, layout: _Layout, log: ExploreLog) -> None:
    """Write the world and the team over the panels."""
    robots = f"{len(log.scene.vehicles)} robot" + ("s" if len(log.scene.vehicles) > 1 else "")
    at = _MARGIN / layout.width, 1 - 0.2 / layout.height
    figure.text(*at, f"{log.scene.name}: {robots}", fontsize=12, fontweight="bold", va="top")


def _legend(figure: Figure, layout: _Layout, last: ExploreSnapshot) -> None:
    """Explain robots, links, ways, cell classes and the impact's colour under the panels."""
    robots = last.robots
    team = [badge(i, robot.alive) for i, robot in enumerate(robots)]
    labels = [robot.name + ("" if robot.alive else " (lost)") for robot in robots]
    per_row = _robots_a_row(layout.width, robots)
    y = min(corner[1] for corner in layout.corners) - 0.42
    for first in range(0, len(team), per_row):
        some = slice(first, first + per_row)
        legend_line(figure, _MARGIN, y, team[some], labels[some])
        y -= _LINE
    if last.links is not None:
        _explain(figure, y, link_signs())
        y -= _LINE
    _explain(figure, y, map_signs())
    _impact_ramp(figure, layout, y if layout.width >= _WIDE else y - _LINE)


def _explain(figure: Figure, y: float, signs: Sequence[Line2D | Patch]) -> None:
    """Write a line of the legend at ``y`` [inch] from signs that have labels."""
    legend_line(figure, _MARGIN, y, signs, [str(sign.get_label()) for sign in signs])


def _legend_lines(width: float, last: ExploreSnapshot) -> int:
    """Count the lines of the legend: robots, links if they are simulated, all else."""
    robots = -(-len(last.robots) // _robots_a_row(width, last.robots))
    return robots + (last.links is not None) + (1 if width >= _WIDE else 2)


def _robots_a_row(width: float, robots: Sequence[RobotSample]) -> int:
    """Count the robots that a line of the legend holds, by the longest name."""
    entry = 0.5 + 0.07 * max(len(robot.name) + (0 if robot.alive else 7) for robot in robots)
    return max(1, int((width - 2 * _MARGIN) / entry))


def _impact_ramp(figure: Figure, layout: _Layout, y: float) -> None:
    """Show the colours of impacts 0 to 1 at the right of the line at ``y`` [inch]."""
    share = np.linspace(0, 1, 64, dtype=np.float32)[None, :]
    colours = palette.blend_impact(np.broadcast_to(palette.CLASSES[UNKNOWN], (1, 64, 3)), share)
    x = layout.width - _MARGIN - 1.1 if layout.width >= _WIDE else _MARGIN + 2.95
    axes = figure.add_axes(_box(layout, x, y - 0.06, 0.9, 0.12))
    axes.imshow(colours, aspect="auto", extent=(0, 1, 0, 1))
    axes.set(xticks=(), yticks=())
    for x, text, align in (
        (-0.06, "probability that the team will observe it   0", "right"),
        (1.06, "1", "left"),
    ):
        axes.text(x, 0.5, text, ha=align, va="center_baseline", fontsize=9)


def _box(
    layout: _Layout, x: float, y: float, width: float, height: float
) -> tuple[float, float, float, float]:
    """Return a rectangle [inch] in figure fractions."""
    return x / layout.width, y / layout.height, width / layout.width, height / layout.height
