"""The robot's own rclpy: the one module that uses it. It is imported when a body is made, not before."""

from __future__ import annotations

import importlib
import time
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from math import cos, sin
from threading import Thread
from typing import Any
from uuid import uuid4

import numpy as np

from vedette.errors import InputError
from vedette.ros2.door import Answer, Deviation, GoalStatus, Grid, NavigatorGone, Patch, Told
from vedette.ros2.goals import Place
from vedette.ros2.messages import joints_of, seconds, sweep_of
from vedette.ros2.offered import Offered, Writer
from vedette.ros2.settings import Ros2Settings
from vedette.ros2.transforms import deviations, matrix

HOW = "start it where ROS 2 is set up: source /opt/ros/<distro>/setup.bash"
MOST_GOALS = 64  # that are remembered
GOODBYE = 1.0  # what was ordered last has so long to get out [s]
TOPICS = ("scan", "map", "pose", "navigate_to_pose")  # settings that name some
NAVIGATOR = "bt_navigator"  # Nav2's node that offers the action
DEPTH = 5  # messages of a sensor that are kept for us


def ros(name: str) -> Any:
    """Return a module of the robot's ROS.

    Raises:
        InputError: this Python does not have it; the line says how to get it.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        missing = error.name if isinstance(error, ModuleNotFoundError) else f"{name}: {error}"
        raise InputError(f"body.ros2: this Python has no {missing}; {HOW}") from None


@dataclass(eq=False)
class RosDoor:
    """A node of the robot's ROS; ``vedette.ros2.door.Door``. What it is told comes in a thread of its own."""

    settings: Ros2Settings
    name: str
    _told: deque[Told] = field(default_factory=deque)
    _goals: dict[bytes, int] = field(default_factory=dict)  # our numbers by the names that goals travel with
    _was_there: bool = False  # the navigator
    time: float | None = None  # that /clock shows [s]

    def __post_init__(self) -> None:
        rclpy, signals = ros("rclpy"), ros("rclpy.signals")
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, signal_handler_options=signals.SignalHandlerOptions.NO)
        self.node = rclpy.create_node(
            self.name,
            namespace=self.settings.namespace,
            context=self._context,
            start_parameter_services=False,
        )
        self._subscribe()
        self._find_navigator()
        self._executor = ros("rclpy.executors").SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._thread = Thread(target=self._spin, name="ros2", daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        try:
            self._executor.spin()
        except ros("rclpy.executors").ExternalShutdownException:
            pass

    # -- what the robot tells -----------------------------------------------------------------------------

    def take(self) -> Sequence[Told]:
        """Return what has been told since the last call."""
        there = self._there
        if self._was_there and not there:
            self._told.append(NavigatorGone())
        self._was_there = there
        return [self._told.popleft() for _ in range(len(self._told))]

    def _subscribe(self) -> None:
        qos = ros("rclpy.qos")
        tf = ros("tf2_msgs.msg").TFMessage
        sensor = qos.QoSProfile(depth=DEPTH, reliability=qos.ReliabilityPolicy.BEST_EFFORT)
        moving = qos.QoSProfile(depth=100, reliability=qos.ReliabilityPolicy.BEST_EFFORT)
        latched = qos.QoSProfile(depth=100, durability=qos.DurabilityPolicy.TRANSIENT_LOCAL)
        node, settings = self.node, self.settings
        node.create_subscription(ros("sensor_msgs.msg").LaserScan, settings.scan, self._hear_scan, sensor)
        pose = ros("geometry_msgs.msg").PoseWithCovarianceStamped
        node.create_subscription(pose, settings.pose, self._hear_pose, sensor)
        for topic in dict.fromkeys((node.resolve_topic_name("tf"), "/tf")):
            own = topic != "/tf" or not self._prefix
            node.create_subscription(tf, topic, lambda m, own=own: self._hear_tf(m, own, False), moving)
            static = f"{topic}_static"
            node.create_subscription(tf, static, lambda m, own=own: self._hear_tf(m, own, True), latched)

        if settings.evidence == "map":
            one = qos.QoSProfile(depth=1, durability=qos.DurabilityPolicy.TRANSIENT_LOCAL)
            node.create_subscription(ros("nav_msgs.msg").OccupancyGrid, settings.map, self._hear_grid, one)
            with suppress(ImportError):  # not all robots have updates of maps
                update = importlib.import_module("map_msgs.msg").OccupancyGridUpdate
                node.create_subscription(update, f"{settings.map}_updates", self._hear_patch, sensor)
        if settings.use_sim_time:
            newest = qos.QoSProfile(depth=1, reliability=qos.ReliabilityPolicy.BEST_EFFORT)
            node.create_subscription(ros("rosgraph_msgs.msg").Clock, "/clock", self._hear_clock, newest)

    def _hear_grid(self, message: Any) -> None:
        info, origin = message.info, message.info.origin
        p, q = origin.position, origin.orientation
        quaternion = (q.x, q.y, q.z, q.w) if any((q.x, q.y, q.z, q.w)) else (0.0, 0.0, 0.0, 1.0)
        cells = np.asarray(message.data, np.int8)
        if info.resolution > 0.0 and len(cells) == info.height * info.width:
            self._told.append(
                Grid(
                    message.header.frame_id,
                    info.resolution,
                    matrix((p.x, p.y, p.z), quaternion),
                    cells.reshape(info.height, info.width),
                )
            )

    def _hear_patch(self, message: Any) -> None:
        cells = np.asarray(message.data, np.int8)
        if len(cells) == message.height * message.width:
            self._told.append(Patch(message.y, message.x, cells.reshape(message.height, message.width)))

    def _hear_clock(self, message: Any) -> None:
        self.time = seconds(message.clock)

    @property
    def _prefix(self) -> str:
        """What frames on the common topic begin with that are this robot's."""
        namespace = self.settings.namespace.strip("/")
        return f"{namespace}/" if namespace else ""

    def _hear_tf(self, message: Any, own: bool, fixed: bool) -> None:
        """Take in transforms; of a topic that all robots share only those with the namespace before them."""
        for joint in joints_of(message, fixed=fixed):
            if own or joint.child.lstrip("/").startswith(self._prefix):
                self._told.append(joint)

    def _hear_scan(self, message: Any) -> None:
        self._told.append(sweep_of(message))

    def _hear_pose(self, message: Any) -> None:
        self._told.append(Deviation(*deviations(message.pose.covariance)))

    # -- what there is to be told -------------------------------------------------------------------------

    def offered(self) -> Offered:
        """Return what the robot's ROS offers by now."""
        node, settings = self.node, self.settings
        resolved = {name: node.resolve_topic_name(getattr(settings, name)) for name in TOPICS}
        resolved |= {name: node.resolve_topic_name(name) for name in ("tf", "tf_static")}
        sure, kept = ros("rclpy.qos").ReliabilityPolicy, ros("rclpy.qos").DurabilityPolicy
        return Offered(
            {name: tuple(types) for name, types in node.get_topic_names_and_types()},
            resolved,
            {
                topic: tuple(
                    Writer(
                        info.qos_profile.reliability == sure.RELIABLE,
                        info.qos_profile.durability == kept.TRANSIENT_LOCAL,
                    )
                    for info in node.get_publishers_info_by_topic(topic)
                )
                for topic in (*resolved.values(), "/tf", "/tf_static", "/clock")
            },
            self._there,
            self._state_of(NAVIGATOR),
        )

    def _state_of(self, node: str) -> str | None:
        """Ask a node for the state of its life cycle; None: it does not answer."""
        get_state = ros("lifecycle_msgs.srv").GetState
        client = self.node.create_client(get_state, f"{node}/get_state")
        try:
            if not client.wait_for_service(timeout_sec=GOODBYE):
                return None
            asked, until = client.call_async(get_state.Request()), time.monotonic() + GOODBYE
            while not asked.done() and time.monotonic() < until:
                time.sleep(0.01)
            return str(asked.result().current_state.label) if asked.done() else None
        finally:
            self.node.destroy_client(client)

    # -- the navigator ------------------------------------------------------------------------------------

    def _find_navigator(self) -> None:
        """Make clients of the action's services, which tell more of a goal than its client does."""
        self._action = ros("nav2_msgs.action").NavigateToPose
        self._cancel_goal = ros("action_msgs.srv").CancelGoal
        status, qos = ros("action_msgs.msg").GoalStatusArray, ros("rclpy.qos")
        action = self.node.resolve_topic_name(self.settings.navigate_to_pose)
        self._asker = self.node.create_client(
            self._action.Impl.SendGoalService, f"{action}/_action/send_goal"
        )
        self._canceller = self.node.create_client(self._cancel_goal, f"{action}/_action/cancel_goal")
        self.node.create_subscription(
            status, f"{action}/_action/status", self._hear_status, qos.qos_profile_action_status_default
        )

    @property
    def _there(self) -> bool:
        return bool(self._asker.service_is_ready() and self._canceller.service_is_ready())

    def ask(self, goal: int, place: Place) -> None:
        """Send a goal; where there is no navigator, it is as good as rejected."""
        if not self._there:
            self._told.append(Answer(goal, accepted=False))
            return
        x, y, heading = place
        request, name = self._action.Impl.SendGoalService.Request(), uuid4().bytes
        self._goals[name] = goal
        if len(self._goals) > MOST_GOALS:
            del self._goals[next(iter(self._goals))]
        request.goal_id.uuid = np.frombuffer(name, np.uint8)
        pose = request.goal.pose  # its stamp stays 0: the place is where it is now
        pose.header.frame_id = self.settings.map_frame
        pose.pose.position.x, pose.pose.position.y = x, y
        pose.pose.orientation.z, pose.pose.orientation.w = sin(heading / 2), cos(heading / 2)
        answer = self._asker.call_async(request)
        answer.add_done_callback(lambda done: self._told.append(Answer(goal, bool(done.result().accepted))))

    def cancel(self, goal: int) -> None:
        """Cancel a goal."""
        for name in [name for name, number in self._goals.items() if number == goal]:
            request = self._cancel_goal.Request()
            request.goal_info.goal_id.uuid = np.frombuffer(name, np.uint8)
            self._cancelled = self._canceller.call_async(request)

    def _hear_status(self, message: Any) -> None:
        for told in message.status_list:
            goal = self._goals.get(bytes(told.goal_info.goal_id.uuid))
            if goal is not None:
                self._told.append(GoalStatus(goal, int(told.status)))

    def close(self) -> None:
        """Leave; what was ordered last is given the time to get out."""
        time.sleep(GOODBYE if self._goals else 0.0)
        self._executor.shutdown()
        self._thread.join(GOODBYE)
        self.node.destroy_node()
        self._context.try_shutdown()
