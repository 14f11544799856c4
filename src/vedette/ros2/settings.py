"""What an agent is told of its ROS 2 robot; every key has the usual name of things as its default."""

from __future__ import annotations

from math import radians
from typing import Annotated, Literal

import numpy as np
from msgspec import Meta, Struct
from numpy.typing import NDArray

from vedette.ros2.transforms import planar

_WORD = "[A-Za-z_][A-Za-z0-9_]*"
Name = Annotated[str, Meta(pattern=f"^[~/]?{_WORD}(/{_WORD})*$", max_length=200)]


class Ros2Settings(Struct, forbid_unknown_fields=True, frozen=True):
    """How the robot is reached. Names without a leading slash are in its namespace."""

    namespace: Annotated[str, Meta(pattern=f"^(/?{_WORD}(/{_WORD})*)?$", max_length=200)] = ""
    scan: Name = "scan"  # sensor_msgs/LaserScan
    map: Name = "map"  # nav_msgs/OccupancyGrid
    base_frame: Name = "base_link"
    odom_frame: Name = "odom"
    map_frame: Name = "map"
    pose: Name = "amcl_pose"  # geometry_msgs/PoseWithCovarianceStamped, where there is one
    navigate_to_pose: Name = "navigate_to_pose"
    use_sim_time: bool = False  # the mission goes by /clock
    evidence: Literal["scan", "map"] = "scan"  # what the robot's evidence is made of
    no_return: Literal["ignore", "free"] = "ignore"  # what a beam says that nothing came back from
    wait: Annotated[float, Meta(ge=0.0, le=86400.0)] = 60.0  # for what the agent needs to begin [s]
    start: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of the map frame: x, y, yaw [m, m, deg], team frame

    @property
    def T_team_map(self) -> NDArray[np.float64]:
        """``(4, 4)``."""
        x, y, yaw = self.start
        return planar(x, y, radians(yaw))

    @property
    def T_map_team(self) -> NDArray[np.float64]:
        """``(4, 4)``."""
        return np.linalg.inv(self.T_team_map).astype(np.float64)
