"""A node of the robot's own ROS: what the robot tells, what it is asked for, what its users are shown."""

from __future__ import annotations

import os
import signal
import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from threading import Thread
from typing import Any

from vedette.errors import InputError
from vedette.ros2.door import NavigatorGone, Notice, Told, Word
from vedette.ros2.goals import Place
from vedette.ros2.library import ros
from vedette.ros2.messages import deviation_of, grid_of, joints_of, patch_of, seconds, sweep_of
from vedette.ros2.navigator import NavigatorClient
from vedette.ros2.offered import Offered, Writer
from vedette.ros2.settings import Ros2Settings

GOODBYE = 1.0  # what was ordered last has so long to get out [s]
TOPICS = ("scan", "map", "pose", "navigate_to_pose")  # settings that name some
NAVIGATOR = "bt_navigator"  # Nav2's node that offers the action
OURS = "vedette"  # before the names of what we offer


def _profile(depth: int, *, reliable: bool = True, kept: bool = False) -> Any:
    """Return a QoS; a reader that is not reliable and keeps nothing hears every writer."""
    qos = ros("rclpy.qos")
    return qos.QoSProfile(
        depth=depth,
        reliability=qos.ReliabilityPolicy.RELIABLE if reliable else qos.ReliabilityPolicy.BEST_EFFORT,
        durability=qos.DurabilityPolicy.TRANSIENT_LOCAL if kept else qos.DurabilityPolicy.VOLATILE,
    )


