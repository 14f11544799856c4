"""An exploring team's reports as one picture, without knowing the world that it explores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import planning_factor
from vedette.domains.mapping.impact import MapImpactCodec, cells_missed, moved
from vedette.domains.mapping.leftovers import Leftover
from vedette.maps import UNKNOWN, GridFrame
from vedette.maps.laid import part_laid
from vedette.net.explore.content import MOST_CELLS, MapContent, classes_of, frame_of, read_content, sample_of
from vedette.net.gather import status_of
from vedette.net.names import robot_name
from vedette.net.report import Condition, Report
from vedette.net.results import lasted
from vedette.record.explore.log import ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.views import left_out
from vedette.record.links import Link, links_of

NOWHERE = GridFrame(1.0, 1, 1)


def picture_of(
    team: str, reports: Mapping[int, Report], states: Mapping[int, str]
) -> tuple[ExploreScene, ExploreSnapshot]:
    """Return what robots report, together: the map that they hold, where they are, what they believe.

    Args:
        team: its name.
        reports: by robot, its latest.
        states: words that take the place of robots' own.

    Raises:
        ValueError: a report is malformed.
    """
    contents = [read_content(report.content) for report in reports.values()]
    frame, classes = _together(contents)
    planning = frame.coarse(planning_factor(frame.resolution))
    names = tuple(map(robot_name, reports))
    scene = ExploreScene(name=team, vehicles=names, frame=frame, planning=planning)
    told = [report.condition for report in reports.values()]
    snapshot = ExploreSnapshot(
        t=max((lasted(each) for each in told), default=0.0),
        robots=tuple(
            replace(_sample(report, states.get(robot), content), trust=_trust(robot, told))
            for (robot, report), content in zip(reports.items(), contents, strict=True)
        ),
        coverage=None,
        known_fraction=max((each.known for each in told if each.known is not None), default=None),
        entropy=None,
        classes=classes,
        impact=_impact(contents, planning),
        links=_links(reports),
        left_out=tuple(
            spot
            for name, each in zip(names, contents, strict=True)
            for spot in left_out([Leftover(*leaves) for leaves in each.left_out], name)
        ),
        known_m2=float(np.count_nonzero(classes != UNKNOWN)) * frame.resolution**2,
        frontiers=max((each.frontiers for each in told if each.frontiers is not None), default=None),
    )
    return scene, snapshot


def _together(maps: Sequence[MapContent]) -> tuple[GridFrame, NDArray[np.uint8]]:
    """Return the least grid that holds all maps, and what they know together; occupied wins over free."""
    parts = [(frame_of(each), classes_of(each)) for each in maps if each.rows and each.cols]
    if not parts:
        return NOWHERE, np.zeros(NOWHERE.shape, np.uint8)
    frame = _around([part for part, _ in parts])
    whole = np.zeros(frame.shape, np.uint8)
    for part, classes in parts:
        there, under = part_laid(classes, part, frame)
        whole[there] = np.maximum(whole[there], under)  # UNKNOWN < FREE < OCCUPIED
    return frame, whole


def _links(reports: Mapping[int, Report]) -> tuple[Link, ...]:
    """Return the links that both ends tell of, by the places of their robots among the reports."""
    place = {robot: i for i, robot in enumerate(reports)}
    told = [reports.get(robot) for robot in range(max(reports, default=-1) + 1)]
    links = links_of([None if each is None else status_of(each.condition) for each in told])
    return tuple(replace(link, a=place[link.a], b=place[link.b]) for link in links)


def _impact(maps: Sequence[MapContent], planning: GridFrame) -> NDArray[np.float32]:
    """Return ``(r, c)`` how likely the robots' strategies show each planning cell, together.

    Raises:
        ValueError: an impact is malformed.
    """
    miss = np.ones(planning.size, np.float32)
    for each in maps:
        if each.impact is None or not each.rows or not each.cols:
            continue
        side = each.resolution
        corner = each.x - each.col * side, each.y - each.row * side
        own = GridFrame(side, *each.lattice, *corner).coarse(planning_factor(side))
        cells, missed = cells_missed(moved(MapImpactCodec(own.size).decode(each.impact), own, planning))
        miss[cells] *= missed
    return (1.0 - miss).reshape(planning.shape)


def _around(frames: Sequence[GridFrame]) -> GridFrame:
    resolution = frames[0].resolution
    extents = np.array([frame.extent for frame in frames])
    x, y = float(extents[:, 0].min()), float(extents[:, 2].min())
    rows = round((float(extents[:, 3].max()) - y) / resolution)
    cols = round((float(extents[:, 1].max()) - x) / resolution)
    if rows * cols > MOST_CELLS:
        raise ValueError(f"reports of maps that lie {cols * resolution:.0f} m apart")
    return GridFrame(resolution, rows, cols, x, y)


def _trust(robot: int, told: Sequence[Condition]) -> str:
    """Say who believes a robot; nothing where nobody signs."""
    against = [robot_name(each.robot) for each in told if robot in each.out]
    if against:
        return f"not believed by {', '.join(against)}"
    return "believed" if any(each.signs for each in told) else ""


def _sample(report: Report, state: str | None, content: MapContent) -> RobotSample:
    told = report.condition
    sample = sample_of(told, content, robot_name(told.robot))
    return replace(sample, state=state or told.state, alive=state is None)
