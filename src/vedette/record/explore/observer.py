"""What is seen of an exploring team from outside: its robots from time to time, measured against the truth.

Where the views come from makes no difference: from robots simulated in this process, or from what robots on a
network report.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vedette.agent.orders import NoGo
from vedette.domains.mapping.belief import LN2, planning_factor
from vedette.domains.mapping.impact import cells_missed, moved
from vedette.domains.mapping.stops import unknown_near
from vedette.maps import UNKNOWN
from vedette.maps.area import Area
from vedette.maps.bounds import Extent
from vedette.maps.laid import under
from vedette.maps.lattice import Lattice
from vedette.maps.world import World
from vedette.missions.explore.expected import Forecaster
from vedette.missions.explore.options import ExploreOptions
from vedette.outcome import Outcome
from vedette.record.explore.frames import FramesFound
from vedette.record.explore.log import ExploreLog, ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.score import CoverageProgress, Reference, coverage, map_errors, overlap
from vedette.record.explore.summary import ExploreSummary, LeftOut
from vedette.record.explore.views import RobotView, by_map, frontiers_left, union_map
from vedette.record.figures import TeamFigures
from vedette.record.links import Link, parts
from vedette.record.log import Sink
from vedette.record.summary import Setting, Timing
from vedette.team import PlatformSpec

LARGE = 1_000_000  # cells from which a map is looked at less often
LOOK_PERIOD, LOOK_PERIOD_IF_LARGE = 0.5, 2.0  # [s]


@dataclass(frozen=True, eq=False)
class ExploreReport:
    """What a mission leaves: its figures, its log, and the map that a living robot holds."""

    summary: ExploreSummary
    timing: Timing
    log: ExploreLog
    classes: NDArray[np.uint8]  # (R, C) team map


class ExploreObserver:
    """Measures a mission from views of its robots: it knows the truth, the agents do not."""

    def __init__(
        self,
        world: World,
        specs: Sequence[PlatformSpec],
        starts: NDArray[np.float64],
        options: ExploreOptions,
        setting: Setting,
        sinks: Sequence[Sink[ExploreSnapshot]] = (),
        lattice: Lattice | None = None,
        *,
        curves_only: bool = False,
    ) -> None:
        """Prepare to observe a team that starts at ``starts``, (n, 3) x, y, heading [m, m, rad].

        The ``sinks`` follow the mission while it goes on. ``lattice``: the team's; None: the world's map.
        ``curves_only``: figures and curves are all that is wanted, so no snapshot has an impact, or is kept.
        """
        lattice = lattice or Lattice(world.frame)
        ground = lattice.frame
        self._open = lattice.cells is None  # nobody knows how much ground there is
        self._planning = ground.coarse(planning_factor(ground.resolution))  # of the robots' impacts
        self._world, self._options, self._setting = world, options, setting
        self._reference = Reference(world.within(lattice.area), specs, starts)
        self._progress = CoverageProgress()
        self.period = LOOK_PERIOD if world.frame.size <= LARGE else LOOK_PERIOD_IF_LARGE  # of looking [s]
        scene = ExploreScene.of(world, [spec.name for spec in specs])
        self.log = ExploreLog(scene, sinks, curves_only=curves_only)
        self._forecaster = Forecaster()
        self.frames: FramesFound | None = None  # as of the next look
        self.apart_s = 0.0  # time during which the living robots were not all on one tree
        self._apart = False  # since the last look
        self._views: tuple[RobotView, ...] = ()  # of the last look
        self._now = 0.0  # when that was [s]
        self._looks = 0
        self._logged = -1.0  # time of the last snapshot [s]

    def look(self, now: float, views: Sequence[RobotView], links: Sequence[Link] | None) -> None:
        """Measure the mission at a time [s], not before the last look's, and log every second look.

        ``views`` of all robots in the order of the team; ``links`` None: the network is ideal.
        """
        self._measure(now, views, links, log=self._looks % 2 == 0)
        self._looks += 1

    def finish(self, now: float, views: Sequence[RobotView], links: Sequence[Link] | None) -> None:
        """Measure and log how the mission ended; as ``look``."""
        self._measure(now, views, links, log=True)

    def _measure(
        self, now: float, views: Sequence[RobotView], links: Sequence[Link] | None, log: bool
    ) -> None:
        self._heed([view.sample for view in views])
        classes = union_map(views, self._world.frame)
        known = under((view.frame for view in views), self._world.frame)
        share = None if self._open else coverage(self._reference, classes, known)
        if self._apart:
            self.apart_s += now - self._now
        self._now = now
        if share is not None:
            self._progress.add(now, share)
        self._views = tuple(views)
        self._apart = len(parts([view.sample.alive for view in views], links)) > 1
        if log and now > self._logged:
            snapshot = self._snapshot(now, classes, known, share, links)
            self.log.add(replace(snapshot, expected=self._forecaster.add(snapshot.progress)))
            self._logged = now

    def _heed(self, robots: Sequence[RobotSample]) -> None:
        """Count on nothing any more that some living robot has heard that nobody may go to, or is cut off."""
        orders = (order for robot in robots if robot.alive for order in robot.orders)
        no_go = tuple(dict.fromkeys(Area(order.corners) for order in orders if isinstance(order, NoGo)))
        if no_go != self._reference.no_go and any(robot.alive for robot in robots):
            places = {i: (robot.x, robot.y) for i, robot in enumerate(robots) if robot.alive}
            self._reference = replace(self._reference, no_go=no_go, places=places)

    def _snapshot(
        self,
        now: float,
        classes: NDArray[np.uint8],
        known: Extent,
        share: float | None,
        links: Sequence[Link] | None,
    ) -> ExploreSnapshot:
        unknown = classes.size - int(np.count_nonzero(classes[known] != UNKNOWN))
        return ExploreSnapshot(
            t=now,
            robots=tuple(_counted(view) for view in self._views),
            coverage=share,
            known_fraction=None if self._open else 1.0 - unknown / classes.size,
            entropy=None if self._open else unknown * LN2,
            known_m2=self._known_m2(classes[known]),
            classes=classes,
            impact=None if self.log.curves_only else self._team_impact(),
            links=None if links is None else tuple(links),
            frontiers=frontiers_left(self._views),
            left_out=tuple(spot for view in self._views for spot in view.left_out if view.sample.alive),
            frames=self.frames,
        )

    def _known_m2(self, classes: NDArray[np.uint8]) -> float:
        return float(np.count_nonzero(classes != UNKNOWN)) * self._world.frame.resolution**2

    def _team_impact(self) -> NDArray[np.float32]:
        """Probability that the strategies decided on last will observe each planning cell."""
        frame = self.log.scene.planning
        miss = np.ones(frame.size, np.float32)
        for view in self._views:
            if view.sample.alive and view.impact is not None and len(view.impact.keys):
                cells, missed = cells_missed(moved(view.impact, self._planning, frame))
                miss[cells] *= missed
        return (1.0 - miss).reshape(frame.shape)

    def delivered_map(self) -> NDArray[np.uint8]:
        """Return the map of the living robot that knows most; if none lives, what all held."""
        living = [view for view in self._views if view.sample.alive]
        if not living:
            return union_map(self._views, self._world.frame)
        return max(living, key=lambda view: np.count_nonzero(view.classes)).classes_on(self._world.frame)

    def report(self, outcome: Outcome, timing: Timing) -> ExploreReport:
        """Return what the mission leaves; not before the first look."""
        return ExploreReport(self.summary(outcome), timing, self.log, self.delivered_map())

    def summary(self, outcome: Outcome) -> ExploreSummary:
        """Return the figures of the mission, in simulated time; not before the first look."""
        progress, views = self._progress, self._views
        team, samples = zip(*((view.figures, view.sample) for view in views), strict=True)
        time, known_m2 = self._now, self._known_m2(union_map(views, self._world.frame))
        wrong, known = map_errors(self._world, self.delivered_map())
        return ExploreSummary(
            completed=outcome.completed,
            outcome=outcome,
            robots=len(team),
            planner=self._options.planner,
            scheme=self._options.negotiates_by,
            fusion=self._options.fusion,
            world=self._world.name,
            time_s=time,
            t50_s=progress.t_at(0.50),
            t90_s=progress.t_at(0.90),
            t95_s=progress.t_at(0.95),
            t99_s=progress.t_at(0.99),
            auc_s=None if self._open else progress.auc(time),
            coverage=None if self._open else progress.coverages[-1],
            known_m2=known_m2,
            rate_m2_s=known_m2 / time if time > 0.0 else 0.0,
            frontiers=frontiers_left(views),
            beyond=sum(view.beyond for view in views),
            no_go_m2=self._reference.forbidden_m2,
            cut_off_m2=self._reference.cut_off_m2,
            turned_back=tuple(view.sample.name for view in views if view.turned_back),
            map_errors=wrong,
            map_error_share=wrong / known if known else 0.0,
            pose_error_m=self._pose_errors(),
            overlap=overlap(view.seen_on(self._world.frame) for view in views),
            collisions=sum(each.collisions for each in team),
            min_clearance_m=min(each.min_clearance_m for each in team),
            apart_s=self.apart_s,
            maps=by_map(views),
            expected=None if outcome.completed else self._forecaster.expected,
            left_out=self._left_out(),
            frames=self.frames,
            **vars(self._setting),
            **vars(TeamFigures.of(self.log.scene.vehicles, team, samples)),
        )

    def _pose_errors(self) -> dict[str, float] | None:
        """Return how far each robot took itself to be from where it was, at most [m]."""
        errors = {view.sample.name: view.figures.pose_error_m for view in self._views}
        known = {name: error for name, error in errors.items() if error is not None}
        return known if len(known) == len(errors) else None

    def _left_out(self) -> tuple[LeftOut, ...]:
        """Return what robots left and nobody knows by now; out of reach is what is so to all who live."""
        frame = self._world.frame
        classes = union_map(self._views, frame)
        living = [view for view in self._views if view.sample.alive]
        beyond = [{_place(spot) for spot in view.left_out if spot.why == "out_of_reach"} for view in living]
        nobody = set.intersection(*beyond) if beyond else set()
        told = [spot for view in self._views for spot in view.left_out if spot.why != "out_of_reach"]
        told += [spot for spot in living[0].left_out if _place(spot) in nobody] if living else []
        spots = [replace(spot, unknown_cells=unknown_near(classes, frame, spot.x, spot.y)) for spot in told]
        return tuple(spot for spot in spots if spot.unknown_cells)


def _counted(view: RobotView) -> RobotSample:
    """Return a robot with what it has counted."""
    counts = view.figures
    return replace(
        view.sample, driven=counts.travelled_m, rounds=counts.rounds.rounds, sent=counts.bytes.total
    )


def _place(spot: LeftOut) -> tuple[float, float]:
    """Return where it is [m], to the centimetre: robots reckon from corners of their own."""
    return round(spot.x, 2), round(spot.y, 2)
