"""A robot's body, once the robot has told what there is to know of it."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace

from vedette.errors import InputError, InputWarning
from vedette.ros2.body import Ros2Body
from vedette.ros2.check import POLL, Heard, OpenDoor, findings
from vedette.ros2.node import RosDoor
from vedette.ros2.scans import Lidar
from vedette.ros2.settings import Ros2Settings
from vedette.ros2.transforms import Gap
from vedette.team import PlatformSpec

SOON = 3.0  # so long nobody is told that the agent waits [s]


def tell(line: str) -> None:
    """Tell whoever watches this process."""
    warnings.warn(line, InputWarning, stacklevel=3)


@dataclass(frozen=True)
class Patience:
    """How an agent waits for its robot."""

    clock: Callable[[], float] = time.monotonic  # [s]
    sleep: Callable[[float], None] = time.sleep  # for so long [s]
    say: Callable[[str], None] = tell  # what it waits for, a line whenever that changes
    time_of_day: Callable[[], float] = time.time  # [s]


def ros2_body(spec: PlatformSpec, settings: Ros2Settings) -> Ros2Body:
    """Return the body of a robot that runs ROS 2; its lidar is what its scans tell of it.

    Raises:
        InputError: there is no rclpy, or the robot does not tell what is needed, as the line says.
    """
    door = RosDoor(settings, "vedette_" + spec.name.replace("-", "_"))
    try:
        return awaited(spec, settings, door, Patience())
    except BaseException:
        door.close()
        raise


def awaited(spec: PlatformSpec, settings: Ros2Settings, door: OpenDoor, patience: Patience) -> Ros2Body:
    """Return the body as soon as the robot has told where it is and what its lidar is like.

    Raises:
        InputError: it has not, after ``settings.wait`` seconds; or its scans cannot be a lidar's.
    """
    body = Ros2Body(spec, settings, door)
    heard, began, said = Heard(body, patience.time_of_day), patience.clock(), ""
    while True:
        heard.listen()
        missing = what_is_missing(body)
        if missing is None:
            assert body.latest is not None
            lidar = Lidar.of(body.latest, settings.scan)
            body.hull = replace(spec, range=lidar.range, view=lidar.view, beams=lidar.beams)
            return body
        waited = patience.clock() - began
        if waited >= settings.wait:
            faults = [found.said for found in findings(heard, door.offered()) if found.good is False]
            raise InputError(f"body.ros2: waited {settings.wait:g} s: {[*faults, missing][0]}")
        if missing != said and waited >= SOON:
            said = missing
            patience.say(f"waits, for up to {settings.wait:g} s: {missing}")
        patience.sleep(POLL)


def what_is_missing(body: Ros2Body) -> str | None:
    """Return what an agent still lacks of a robot to begin; None: nothing."""
    settings, sweep = body.settings, body.latest
    if settings.use_sim_time and body.door.time is None:
        return "nothing on /clock"
    if sweep is None:
        return f"nothing on {settings.scan}"
    if settings.evidence == "map" and body.grids.latest is None:
        return f"nothing on {settings.map}"
    for frame in (settings.base_frame, sweep.frame):
        found = body.transforms.lookup(body.frame(settings.map_frame), body.frame(frame))
        if isinstance(found, Gap):
            return f"no transform from {settings.map_frame} to {frame}"
    if not body.places_scans:
        return f"no transform from {settings.map_frame} to {sweep.frame} at the time of its scans"
    return None if body.door.navigator else f"nobody offers {settings.navigate_to_pose}"
