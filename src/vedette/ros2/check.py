"""What an agent would find at a robot, and what it would miss, each with a remedy."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Protocol

from vedette.errors import InputError, nearest_name
from vedette.ros2.body import Ros2Body
from vedette.ros2.door import Door, Joint, Told
from vedette.ros2.offered import Offered
from vedette.ros2.scans import LaserSweep, Lidar
from vedette.ros2.settings import Ros2Settings
from vedette.ros2.transforms import Gap
from vedette.team import PlatformSpec

LOOKED = 5.0  # so long the robot is listened to [s]
POLL = 0.05  # [s]
SLOW = 1.0  # fewer scans a second are too few [Hz]
LATE = 1.0  # a transform that comes so long after its scan is late [s]
APART = 2.0  # clocks that differ by more are worth a word [s]
SCAN, GRID = "sensor_msgs/msg/LaserScan", "nav_msgs/msg/OccupancyGrid"


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at."""

    good: bool | None  # None: an agent can start, but somebody should know
    said: str


class OpenDoor(Door, Protocol):
    """A door through which one can look round as well."""

    def offered(self) -> Offered:
        """Return what the robot's ROS offers by now."""


@dataclass
class Heard:
    """Remembers what passes through a door on its way to a body."""

    body: Ros2Body
    clock: Callable[[], float]  # time of day [s]
    stamps: list[float] = field(default_factory=list)  # of scans [s]
    offsets: list[float] = field(default_factory=list)  # of stamps from the time of day [s]
    joints: deque[Joint] = field(default_factory=lambda: deque(maxlen=1000))

    def listen(self) -> None:
        """Take in what has come."""
        for told in self.body.door.take():
            self._note(told)
            self.body.take_in(told, 0.0)

    def _note(self, told: Told) -> None:
        match told:
            case LaserSweep():
                self.stamps.append(told.stamp)
                self.offsets.append(self.clock() - told.stamp)
            case Joint():
                self.joints.append(told)


def check(
    settings: Ros2Settings,
    door: OpenDoor,
    clock: Callable[[], float] = time.time,
    sleep: Callable[[float], None] = time.sleep,
) -> list[Finding]:
    """Listen to a robot for a while; return what there is to say."""
    heard = Heard(Ros2Body(PlatformSpec(), settings, door), clock)
    until = clock() + LOOKED
    while clock() < until:
        heard.listen()
        sleep(POLL)
    return findings(heard, door.offered())


def findings(heard: Heard, offered: Offered) -> list[Finding]:
    """Return what there is to say of a robot that was listened to."""
    body, settings = heard.body, heard.body.settings
    return [
        *_scans(settings, offered, body, heard),
        *_own_map(settings, offered, body),
        *_frames(settings, offered, body),
        *_clocks(settings, offered, body, heard),
        _navigator(offered),
    ]


def could_start(found: list[Finding]) -> bool:
    """Tell whether an agent could."""
    return all(finding.good is not False for finding in found)


def _scans(settings: Ros2Settings, offered: Offered, body: Ros2Body, heard: Heard) -> Iterator[Finding]:
    topic = offered.names["scan"]
    types = offered.types.get(topic, ())
    if body.latest is None:
        others = [name for name in offered.of_type(SCAN) if name != topic]
        if types and SCAN not in types:
            yield Finding(False, f"{topic} is of type {', '.join(types)}, not {SCAN}; name another in scan")
        elif not offered.writers.get(topic):
            hint = f"scans are on {', '.join(others)}" if others else "no scans anywhere: start the driver"
            yield Finding(False, f"nobody publishes {topic}; {hint}, or correct namespace or scan")
        else:
            yield Finding(False, f"{topic} is published, but nothing came in {LOOKED:g} s; is the lidar on?")
        return
    try:
        lidar = Lidar.of(body.latest, topic)
    except InputError as error:
        yield Finding(False, str(error))
        return
    span = max(heard.stamps) - min(heard.stamps)
    rate = (len(heard.stamps) - 1) / span if span > 0.0 else 0.0
    said = (
        f"{topic}: {rate:.1f} scans/s, {lidar.beams} beams over {lidar.view:.0f} deg, to {lidar.range:g} m, "
        f"in frame {body.latest.frame}"
    )
    yield Finding(None, f"{said}; that is slow") if rate < SLOW else Finding(True, said)