@dataclass(eq=False)
class RosDoor:
    """A node of the robot's ROS; ``vedette.ros2.door.Door``. What it is told comes in a thread of its own."""

    settings: Ros2Settings
    name: str
    listens_only: bool = False  # offers nothing to others
    time: float | None = None  # that /clock shows [s]
    _told: deque[Told] = field(default_factory=deque)
    _was_there: bool = False  # the navigator
    _publishers: dict[str, Any] = field(default_factory=dict)

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
        action = self.node.resolve_topic_name(self.settings.navigate_to_pose)
        self._navigator = NavigatorClient(self.node, action, self._told)
        if not self.listens_only:
            self._serve()
        self._executor = ros("rclpy.executors").SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._thread = Thread(target=self._spin, name="ros2", daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        with suppress(ros("rclpy.executors").ExternalShutdownException):
            self._executor.spin()

    # -- what the robot tells -----------------------------------------------------------------------------

    def take(self) -> Sequence[Told]:
        """Return what has been told since the last call."""
        there = self.navigator
        if self._was_there and not there:
            self._told.append(NavigatorGone())
        self._was_there = there
        return [self._told.popleft() for _ in range(len(self._told))]

    def _subscribe(self) -> None:
        settings, sensor = self.settings, _profile(5, reliable=False)
        self._hear("sensor_msgs", "LaserScan", settings.scan, sweep_of, sensor)
        self._hear("geometry_msgs", "PoseWithCovarianceStamped", settings.pose, deviation_of, sensor)
        if settings.evidence == "map":
            kept = _profile(1, kept=True)
            self._hear("nav_msgs", "OccupancyGrid", settings.map, grid_of, kept)
            with suppress(InputError):  # not every robot's ROS has updates of maps
                updates = f"{settings.map}_updates"
                self._hear("map_msgs", "OccupancyGridUpdate", updates, patch_of, sensor)
        self._hear_frames()
        if settings.use_sim_time:
            clock, newest = ros("rosgraph_msgs.msg").Clock, _profile(1, reliable=False)
            self.node.create_subscription(clock, "/clock", self._hear_clock, newest)

    def _hear(self, package: str, kind: str, topic: str, read: Callable[[Any], Any], qos: Any) -> None:
        """Take in a topic; what makes no sense is left out."""

        def take_in(message: Any) -> None:
            told = read(message)
            if told is not None:
                self._told.append(told)

        self.node.create_subscription(getattr(ros(f"{package}.msg"), kind), topic, take_in, qos)

    def _hear_frames(self) -> None:
        """Take in TF: the robot's own, and of what all robots share the frames with its namespace first."""
        message, namespace = ros("tf2_msgs.msg").TFMessage, self.settings.namespace.strip("/")
        for topic in dict.fromkeys((self.node.resolve_topic_name("tf"), "/tf")):
            prefix = f"{namespace}/" if namespace and topic == "/tf" else ""
            for name, fixed, qos in (
                (topic, False, _profile(100, reliable=False)),
                (f"{topic}_static", True, _profile(100, kept=True)),
            ):
                take_in = partial(self._hear_joints, prefix, fixed)
                self.node.create_subscription(message, name, take_in, qos)

    def _hear_joints(self, prefix: str, fixed: bool, message: Any) -> None:
        joints = joints_of(message, fixed=fixed)
        self._told.extend(joint for joint in joints if joint.child.lstrip("/").startswith(prefix))

    def _hear_clock(self, message: Any) -> None:
        self.time = seconds(message.clock)

    # -- the navigator ------------------------------------------------------------------------------------

    @property
    def navigator(self) -> bool:
        """Whether there is one."""
        return self._navigator.is_there

    def ask(self, goal: int, place: Place, frame: str) -> None:
        """Send a goal."""
        self._navigator.ask(goal, place, frame)

    def cancel(self, goal: int) -> None:
        """Cancel a goal."""
        self._navigator.cancel(goal)

    # -- for those who use the robot's ROS ----------------------------------------------------------------

    def _serve(self) -> None:
        """Offer the services."""
        for word in Word:
            obey = partial(self._hear_word, word)
            self.node.create_service(ros("std_srvs.srv").Trigger, f"{OURS}/{word}", obey)

    def _hear_word(self, word: Word, asked: Any, said: Any) -> Any:
        self._told.append(word)
        said.success = True
        if word is Word.STOP:
            os.kill(os.getpid(), signal.SIGTERM)  # as from whoever started the agent
        return said

    def show(self, notice: Notice) -> None:
        """Publish a message, for who comes late as well."""
        if notice.topic not in self._publishers:
            package, _, name = notice.kind.partition("/msg/")
            topic = notice.topic if notice.topic.startswith("/") else f"{OURS}/{notice.topic}"
            kind = getattr(ros(f"{package}.msg"), name)
            self._publishers[notice.topic] = self.node.create_publisher(kind, topic, _profile(1, kept=True))
        self._publishers[notice.topic].publish(notice.cdr)

    # -- what there is to be told -------------------------------------------------------------------------

    def offered(self) -> Offered:
        """Return what the robot's ROS offers by now."""
        node = self.node
        names = {name: node.resolve_topic_name(getattr(self.settings, name)) for name in TOPICS}
        names |= {name: node.resolve_topic_name(name) for name in ("tf", "tf_static")}
        topics = (*names.values(), "/tf", "/tf_static", "/clock")
        return Offered(
            {name: tuple(types) for name, types in node.get_topic_names_and_types()},
            names,
            {topic: self._writers(topic) for topic in topics},
            self.navigator,
            self._state_of(NAVIGATOR),
        )

    def _writers(self, topic: str) -> tuple[Writer, ...]:
        qos = ros("rclpy.qos")
        profiles = [info.qos_profile for info in self.node.get_publishers_info_by_topic(topic)]
        return tuple(
            Writer(
                each.reliability == qos.ReliabilityPolicy.RELIABLE,
                each.durability == qos.DurabilityPolicy.TRANSIENT_LOCAL,
            )
            for each in profiles
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

    def close(self) -> None:
        """Leave; what was ordered last is given the time to get out."""
        time.sleep(GOODBYE if self._navigator.was_asked else 0.0)
        self._executor.shutdown()
        self._thread.join(GOODBYE)
        self.node.destroy_node()
        self._context.try_shutdown()
