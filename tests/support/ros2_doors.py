"""A door to a robot that a test opens, and what a robot tells through it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from vedette.ros2.door import Joint, Notice, Told
from vedette.ros2.goals import Place
from vedette.ros2.offered import Offered, Writer
from vedette.ros2.scans import LaserSweep
from vedette.ros2.transforms import planar

SCAN = "sensor_msgs/msg/LaserScan"
SENSOR, LATCHED = Writer(reliable=False, kept=False), Writer(reliable=True, kept=True)
NAMES = {
    "scan": "/r/scan",
    "map": "/r/map",
    "pose": "/r/amcl_pose",
    "navigate_to_pose": "/r/navigate_to_pose",
}
NAMES |= {"tf": "/r/tf", "tf_static": "/r/tf_static"}
TF = "tf2_msgs/msg/TFMessage"
WHOLE = Offered(  # of a robot in the namespace r that offers all that is needed
    {"/r/scan": (SCAN,), "/r/tf": (TF,), "/r/tf_static": (TF,)},
    NAMES,
    {"/r/scan": (SENSOR,), "/r/tf": (Writer(True, False),), "/r/tf_static": (LATCHED,)},
    navigator=True,
    state="active",
)


@dataclass
class FakeDoor:
    """Told by the test; remembers what it is asked for."""

    told: list[Told] = field(default_factory=list)
    asked: list[tuple[int, Place]] = field(default_factory=list)
    frame: str = ""  # that the latest goal was in
    cancelled: list[int] = field(default_factory=list)
    closed: bool = False
    shown: list[Notice] = field(default_factory=list)
    time: float | None = None
    offer: Offered | None = None
    navigator: bool = True
    telling: Callable[[], list[Told]] | None = None  # what comes whenever it is asked, beside ``told``

    def take(self) -> Sequence[Told]:
        told, self.told = self.told, []
        return told if self.telling is None else [*told, *self.telling()]

    def show(self, notice: Notice) -> None:
        self.shown.append(notice)

    def offered(self) -> Offered:
        assert self.offer is not None
        return self.offer

    def ask(self, goal: int, place: Place, frame: str) -> None:
        self.asked.append((goal, place))
        self.frame = frame

    def cancel(self, goal: int) -> None:
        self.cancelled.append(goal)

    def close(self) -> None:
        self.closed = True


def at(stamp: float, x: float, y: float = 0.0, yaw: float = 0.0, prefix: str = "") -> list[Told]:
    """What TF tells at a time of a robot at a place of its map, with a lidar 0.2 m ahead of its middle."""
    return [
        Joint(f"{prefix}map", f"{prefix}odom", stamp, planar(0.0, 0.0, 0.0)),
        Joint(f"{prefix}odom", f"{prefix}base_link", stamp, planar(x, y, yaw)),
        Joint(f"{prefix}base_link", f"{prefix}laser", 0.0, planar(0.2, 0.0, 0.0), fixed=True),
    ]


def scan(stamp: float, prefix: str = "") -> LaserSweep:
    return LaserSweep(f"{prefix}laser", stamp, -0.5, 0.1, 0.0, 0.1, 6.0, np.full(11, 2.0))