def _own_map(settings: Ros2Settings, offered: Offered, body: Ros2Body) -> Iterator[Finding]:
    if settings.evidence != "map":
        return
    topic, others = offered.names["map"], offered.of_type(GRID)
    if body.grids.latest is not None:
        rows, cols = body.grids.latest.occupancy.shape
        yield Finding(True, f"{topic}: {cols} x {rows} cells of {body.grids.latest.resolution:g} m")
    elif any(not writer.kept for writer in offered.writers.get(topic, ())):
        yield Finding(False, f"{topic} is not published transient local: set that QoS where it is published")
    else:
        hint = f"maps are on {', '.join(others)}" if others else "start SLAM"
        yield Finding(False, f"no map on {topic}; {hint}, or correct namespace or map")


def _frames(settings: Ros2Settings, offered: Offered, body: Ros2Body) -> Iterator[Finding]:
    frames, own = body.transforms.frames, offered.names["tf"]
    if not frames:
        told = [topic for topic in dict.fromkeys((own, "/tf")) if offered.writers.get(topic)]
        silent = " or ".join(dict.fromkeys((own, "/tf")))
        hint = f"{told[0]} has none of this robot's frames" if told else f"nobody publishes {silent}"
        yield Finding(False, f"no transforms: {hint}; start what tells them, or correct namespace")
        return
    for topic in dict.fromkeys((offered.names["tf_static"], "/tf_static")):
        if any(not writer.kept for writer in offered.writers.get(topic, ())):
            yield Finding(None, f"{topic} is not published transient local: who comes late does not hear it")
    map_frame, base = body.frame(settings.map_frame), body.frame(settings.base_frame)
    odom = body.frame(settings.odom_frame)
    rolls = not isinstance(body.transforms.lookup(odom, base), Gap)
    teller = "SLAM or a localiser" if rolls else f"odometry, in {odom}, and SLAM or a localiser"
    wanted = [(map_frame, base, f"start {teller}")]
    if body.latest is not None:
        wanted.append((base, body.latest.frame, "start what tells the lidar's mount (robot_state_publisher)"))
    for target, source, remedy in wanted:
        if isinstance(body.transforms.lookup(target, source), Gap):
            strange = [frame for frame in (target, source) if frame not in frames]
            hint = "; ".join(f"{frame}: {nearest_name(frame, sorted(frames))}" for frame in strange)
            yield Finding(False, f"no transform from {target} to {source}: {hint or remedy}")
        else:
            yield Finding(True, f"{source} lies in {target}")


def _clocks(settings: Ros2Settings, offered: Offered, body: Ros2Body, heard: Heard) -> Iterator[Finding]:
    simulated = bool(offered.writers.get("/clock"))
    if settings.use_sim_time and body.door.time is None:
        yield Finding(False, "nothing on /clock; start the simulation, or leave use_sim_time out")
    if simulated and not settings.use_sim_time:
        yield Finding(None, "/clock is published: if the robot is simulated, set use_sim_time: true")
    if not heard.stamps:
        return
    offset = sorted(heard.offsets)[len(heard.offsets) // 2]
    if abs(offset) > APART and not settings.use_sim_time and not simulated:
        yield Finding(
            None, f"scans are stamped {offset:.0f} s before this host's time; only stamps are compared"
        )
    newest = body.transforms.newest(body.frame(settings.base_frame))
    if newest is not None:
        late = heard.stamps[-1] - newest
        if abs(late) > LATE:
            order = "after" if late > 0.0 else "before"
            yield Finding(
                False,
                f"the latest scan is stamped {abs(late):.1f} s {order} the latest transform of "
                f"{settings.base_frame}; set the clocks of the robot's computers alike (chrony)",
            )


def _navigator(offered: Offered) -> Finding:
    action = offered.names["navigate_to_pose"]
    if offered.navigator:
        if offered.state in (None, "active"):
            return Finding(True, f"{action} is there" + ("" if offered.state is None else ", and active"))
        return Finding(None, f"{action} is there, but {offered.state}: agents wait until Nav2 is active")
    return Finding(False, f"nobody offers {action}; start Nav2, or correct namespace or navigate_to_pose")
