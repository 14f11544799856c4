"""One agent beside one robot: ``ros2 launch vedette_ros agent.launch.py config:=robot1.yaml``."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Return the launch: namespace, frames and topics are told by the robot's file."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("config", description="The robot's file, as for `vedette agent`."),
            Node(
                package="vedette_ros",
                executable="agent",
                arguments=[LaunchConfiguration("config")],
                output="screen",
                emulate_tty=True,
            ),
        ]
    )
