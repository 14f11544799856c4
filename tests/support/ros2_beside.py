"""Somebody who uses a robot's ROS, with nothing of Vedette."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from tests.support.ros2_teams import DOMAIN


class Beside:
    """Listens to a robot, and tells its agent what to do."""

    def __init__(self, namespace: str = "robot1") -> None:
        import rclpy
        from nav_msgs.msg import OccupancyGrid, Odometry
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.qos import DurabilityPolicy, QoSProfile
        from std_srvs.srv import Trigger

        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=DOMAIN)
        self.node = rclpy.create_node("beside", namespace=namespace, context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.trigger = Trigger
        self.known, self.speed, self.at = 0, 0.0, (0.0, 0.0)
        late = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.node.create_subscription(OccupancyGrid, "vedette/team_map", self.hear_map, late)
        self.node.create_subscription(Odometry, "odom", self.hear_odometry, 10)

    def hear_map(self, message: Any) -> None:
        self.known = int(np.count_nonzero(np.asarray(message.data) >= 0))

    def hear_odometry(self, message: Any) -> None:
        self.speed = abs(message.twist.twist.linear.x) + abs(message.twist.twist.angular.z)
        self.at = message.pose.pose.position.x, message.pose.pose.position.y

    def hear_frames(self, heard: list[tuple[str, str, float, float]]) -> None:
        """Note parent, child, x and y [m] of what TF tells of the robot's map and of the team."""
        from tf2_msgs.msg import TFMessage

        def take(message: Any) -> None:
            for joint in message.transforms:
                if joint.header.frame_id.startswith("team"):
                    t = joint.transform.translation
                    heard.append((joint.header.frame_id, joint.child_frame_id, t.x, t.y))

        self.node.create_subscription(TFMessage, "tf", take, 100)

    def listen(self) -> None:
        """Take in what has come by now."""
        self.executor.spin_once(timeout_sec=0.0)

    def until(self, holds: Callable[[], bool], what: str, patience: float = 90.0) -> None:
        end = time.monotonic() + patience
        while not holds():
            assert time.monotonic() < end, what
            self.executor.spin_once(timeout_sec=0.1)

    def stays(self, holds: Callable[[], bool], span: float = 3.0) -> bool:
        end = time.monotonic() + span
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.1)
            if not holds():
                return False
        return True

    def say(self, word: str) -> None:
        client = self.node.create_client(self.trigger, f"vedette/{word}")
        assert client.wait_for_service(timeout_sec=20.0), word
        said = client.call_async(self.trigger.Request())
        self.until(said.done, word)
        assert said.result().success

    def close(self) -> None:
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()
