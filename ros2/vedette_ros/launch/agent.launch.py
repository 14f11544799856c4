"""One agent beside one robot: ``ros2 launch vedette_ros agent.launch.py config:=robot1.yaml``.

Further arguments: ``namespace:=robot1`` of the robot, else as its file says; ``wait:=600`` for it [s].
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Return the launch: frames and topics are told by the robot's file."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("config", description="The robot's file, as for `vedette agent`."),
            DeclareLaunchArgument("namespace", default_value="", description="Of the robot."),
            DeclareLaunchArgument("wait", default_value="60", description="For the robot [s]."),
            Node(
                package="vedette_ros",
                executable="agent",
                namespace=LaunchConfiguration("namespace"),
                arguments=[LaunchConfiguration("config"), "--wait", LaunchConfiguration("wait")],
                output="screen",
                emulate_tty=True,
            ),
        ]
    )
