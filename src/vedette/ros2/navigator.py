"""A client of the robot's NavigateToPose: goals have our numbers, and all that is said of them is heard."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from math import cos, sin
from typing import Any
from uuid import uuid4

import numpy as np

from vedette.ros2.door import Answer, GoalStatus, Reason, Told
from vedette.ros2.goals import ActionStatus, Place
from vedette.ros2.library import ros
from vedette.ros2.reasons import reason_of

MOST_GOALS = 64  # that are remembered


@dataclass(eq=False)
class NavigatorClient:
    """Clients of the action's services and its status topic: they tell more than rclpy's client does."""

    node: Any
    action: str  # its whole name
    told: deque[Told]  # where what is heard goes
    _goals: dict[bytes, int] = field(default_factory=dict)  # our numbers by the names that goals travel with
    _explained: int = 0  # the latest that was asked about

    def __post_init__(self) -> None:
        self._type = ros("nav2_msgs.action").NavigateToPose
        self._cancel_goal = ros("action_msgs.srv").CancelGoal
        status, offered = ros("action_msgs.msg").GoalStatusArray, self._type.Impl
        self._asker = self._client(offered.SendGoalService, "send_goal")
        self._explainer = self._client(offered.GetResultService, "get_result")
        self._canceller = self._client(self._cancel_goal, "cancel_goal")
        qos = ros("rclpy.qos").qos_profile_action_status_default
        self.node.create_subscription(status, f"{self.action}/_action/status", self._hear_status, qos)

    def _client(self, kind: Any, name: str) -> Any:
        return self.node.create_client(kind, f"{self.action}/_action/{name}")

    @property
    def is_there(self) -> bool:
        """Whether there is a navigator."""
        return bool(self._asker.service_is_ready() and self._canceller.service_is_ready())

    @property
    def was_asked(self) -> bool:
        """Whether it was sent anywhere."""
        return bool(self._goals)

    def ask(self, goal: int, place: Place, frame: str) -> None:
        """Send a goal; where there is no navigator, it is as good as rejected."""
        if not self.is_there:
            self.told.append(Answer(goal, accepted=False))
            return
        x, y, heading = place
        request, name = self._type.Impl.SendGoalService.Request(), uuid4().bytes
        self._goals[name] = goal
        if len(self._goals) > MOST_GOALS:
            del self._goals[next(iter(self._goals))]
        request.goal_id.uuid = np.frombuffer(name, np.uint8)
        pose = request.goal.pose  # its stamp stays 0: the place is where it is now
        pose.header.frame_id = frame
        pose.pose.position.x, pose.pose.position.y = x, y
        pose.pose.orientation.z, pose.pose.orientation.w = sin(heading / 2), cos(heading / 2)
        answer = self._asker.call_async(request)
        answer.add_done_callback(lambda done: self.told.append(Answer(goal, bool(done.result().accepted))))

    def cancel(self, goal: int) -> None:
        """Cancel a goal."""
        for name in [name for name, number in self._goals.items() if number == goal]:
            request = self._cancel_goal.Request()
            request.goal_info.goal_id.uuid = np.frombuffer(name, np.uint8)
            self._canceller.call_async(request)

    def _hear_status(self, message: Any) -> None:
        for told in message.status_list:
            goal = self._goals.get(bytes(told.goal_info.goal_id.uuid))
            if goal is not None:
                self.told.append(GoalStatus(goal, int(told.status)))
                if told.status == ActionStatus.ABORTED and goal == max(self._goals.values()):
                    self._ask_why(goal, told.goal_info.goal_id)

    def _ask_why(self, goal: int, name: Any) -> None:
        """Ask once for a goal's result, which may get lost; nobody waits for it."""
        if goal == self._explained:
            return
        self._explained = goal
        request = self._type.Impl.GetResultService.Request()
        request.goal_id = name
        answer = self._explainer.call_async(request)
        answer.add_done_callback(lambda done: self._explain(goal, done.result().result))

    def _explain(self, goal: int, result: Any) -> None:
        said = reason_of(result)
        if said:
            self.told.append(Reason(goal, said))
