"""An exploring team's reports as one picture, without knowing the world that it explores."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from vedette.agent.orders import Order
from vedette.align import FramePose
from vedette.domains.mapping.leftovers import Leftover
from vedette.net.explore.apart import Apart, orders_drawn
from vedette.net.explore.content import MapContent, read_content, sample_of
from vedette.net.explore.reported import ReportedMaps
from vedette.net.gather import links_among, vehicle_name
from vedette.net.names import robot_name
from vedette.net.report import Condition, Report
from vedette.net.results import lasted
from vedette.record.explore.log import ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.mcap import ExploreMcapWriter
from vedette.record.explore.summary import LeftOut
from vedette.record.explore.turned import sample_turned, spots_turned
from vedette.record.explore.views import left_out
from vedette.record.mcap import Medium, Place
from vedette.window.picture import Beside, Picture, picture


@dataclass(frozen=True)
class ExploreOnlooker:
    """``vedette.net.feed.Onlooker``."""

    team: str  # its name
    names: Sequence[str] = ()  # of its robots, as far as the operator gave them any
    maps: ReportedMaps = field(default_factory=ReportedMaps)

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
        return picture_of(self.team, reports, states, self.name, self.maps)

    def as_drawn(self, order: Order, reports: Mapping[int, Report]) -> Order:
        """Return an order with the frame that its place is drawn in, where robots share none."""
        contents = {robot: read_content(report.content) for robot, report in reports.items()}
        return Apart.of(contents).as_drawn(order) if _share_no_frame(contents.values()) else order

    def draw(self, scene: ExploreScene, snapshot: ExploreSnapshot, beside: Beside) -> Picture:
        """Return it as the page shows it."""
        return picture(scene, snapshot, beside)

    def recorder(self, place: Place | Medium, scene: ExploreScene) -> ExploreMcapWriter:
        """Return what tells it in messages."""
        return ExploreMcapWriter(place, scene)


def picture_of(
    team: str,
    reports: Mapping[int, Report],
    states: Mapping[int, str],
    name: Callable[[int], str] = robot_name,
    maps: ReportedMaps | None = None,
) -> tuple[ExploreScene, ExploreSnapshot]:
    """Return what robots report, together: the map that they hold, where they are, what they believe.

    Args:
        team: its name.
        reports: by robot, its latest.
        states: words that take the place of robots' own.
        name: of a robot, by its index.
        maps: what lays their maps together, of earlier pictures; None: there were none.

    Raises:
        ValueError: a report is malformed.
    """
    contents = [read_content(report.content) for report in reports.values()]
    shown, there = contents, dict[int, FramePose]()
    if _share_no_frame(contents):
        apart = Apart.of(dict(zip(reports, contents, strict=True)))
        shown, there = apart.maps, apart.there
    ground = (maps or ReportedMaps()).of(shown)
    names = tuple(map(name, reports))
    scene = ExploreScene(name=team, vehicles=names, frame=ground.frame, planning=ground.planning)
    told = [report.condition for report in reports.values()]
    snapshot = ExploreSnapshot(
        t=max((lasted(each) for each in told), default=0.0),
        robots=tuple(
            replace(
                _sample(report, states.get(robot), content, name(robot), there),
                trust=_trust(robot, told, name),
            )
            for (robot, report), content in zip(reports.items(), contents, strict=True)
        ),
        coverage=None,
        known_fraction=max((each.known for each in told if each.known is not None), default=None),
        entropy=None,
        classes=ground.classes,
        impact=ground.impact,
        links=links_among(reports, [robot + 1 for robot in reports]),
        left_out=tuple(
            spot
            for (robot, by), each in zip(zip(reports, names, strict=True), contents, strict=True)
            for spot in _left_out(each, by, there.get(robot))
        ),
        known_m2=ground.known_m2,
        expected=max(told, key=lambda each: each.known_m2 or 0.0).expected if told else None,
        frontiers=max((each.frontiers for each in told if each.frontiers is not None), default=None),
    )
    return scene, snapshot


def _trust(robot: int, told: Sequence[Condition], name: Callable[[int], str]) -> str:
    """Say who believes a robot; nothing where nobody signs."""
    against = [name(each.robot) for each in told if robot in each.out]
    if against:
        return f"not believed by {', '.join(against)}"
    return "believed" if any(each.signs for each in told) else ""


def _share_no_frame(contents: Iterable[MapContent]) -> bool:
    return any(each.found.graph for each in contents)


def _sample(
    report: Report, state: str | None, content: MapContent, name: str, there: Mapping[int, FramePose]
) -> RobotSample:
    sample = sample_of(report.condition, content, name)
    if report.condition.robot in there:
        sample = sample_turned(sample, there[report.condition.robot])
        sample = replace(sample, orders=orders_drawn(sample.orders, there))
    return replace(sample, state=state or report.condition.state, alive=state is None)


def _left_out(content: MapContent, by: str, there: FramePose | None) -> tuple[LeftOut, ...]:
    spots = left_out([Leftover(*leaves) for leaves in content.left_out], by)
    return spots if there is None else spots_turned(spots, there)
