"""An exploring team's reports as one picture, without knowing the world that it explores."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import planning_factor
from vedette.domains.mapping.impact import MapImpactCodec, cells_missed, moved
from vedette.domains.mapping.leftovers import Leftover
from vedette.maps import UNKNOWN, GridFrame
from vedette.maps.laid import part_laid
from vedette.net.explore.content import MOST_CELLS, MapContent, classes_of, frame_of, read_content, sample_of
from vedette.net.gather import links_among, vehicle_name
from vedette.net.names import robot_name
from vedette.net.report import Condition, Report
from vedette.net.results import lasted
from vedette.record.explore.log import ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.mcap import ExploreMcapWriter
from vedette.record.explore.views import left_out
from vedette.record.log import Sink
from vedette.record.mcap import Medium
from vedette.window.picture import Beside, Picture, picture

NOWHERE = GridFrame(1.0, 1, 1)


@dataclass(frozen=True)
class ExploreOnlooker:
    """``vedette.net.feed.Onlooker``."""

    team: str  # its name
    names: Sequence[str] = ()  # of its robots, as far as the operator gave them any

    def numbers(self, reports: Mapping[int, Report]) -> Sequence[int]:
        """Return those that have been heard."""
        return [robot + 1 for robot in reports]

    def name(self, robot: int) -> str:
        """Return what a robot is called."""
        return vehicle_name(self.names, robot)

    def see(
        self, reports: Mapping[int, Report], states: Mapping[int, str]
    ) -> tuple[ExploreScene, ExploreSnapshot]:
        """Return the map that they hold, where they are and where they go."""
        return picture_of(self.team, reports, states, self.name)

    def draw(self, scene: ExploreScene, snapshot: ExploreSnapshot, beside: Beside) -> Picture:
        """Return it as the page shows it."""
        return picture(scene, snapshot, beside)

    def recorder(self, medium: Medium, scene: ExploreScene) -> Sink[ExploreSnapshot]:
        """Return what tells it in messages."""
        return ExploreMcapWriter(medium, scene)


def picture_of(
    team: str,
    reports: Mapping[int, Report],
    states: Mapping[int, str],
    name: Callable[[int], str] = robot_name,
) -> tuple[ExploreScene, ExploreSnapshot]:
    """Return what robots report, together: the map that they hold, where they are, what they believe.

    Args:
        team: its name.
        reports: by robot, its latest.
        states: words that take the place of robots' own.
        name: of a robot, by its index.

    Raises:
        ValueError: a report is malformed.
    """
    contents = [read_content(report.content) for report in reports.values()]
    frame, classes = _together(contents)
    planning = frame.coarse(planning_factor(frame.resolution))
    names = tuple(map(name, reports))
    scene = ExploreScene(name=team, vehicles=names, frame=frame, planning=planning)
    told = [report.condition for report in reports.values()]
    snapshot = ExploreSnapshot(
        t=max((lasted(each) for each in told), default=0.0),
        robots=tuple(
            replace(_sample(report, states.get(robot), content, name(robot)), trust=_trust(robot, told, name))
            for (robot, report), content in zip(reports.items(), contents, strict=True)
        ),
        coverage=None,
        known_fraction=max((each.known for each in told if each.known is not None), default=None),
        entropy=None,
        classes=classes,
        impact=_impact(contents, planning),
        links=links_among(reports, [robot + 1 for robot in reports]),
        left_out=tuple(
            spot
            for name, each in zip(names, contents, strict=True)
            for spot in left_out([Leftover(*leaves) for leaves in each.left_out], name)
        ),
        known_m2=float(np.count_nonzero(classes != UNKNOWN)) * frame.resolution**2,
        expected=max(told, key=lambda each: each.known_m2 or 0.0).expected if told else None,
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


def _trust(robot: int, told: Sequence[Condition], name: Callable[[int], str]) -> str:
    """Say who believes a robot; nothing where nobody signs."""
    against = [name(each.robot) for each in told if robot in each.out]
    if against:
        return f"not believed by {', '.join(against)}"
    return "believed" if any(each.signs for each in told) else ""


def _sample(report: Report, state: str | None, content: MapContent, name: str) -> RobotSample:
    sample = sample_of(report.condition, content, name)
    return replace(sample, state=state or report.condition.state, alive=state is None)
