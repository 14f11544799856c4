"""Fig. 4: a map, the strategies of two platforms, and what the team is expected to observe."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from vedette.domains.mapping.impact import final_miss
from vedette.domains.mapping.layers import plain
from vedette.kernels.distance import path_to, shortcut
from vedette.maps import OCCUPIED
from vedette.negotiation import Negotiation, Tree, negotiate
from vedette.problem import exhaustive
from vedette.record import palette
from vedette.record.canvas import DPI, picture, save
from vedette.record.explore.raster import known_window
from vedette.record.signs import DASHES, FAINT, INK
from vedette_reproduction.content import Section, Table, Value, table
from vedette_reproduction.contest import (
    MOMENTS,
    OBJECTIVE,
    ContestScene,
    make_scenes,
    selfish_choice,
    share_of_selfish,
)
from vedette_reproduction.missions import specs
from vedette_reproduction.plots import colour
from vedette_reproduction.run import ReproductionRun

PICTURE = "figure-4.png"
_WIDEST, _HIGHEST, _NARROWEST, _GAP = 5.1, 5.4, 9.6, 0.12  # panels, figure, between panels [inch]
_RED = palette.unit((214, 39, 40))


def figure_4(run: ReproductionRun) -> Section:
    """Let two platforms negotiate by the paper's objective on a half-known map, and draw it."""
    scenes = list(make_scenes(run))
    scene = min(scenes, key=share_of_selfish)
    agreed = negotiate(OBJECTIVE, scene.belief, scene.candidates, Tree.chain(2))
    _draw(scene, agreed, run)
    schemes = _schemes(scene)
    timeless = [replace(each, belief=replace(each.belief, layers=plain())) for each in scenes]
    more = _schemes(min(timeless, key=share_of_selfish))
    rows = [("rate, eq. (42)", *row) for row in schemes] + [("entropy, eq. (41)", *row) for row in more]
    return Section(
        "fig-4",
        "Figure 4: a map, two platforms' strategies, and the team's impact",
        "The map that the two share, the frontiers that they decided to go to, and the team's impact on "
        "the same grid: white where the team will probably observe a cell, grey where not.",
        (
            "A moment of the mission of Fig. 6: two of its robots, the map as scanned until then, one "
            "frontier each as strategy (section 5.1), the measured sensor model, and the objective of eq. "
            f"(42) made exactly separable by time layers (docs/mapping.md, (V23)). Of the {len(MOMENTS)} "
            "moments that were tried it is the one at which the two are most in each other's way.",
            "By eq. (42), "
            + _words(schemes)
            + " By eq. (41) alone, without time, at its own most contested moment, "
            + _words(more),
        ),
        tables=(
            table(
                "figure_4_schemes",
                "How the two decide",
                ("objective", "way of deciding", "value", "share of the optimum", "sweeps", "choices"),
                rows,
            ),
            _candidate_table(scene, agreed),
        ),
        pictures=(PICTURE,),
    )


def _schemes(scene: ContestScene) -> list[tuple[Value, ...]]:
    """Compare ways of deciding on the same candidates: value, share of the optimum, sweeps, choices."""
    best = exhaustive(OBJECTIVE, scene.belief, scene.candidates)
    alone, selfish = selfish_choice(scene)
    rows: list[tuple[Value, ...]] = [
        ("each for itself", selfish, selfish / best.value, 0, _choices(alone)),
    ]
    for scheme, name in (
        ("jacobi", "the paper's: all at once, best iterate"),
        ("token", "one after the other"),
    ):
        found = negotiate(OBJECTIVE, scene.belief, scene.candidates, Tree.chain(2), scheme)
        cycle = f"; cycle of {found.cycle}" if found.cycle else ""
        rows.append(
            (name + cycle, found.value, found.value / best.value, found.sweeps, _choices(found.choice))
        )
    rows.append(("all joint choices", best.value, 1.0, None, _choices(best.choice)))
    return rows


def _choices(choice: Sequence[int]) -> str:
    return ", ".join(str(k) for k in choice)


def _words(rows: Sequence[tuple[Value, ...]]) -> str:
    shares = {str(row[0]).split(";")[0]: row[2] for row in rows}
    cycle = next((str(row[0]) for row in rows if "cycle" in str(row[0])), "")
    ended = f"ran into a {cycle.split('; ')[1]} and fell back on its best iterate" if cycle else "settled"
    return (
        f"each for itself gets {shares['each for itself']:.3f} of the optimum over all joint choices, one "
        f"after the other {shares['one after the other']:.3f}; the paper's simultaneous scheme {ended}, "
        f"{shares[_JACOBI]:.3f}."
    )


_JACOBI = "the paper's: all at once, best iterate"


def _candidate_table(scene: ContestScene, agreed: Negotiation) -> Table:
    rows: list[tuple[Value, ...]] = []
    for i, (platform, stops) in enumerate(zip(scene.platforms, scene.stops, strict=True)):
        assert platform.stops is not None
        nothing = OBJECTIVE.nothing(scene.belief)
        values = OBJECTIVE.values(scene.belief, nothing, scene.candidates[i])
        for k, stop in enumerate(stops):
            x, y = platform.stops.targets[stop].tolist()
            leg = float(platform.stops.first_leg[stop])
            rows.append((specs()[i].name, k, x, y, leg, float(values[k]), k == agreed.choice[i]))
    columns = ("robot", "candidate", "x [m]", "y [m]", "travel [s]", "value alone [nat/s]", "chosen")
    return table("figure_4_candidates", "Frontiers that each could go to", columns, rows, shown=False)


