"""Fig. 6: three robots explore an office; three stages, with the paper's planner and with the default."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from vedette.domains.mapping.planners import DEFAULT, PLANNERS
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save
from vedette.record.explore.log import ExploreSnapshot
from vedette.record.explore.raster import Window, enlarge, paint
from vedette.record.signs import FAINT, badge, draw_vehicle, legend_line, map_signs, scale_bar
from vedette_reproduction.content import Section, Table, Value, table
from vedette_reproduction.missions import PAPERS, ReproducedMission
from vedette_reproduction.run import ReproductionRun

PICTURE = "figure-6.png"
_PANEL, _GAP, _MARGIN = 3.9, 0.12, 0.15  # [inch]


def figure_6(run: ReproductionRun) -> Section:
    """Run the mission with both planners, and draw the group's map with what it is about to see."""
    size = run.scale.office
    seed = run.scale.mission_seeds[0]
    missions = [run.mission(planner) for planner in (PAPERS, DEFAULT)]
    with picture():
        _draw(missions, run)
    return Section(
        "fig-6",
        "Figure 6: three robots explore an office of 20 × 30 m",
        "Three stages of the mission; each shows the group's map combined with the team's impact. The "
        "behaviour is consistent across the group, and the mission is over when no action reduces the "
        "uncertainty.",
        (
            f"A generated office (seed {seed}) of {size[0]:g} × {size[1]:g} m in cells of 0.1 m, as in the "
            "paper; three robots of 0.5 m/s with an all-round lidar of 8 m start together. Above, one "
            "frontier each by the rate of uncertainty reduction (eq. (42), section 5.1), agreed by the "
            "token; below, the default: tours of up to six frontiers on the same objective form. "
            "Stages are where a third and two thirds of the final coverage were reached, and the end.",
            _compare(missions),
        ),
        tables=(_summary(missions), *(_curve(mission) for mission in missions)),
        pictures=(PICTURE,),
    )


def _compare(missions: Sequence[ReproducedMission]) -> str:
    papers, default = (mission.report.summary for mission in missions)

    def moment(value: float | None) -> str:
        return "never" if value is None else f"{value:.0f} s"

    return (
        f"90 % of what can be covered is known after {moment(papers.t90_s)} with the paper's planner and "
        f"{moment(default.t90_s)} with the default; the missions end ({papers.outcome.value}, "
        f"{default.outcome.value}) after {papers.time_s:.0f} s and {default.time_s:.0f} s. One mission "
        "each: no statistics; `vedette study` compares planners on many worlds."
    )


def _summary(missions: Sequence[ReproducedMission]) -> Table:
    rows: list[tuple[Value, ...]] = []
    for mission in missions:
        s = mission.report.summary
        ways = list(s.path_m.values())
        sent = s.bytes.values()
        rows.append(
            (
                s.planner, s.outcome.value, s.t50_s, s.t90_s, s.t99_s, s.time_s, s.coverage, max(ways),
                sum(ways), s.overlap, s.rounds, s.sweeps, s.bound_ratio,
                sum(each.negotiation for each in sent), sum(each.fusion for each in sent), s.collisions,
            )
        )  # fmt: skip
    return table(
        "figure_6_missions",
        "The two missions",
        (
            "planner", "outcome", "50 % [s]", "90 % [s]", "99 % [s]", "end [s]", "coverage",
            "longest way [m]", "all ways [m]", "seen by two or more", "rounds", "sweeps", "value / bound",
            "negotiation [B]", "fusion [B]", "collisions",
        ),
        rows,
    )  # fmt: skip


def _curve(mission: ReproducedMission) -> Table:
    log = mission.report.log
    rows = [
        (float(t), float(share), float(entropy), *map(float, way))
        for t, share, entropy, way in zip(log.times, log.coverage, log.entropy, log.path_length, strict=True)
    ]
    columns = ("time [s]", "coverage", "entropy [nat]", *(f"{name} [m]" for name in log.scene.vehicles))
    return table(f"figure_6_{mission.case.planner}", "The mission by the second", columns, rows, shown=False)


def _draw(missions: Sequence[ReproducedMission], run: ReproductionRun) -> None:
    frame = missions[0].world.frame
    height = _PANEL * frame.rows / frame.cols
    width = 3 * _PANEL + 2 * _GAP + 2 * _MARGIN
    row = height + 0.62
    whole = 2 * row + 0.75
    figure = Figure(figsize=(width, whole), dpi=DPI)
    window = Window(slice(0, frame.rows), slice(0, frame.cols), frame)
    for line, mission in enumerate(missions):
        bottom = whole - (line + 1) * row + 0.05
        what = "The paper's planner" if mission.case.planner == PAPERS else "The default planner"
        figure.text(
            _MARGIN / width, (bottom + height + 0.40) / whole,
            f"{what}:  {PLANNERS[mission.case.planner].summary}",
            fontsize=10, fontweight="bold", va="center",
        )  # fmt: skip
        for column, stage in enumerate(mission.report.log.stages()):
            left = _MARGIN + column * (_PANEL + _GAP)
            axes = figure.add_axes((left / width, bottom / whole, _PANEL / width, height / whole))
            assert stage.coverage is not None, "the ground is known"
            _panel(axes, mission, stage, window, (round(_PANEL * DPI), round(height * DPI)))
            axes.set_title(
                f"({'abc'[column]})  {stage.t:.0f} s, {100 * stage.coverage:.0f} % covered",
                fontsize=9,
                loc="left",
                pad=4,
            )
    _legend(figure, missions[0], width)
    scale_bar(figure, _MARGIN, 0.55, frame.cols * frame.resolution, _PANEL)
    save(figure, run.figures / PICTURE)


def _panel(
    axes: Axes, mission: ReproducedMission, stage: ExploreSnapshot, window: Window, pixels: tuple[int, int]
) -> None:
    log = mission.report.log
    colours = paint(stage, log.scene.planning, window, pixels[::-1])
    extent = window.frame.extent
    axes.imshow(np.asarray(enlarge(colours, pixels)), extent=extent, origin="lower", aspect="auto", zorder=0)
    axes.set(xticks=(), yticks=(), xlim=extent[:2], ylim=extent[2:])
    so_far = int(np.searchsorted(log.times, stage.t, side="right"))
    for i, robot in enumerate(stage.robots):
        tint = palette.unit(palette.robot_colour(i))
        axes.plot(*log.poses[:so_far, i, :2].T, color=tint, lw=1.1, alpha=0.75, zorder=2)
        draw_vehicle(axes, i, robot)
        if robot.goal is not None:
            axes.plot(*robot.goal, "s", color="white", mec=tint, mew=1.6, ms=6, zorder=5)


def _legend(figure: Figure, mission: ReproducedMission, width: float) -> None:
    """Explain robots, ways and colours in one line under the panels."""
    names = list(mission.report.log.scene.vehicles)
    signs = [
        *map_signs(),
        Patch(
            fc=palette.unit(palette.IMPACT),
            ec=FAINT,
            lw=0.6,
            label="will be observed by the team (the stronger, the likelier)",
        ),
    ]
    handles = [*(badge(i) for i in range(len(names))), *signs]
    legend_line(figure, _MARGIN, 0.22, handles, [*names, *(str(sign.get_label()) for sign in signs)])
