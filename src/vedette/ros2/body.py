"""A robot that runs ROS 2, as its agent knows it; ``vedette.agent.body.Body``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import atan2, hypot

import numpy as np

from vedette.agent.body import BodyFigures
from vedette.agent.effects import Drive, Motion, Route
from vedette.agent.events import Event, Pose, Scan, Sensed
from vedette.ros2.door import (
    Answer,
    Deviation,
    Door,
    GoalStatus,
    Grid,
    Joint,
    NavigatorGone,
    Patch,
    Reason,
    Told,
    Word,
)
from vedette.ros2.goals import Ask, Errands, Place
from vedette.ros2.grids import Grids
from vedette.ros2.scans import LaserSweep, beams
from vedette.ros2.settings import Ros2Settings
from vedette.ros2.sweeps import PlacedSweep, Sweeps
from vedette.ros2.transforms import Gap, Matrix, Transforms, place, planar
from vedette.team import PlatformSpec

SILENT = 5.0  # without a scan that can be placed for so long somebody should know [s]
NO_WAY = 0.01  # less between two poses is not counted as way [m]


@dataclass(eq=False)
class Ros2Body:
    """What a robot tells over ROS 2 as events, and an agent's routes as goals of its navigator.

    Stamps are compared with stamps alone, never with the mission's time or the host's clock.
    """

    hull: PlatformSpec
    settings: Ros2Settings
    door: Door
    transforms: Transforms = field(default_factory=Transforms)
    goals: Errands = field(default_factory=Errands)
    grids: Grids = field(default_factory=Grids)
    at_work: str | None = None  # why it does not do what its agent wants; None: it does
    _wish: Drive | None = None  # what its agent wants
    _began: Place | None = None  # where it was first
    _pose: Pose | None = None  # team frame
    _counted: Pose | None = None  # up to where its way is counted
    _travelled: float = 0.0
    _now: float = 0.0  # as of the last look [s]
    _scanned: float = 0.0  # when a scan was placed last [s]
    _deviation: Deviation = field(default_factory=Deviation)
    _sweeps: Sweeps = field(init=False)

    def __post_init__(self) -> None:
        self._sweeps = Sweeps(self.transforms)

    @property
    def latest(self) -> LaserSweep | None:
        """The latest scan, wherever it was taken."""
        return self._sweeps.latest

    @property
    def left_out(self) -> int:
        """Scans whose transforms never came."""
        return self._sweeps.left_out

    @property
    def time(self) -> Callable[[], float | None] | None:
        """The clock that the robot goes by, if that is a simulation's; None: this host's."""
        return (lambda: self.door.time) if self.settings.use_sim_time else None

    @property
    def pose(self) -> Place:
        """Where it takes itself to be."""
        at = self._pose
        return (0.0, 0.0, 0.0) if at is None else (at.x, at.y, at.heading)

    @property
    def stamp(self) -> float | None:
        """The latest time at which the robot has told where it is, by its own clock [s]."""
        return self.transforms.newest(self.frame(self.settings.base_frame))

    @property
    def worry(self) -> str:
        """What somebody beside the robot should see to, in a line; nothing: ''."""
        if self.at_work is not None:
            return self.at_work
        silent = self._now - self._scanned
        if silent < SILENT:
            return self.goals.said
        if self._sweeps.wait:
            return f"no transform for the scans of the last {silent:.0f} s: is localisation running?"
        return f"nothing on {self.settings.scan} for {silent:.0f} s: is the lidar on?"

    @property
    def figures(self) -> BodyFigures:
        """Its way; its own software sees to collisions."""
        return BodyFigures(self._travelled)

    def sense(self, now: float) -> list[Event]:
        """Return what the robot has told since the last call; nothing until it has told where it is."""
        self.hear(now)
        pose = self._localised()
        self.goals.tick(None if pose is None else (pose.x, pose.y, pose.heading), now)
        self._give_orders()
        if pose is None:
            return []
        scans = [event for sweep in self._due() for event in sweep]
        self._now, self._scanned = now, now if scans else self._scanned
        self._note(pose)
        outcomes, self.goals.outcomes = self.goals.outcomes, []
        return [*scans, pose, *self._own_map(now), *(outcomes if self.at_work is None else ())]

    def carry_out(self, motion: Motion, now: float) -> None:
        """Send the navigator to the end of a route, or let the robot stand."""
        assert isinstance(motion, Drive), "robots on the ground do not fly"
        self._wish = motion
        if self.at_work is None:
            self._follow(motion.route, now)

    def _follow(self, route: Route | None, now: float) -> None:
        if route is None:
            self.goals.want(None, now)
        else:
            self.goals.want(self._end(route), now, facing=route.facing is not None)
        self._give_orders()

    def _obey(self, word: Word, now: float) -> None:
        """Do what somebody beside the robot says, whatever its agent wants."""
        if word is Word.RESUME:
            self.at_work = None
            self._follow(None if self._wish is None else self._wish.route, now)
        elif word is Word.RECALL:
            self.at_work = "recalled: resume lets it work again"
            self.goals.want(self._began, now, facing=False)
        else:
            self.at_work = "paused: resume lets it work again"
            self.goals.want(None, now)

    def stop(self, now: float) -> None:
        """Stand, and leave the robot to others."""
        self.goals.want(None, now)
        self._give_orders()
        self.door.close()

    # -- what the robot tells ---------------------------------------------------------------------------

    def hear(self, now: float) -> None:
        """Take in what the robot has told."""
        for told in self.door.take():
            self.take_in(told, now)

    def take_in(self, told: Told, now: float) -> None:
        """Take in one thing."""
        match told:
            case Joint(parent, child, stamp, T, fixed):
                self.transforms.add(parent, child, stamp, T, fixed=fixed)
            case LaserSweep():
                self._sweeps.receive(told)
            case Grid() | Patch():
                self.grids.take(told)
            case Deviation():
                self._deviation = told
            case Answer(goal, accepted):
                (self.goals.accepted if accepted else self.goals.rejected)(goal, now)
            case GoalStatus(goal, status):
                self.goals.status(goal, status, now)
            case Reason(goal, said):
                self.goals.explained(goal, said)
            case NavigatorGone():
                self.goals.gone(now)
            case Word():
                self._obey(told, now)

    def frame(self, name: str) -> str:
        """Return a frame as TF knows it: bare, or with the robot's namespace before it."""
        prefixed = f"{self.settings.namespace.strip('/')}/{name}"
        return prefixed if prefixed in self.transforms.frames else name

    def _localised(self) -> Pose | None:
        """Return where the robot is by the newest that each joint has told."""
        told = self.transforms.lookup(
            self.frame(self.settings.map_frame), self.frame(self.settings.base_frame)
        )
        if isinstance(told, Gap):
            return self._pose and replace(self._pose, at_work=self.at_work is None)
        return self._pose_at(told, self.goals.slowed)

    def _pose_at(self, T_map_base: Matrix, slowed: float = 0.0) -> Pose:
        x, y, heading = place(self.settings.T_team_map @ T_map_base)
        deviation, at_work = self._deviation, self.at_work is None
        return Pose(x, y, heading, slowed, deviation.place, deviation.heading, at_work)

    def _note(self, pose: Pose) -> None:
        """Remember where the robot is, and count its way."""
        self._pose, last = pose, self._counted or pose
        self._began = self._began or (pose.x, pose.y, pose.heading)
        way = hypot(pose.x - last.x, pose.y - last.y)
        if way >= NO_WAY or self._counted is None:
            self._counted, self._travelled = pose, self._travelled + way

    @property
    def _frames(self) -> tuple[str, str]:
        """Of the robot's map and of its base, as TF knows them."""
        return self.frame(self.settings.map_frame), self.frame(self.settings.base_frame)

    @property
    def places_scans(self) -> bool:
        """Tell whether TF covers any of the scans that wait."""
        return self._sweeps.can_be_placed(*self._frames)

    def _due(self) -> list[tuple[Pose, Scan]]:
        """Return the scans whose transforms have come by now, each with where the robot was then."""
        return [self._scan(placed) for placed in self._sweeps.due(*self._frames)]

    def _scan(self, placed: PlacedSweep) -> tuple[Pose, Scan]:
        """Return a scan in the team's frame, as taken where the robot was in its middle."""
        knots = [self.settings.T_team_map @ T for T in placed.knots]
        seen = beams(placed.sweep, knots, self.settings.no_return)
        pose = self._pose_at(placed.T_map_base)
        mapped = self.settings.evidence == "map"
        return pose, Scan(seen.angles, seen.ranges, (seen.x - pose.x, seen.y - pose.y), placed.age, mapped)

    def _own_map(self, now: float) -> list[Event]:
        """Return the robot's own map, if that is its evidence and there is news of it."""
        grid = self.grids.latest
        if self.settings.evidence == "scan" or grid is None:
            return []
        T_map_grid = self.transforms.lookup(self.frame(self.settings.map_frame), grid.frame)
        if isinstance(T_map_grid, Gap):
            return []
        own_map = self.grids.due(self.settings.T_team_map @ T_map_grid, now)
        return [] if own_map is None else [Sensed(own_map, now)]

    # -- where it is to go ------------------------------------------------------------------------------

    def _end(self, route: Route) -> Place:
        """Return the end of a route, facing as told or else as the route ends; team frame."""
        x, y = route.path[-1].tolist()
        if route.facing is not None:
            return x, y, route.facing
        apart = np.flatnonzero(np.hypot(*(route.path - route.path[-1]).T) > NO_WAY)
        if not len(apart):
            return x, y, self.pose[2]
        back = route.path[-1] - route.path[apart[-1]]
        return x, y, atan2(back[1], back[0])

    def _give_orders(self) -> None:
        orders, self.goals.orders = self.goals.orders, []
        for order in orders:
            if isinstance(order, Ask):
                at = place(self.settings.T_map_team @ planar(*order.place))
                self.door.ask(order.goal, at, self.frame(self.settings.map_frame))
            else:
                self.door.cancel(order.goal)