def _draw(scene: ContestScene, agreed: Negotiation, run: ReproductionRun) -> None:
    frame = scene.mission.world.frame
    window = known_window(frame, scene.classes, margin=1.0)
    part = scene.classes[window.rows, window.cols]
    extent = window.frame.extent
    aspect = (extent[1] - extent[0]) / (extent[3] - extent[2])
    height = min(_HIGHEST, _WIDEST / aspect)
    with picture():
        figure, (left, right) = _canvas(height * aspect, height)
        left.imshow(palette.CLASSES[part], extent=extent, origin="lower", interpolation="nearest")
        _strategies(left, scene, agreed)
        seen = _team_impact(scene, agreed)
        shown = right.imshow(
            seen, extent=_planning_extent(scene), origin="lower", cmap="gray", vmin=-0.9, vmax=1.0,
            interpolation="nearest",
        )  # fmt: skip
        walls = np.zeros((*part.shape, 4))
        walls[part == OCCUPIED] = (*INK, 1.0)
        right.imshow(walls, extent=extent, origin="lower", interpolation="nearest")
        shown.set_clim(-0.9, 1.0)
        for axes, title in ((left, "(a) map and strategies"), (right, "(b) the team's impact")):
            axes.set(xticks=(), yticks=(), xlim=extent[:2], ylim=extent[2:])
            axes.set_title(title, fontsize=10, loc="left", fontweight="bold")
        _legend(figure, left, right)
        save(figure, run.figures / PICTURE)


def _canvas(width: float, height: float) -> tuple[Figure, list[Axes]]:
    """Return a figure with two panels of this size [inch] side by side, and room for titles and a legend."""
    whole = max(_NARROWEST, 2 * width + 3 * _GAP), height + 0.85
    figure = Figure(figsize=whole, dpi=DPI)
    first = (whole[0] - 2 * width - _GAP) / 2
    boxes = [(first + k * (width + _GAP), 0.5) for k in range(2)]
    size = width / whole[0], height / whole[1]
    return figure, [figure.add_axes((x / whole[0], y / whole[1], *size)) for x, y in boxes]


def _strategies(axes: Axes, scene: ContestScene, agreed: Negotiation) -> None:
    for i, (platform, stops) in enumerate(zip(scene.platforms, scene.stops, strict=True)):
        assert platform.stops is not None
        assert platform.ground is not None
        axes.plot(*platform.stops.targets[stops].T, "s", mfc="none", mec=FAINT, mew=0.9, ms=5, zorder=3)
        stop = stops[agreed.choice[i]]
        cell = scene.belief.frame.flat(*platform.stops.views[stop])
        cells = shortcut(
            platform.ground.passable, path_to(platform.ground.field, platform.ground.passable, cell)
        )
        axes.plot(*scene.belief.frame.centres(cells).T, color=colour(i), lw=1.8, ls=DASHES, zorder=4)
        axes.plot(*platform.stops.targets[stop], "s", color=_RED, mec="white", mew=0.8, ms=8, zorder=6)
        axes.plot(platform.x, platform.y, "o", color=colour(i), mec="white", mew=1.0, ms=12, zorder=7)
        ink = palette.unit(palette.text_on(palette.robot_colour(i)))
        axes.annotate(
            str(i + 1), (platform.x, platform.y), (0, -0.3), textcoords="offset points", ha="center",
            va="center", fontsize=7.5, fontweight="bold", color=ink, zorder=8,
        )  # fmt: skip


def _team_impact(scene: ContestScene, agreed: Negotiation) -> NDArray[np.float32]:
    """Return the probability that the team observes each planning cell's unknown part, (r, c)."""
    team = OBJECTIVE.combine(*(own[k] for own, k in zip(scene.candidates, agreed.choice, strict=True)))
    planning = scene.belief.planning
    return (1.0 - final_miss(team, planning.size)).reshape(planning.shape)


def _planning_extent(scene: ContestScene) -> tuple[float, float, float, float]:
    return scene.belief.planning.extent


def _legend(figure: Figure, left: Axes, right: Axes) -> None:
    signs = [
        left.plot((), (), "s", color=_RED, mec="white", ms=8, label="frontier chosen")[0],
        left.plot((), (), "s", mfc="none", mec=FAINT, ms=5, label="frontier it could go to")[0],
        left.plot((), (), color=INK, lw=1.8, ls=DASHES, label="way")[0],
        left.plot(
            (), (), "s", color=palette.unit((216, 219, 222)), ms=8, mec=FAINT, mew=0.5, label="unknown"
        )[0],
        left.plot((), (), "s", color="white", ms=8, mec=FAINT, mew=0.5, label="free")[0],
    ]
    inch = 1.0 / figure.get_figheight()
    figure.legend(
        handles=signs, loc="center left", bbox_to_anchor=(0.005, 0.24 * inch), ncols=5, frameon=False,
        fontsize=8.5, columnspacing=1.2, handletextpad=0.5, borderpad=0.0, borderaxespad=0.0,
    )  # fmt: skip
    ramp = figure.add_axes((0.86, 0.17 * inch, 0.11, 0.14 * inch))
    ramp.imshow(
        np.linspace(0, 1, 64)[None], cmap="gray", vmin=-0.9, vmax=1.0, aspect="auto", extent=(0, 1, 0, 1)
    )
    ramp.set(xticks=(), yticks=())
    ramp.text(
        -0.06, 0.45, "probability that the team observes a cell  0", ha="right", va="center", fontsize=9
    )
    ramp.text(1.06, 0.45, "1", ha="left", va="center", fontsize=9)
