"""What a robot told over ROS 2 while it was recorded, as its body takes it in."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from vedette.agent.events import Pose, Scan
from vedette.logs import RecordedMap, RecordedScan
from vedette.ros2.body import Ros2Body
from vedette.ros2.door import Grid, Notice, Told
from vedette.ros2.goals import Place
from vedette.ros2.grids import classes_of_occupancy
from vedette.ros2.messages import grid_of, joints_of, patch_of, sweep_of
from vedette.ros2.scans import Lidar
from vedette.ros2.settings import Ros2Settings
from vedette.ros2.transforms import Gap, place

STEP = 0.1  # of the recording's time that the body is told at once [s]
BETWEEN_MAPS = 1.0  # of those that are kept, at least [s]
SCANS, TRANSFORMS = "sensor_msgs/msg/LaserScan", "tf2_msgs/msg/TFMessage"
MAPS, PATCHES = "nav_msgs/msg/OccupancyGrid", "map_msgs/msg/OccupancyGridUpdate"
KINDS = (SCANS, TRANSFORMS, MAPS, PATCHES)
Recorded: TypeAlias = tuple[float, str, str, Callable[[], Any]]  # when [s], topic, type, reads the message


@dataclass(eq=False)
class RecordedDoor:
    """What a robot told in its time; nobody takes orders; ``vedette.ros2.door.Door``."""

    settings: Ros2Settings
    navigator: bool = False
    time: float | None = None  # no /clock is needed: the recording has its own
    topics: dict[str, str] = field(default_factory=dict)  # what there was, with its type
    lidar: Lidar | None = None  # as its first scan has it
    senseless: int = 0  # maps whose size is not what it says
    _told: deque[Told] = field(default_factory=deque)

    def hear(self, topic: str, kind: str, read: Callable[[], Any]) -> None:
        """Take in a message, of whatever topic, if it is the robot's and of use.

        Raises:
            InputError: the first scan is none.
        """
        self.topics[topic] = kind
        maps = self.settings.evidence == "map"
        if kind == TRANSFORMS and topic in self._names("tf", "tf_static", "/tf", "/tf_static"):
            self._told += joints_of(read(), fixed=topic.endswith("tf_static"))
        elif kind == SCANS and not maps and topic in self._names(self.settings.scan):
            sweep = sweep_of(read())
            self.lidar = self.lidar or Lidar.of(sweep, topic)
            self._told.append(sweep)
        elif kind == MAPS and maps and topic in self._names(self.settings.map):
            self._hear_map(grid_of(read()))
        elif kind == PATCHES and maps and topic in self._names(f"{self.settings.map}_updates"):
            self._hear_map(patch_of(read()))

    def _hear_map(self, told: Told | None) -> None:
        if told is None:
            self.senseless += 1
        else:
            self._told.append(told)

    def _names(self, *names: str) -> set[str]:
        """Return names as they are and in the robot's namespace."""
        own = f"/{self.settings.namespace.strip('/')}".rstrip("/")
        return {*names, *(f"{own}/{name}" for name in names)}

    def take(self) -> Sequence[Told]:
        """Return what has been told since the last call."""
        told, self._told = self._told, deque()
        return tuple(told)

    def ask(self, goal: int, place: Place, frame: str) -> None:
        """Send nobody anywhere."""

    def cancel(self, goal: int) -> None:
        """There is nothing to cancel."""

    def show(self, notice: Notice) -> None:
        """Show nobody anything."""

    def close(self) -> None:
        """There is nobody to leave."""


def scans_of(body: Ros2Body, now: float) -> Iterator[RecordedScan]:
    """Yield the scans that a body takes in now, [s] since the recording began."""
    pose: Pose | None = None
    for event in body.sense(now):
        match event:
            case Pose():
                pose = event
            case Scan() if pose is not None:
                x, y = pose.x + event.offset[0], pose.y + event.offset[1]
                yield RecordedScan(now, x, y, pose.heading, event.angles, event.ranges)


@dataclass
class OwnMaps:
    """The maps that a body hears of, some time apart, each where TF has its frame by then."""

    _last: Grid | None = None
    _due: float = 0.0  # [s]

    def of(self, body: Ros2Body, now: float, *, at_last: bool = False) -> Iterator[RecordedMap]:
        """Yield the map that a body holds now, [s] since the recording began, if that is news."""
        body.hear(now)
        grid = body.grids.latest
        if grid is None or grid is self._last or (now < self._due and not at_last):
            return
        map_frame = body.frame(body.settings.map_frame)
        T_map_grid = body.transforms.lookup(map_frame, grid.frame)
        if isinstance(T_map_grid, Gap):
            return
        self._last, self._due = grid, now + BETWEEN_MAPS
        T_map_base = body.transforms.lookup(map_frame, body.frame(body.settings.base_frame))
        yield RecordedMap(
            now,
            classes_of_occupancy(grid.occupancy),
            grid.resolution,
            place(T_map_grid @ grid.T),
            None if isinstance(T_map_base, Gap) else place(T_map_base),
        )
