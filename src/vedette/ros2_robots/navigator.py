"""A navigator with the manners of Nav2's: one goal runs, a newer one ends it; inactive, it rejects all."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import atan2, hypot, inf
from typing import Any

import numpy as np
from nav2_msgs.action import NavigateToPose
from numpy.typing import NDArray
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.task import Future

from vedette.ros2_robots.planner import WayFinder
from vedette.ros2_robots.steering import steer, turn, within

TOLERANCE_XY, TOLERANCE_YAW = 0.1, 0.1  # of a goal [m, rad]
REPLAN = 2.0  # [s]
PATIENCE = 10.0  # without a way, or without movement; then the goal is given up [s]
NEAR = 3.0  # within which other robots are seen [m]
UNKNOWN = 9000

Pose = tuple[float, float, float]


@dataclass
class _Run:
    """The goal that runs."""

    handle: Any
    goal: Pose
    done: Future
    path: NDArray[np.float64] | None = None
    planned: float = -inf
    moved: tuple[Pose, float] | None = None


@dataclass(eq=False)
class Navigator:
    """Drives one robot; times are the simulation's [s], poses the robot's own map's."""

    node: Node
    planner: WayFinder
    radius: float
    speed: float
    turn_rate: float
    to_world: Callable[[Pose], Pose]  # from the robot's map
    active_from: float = 0.0
    fails: list[str] = field(default_factory=list)  # what befalls the next goals: abort, reject, ignore
    now: float = 0.0
    _run: _Run | None = None
    _aborts: bool = False  # the next that it accepts
    ended: dict[str, int] = field(default_factory=dict)  # goals by how they ended

    def __post_init__(self) -> None:
        self._server = ActionServer(
            self.node,
            NavigateToPose,
            "navigate_to_pose",
            execute_callback=lambda handle: None,  # each goal brings its own
            goal_callback=self._consider,
            handle_accepted_callback=self._accept,
            cancel_callback=lambda handle: CancelResponse.ACCEPT,
            callback_group=ReentrantCallbackGroup(),  # a goal that is never answered holds up nothing else
        )

    async def _consider(self, request: Any) -> GoalResponse:
        if self.now < self.active_from:
            return GoalResponse.REJECT
        fate = self.fails.pop(0) if self.fails else ""
        if fate == "ignore":
            await Future()  # for ever
        self._aborts = fate == "abort"
        return GoalResponse.REJECT if fate == "reject" else GoalResponse.ACCEPT

    def _accept(self, handle: Any) -> None:
        self._finish("aborted")
        asked = handle.request.pose.pose
        yaw = 2.0 * atan2(asked.orientation.z, asked.orientation.w)
        goal = self.to_world((asked.position.x, asked.position.y, yaw))
        self._run = run = _Run(handle, goal, Future())
        handle.execute(partial(self._execute, run=run))
        if self._aborts:
            self._finish("aborted")

    async def _execute(self, handle: Any, run: _Run) -> Any:
        result = NavigateToPose.Result()
        how = await run.done
        self.ended[how] = self.ended.get(how, 0) + 1
        if how == "succeeded":
            handle.succeed()
        elif how == "canceled":
            handle.canceled()
        else:
            if hasattr(result, "error_code"):
                result.error_code = UNKNOWN
            if hasattr(result, "error_msg"):
                result.error_msg = "no way, or another goal"
            handle.abort()
        return result

    def _finish(self, how: str) -> None:
        if self._run is not None:
            self._run.done.set_result(how)
            self._run = None

    def step(self, now: float, here: Pose, others: Sequence[Sequence[float]]) -> tuple[float, float]:
        """Return the speed [m/s] and turn rate [rad/s] from now on; ``others``: x, y, radius [m]."""
        self.now, run = now, self._run
        if run is None:
            return 0.0, 0.0
        if run.handle.is_cancel_requested:
            self._finish("canceled")
            return 0.0, 0.0
        if run.moved is None or _apart(here, run.moved[0]):
            run.moved = here, now
        if now > run.moved[1] + PATIENCE:
            self._finish("aborted")
            return 0.0, 0.0
        if now >= run.planned + REPLAN:
            near = [disc for disc in others if hypot(disc[0] - here[0], disc[1] - here[1]) < NEAR]
            run.path, run.planned = self.planner.path(here, run.goal, near), now
        if run.path is None:
            return 0.0, 0.0
        return self._follow(run, run.path, here, others)

    def _follow(
        self, run: _Run, path: NDArray[np.float64], here: Pose, others: Sequence[Sequence[float]]
    ) -> tuple[float, float]:
        x, y, yaw = here
        if hypot(path[-1, 0] - x, path[-1, 1] - y) < TOLERANCE_XY:
            off = within(run.goal[2] - yaw)
            if abs(off) < TOLERANCE_YAW:
                self._finish("succeeded")
                return 0.0, 0.0
            return 0.0, turn(off, self.turn_rate)
        discs = np.asarray(others, np.float64).reshape(-1, 3)
        return steer(here, path, self.speed, self.turn_rate, lambda at: self.planner.room(at, discs))


def _apart(a: Pose, b: Pose) -> bool:
    return hypot(a[0] - b[0], a[1] - b[1]) > 0.1 or abs(within(a[2] - b[2])) > 0.3
