"""A robot's body, once the robot has told what there is to know of it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

from vedette.errors import InputError, brief
from vedette.ros2.body import Ros2Body
from vedette.ros2.door import Door
from vedette.ros2.node import RosDoor
from vedette.ros2.scans import Lidar
from vedette.ros2.settings import Ros2Settings
from vedette.ros2.transforms import Gap
from vedette.team import PlatformSpec

POLL = 0.05  # [s]


def ros2_body(spec: PlatformSpec, settings: Ros2Settings) -> Ros2Body:
    """Return the body of a robot that runs ROS 2; its lidar is what its scans tell of it.

    Raises:
        InputError: there is no rclpy, or the robot does not tell what is needed, as the line says.
    """
    door = RosDoor(settings, "vedette_" + spec.name.replace("-", "_"))
    try:
        return awaited(spec, settings, door, time.monotonic, time.sleep)
    except BaseException:
        door.close()
        raise


def awaited(
    spec: PlatformSpec,
    settings: Ros2Settings,
    door: Door,
    clock: Callable[[], float],
    sleep: Callable[[float], None],
) -> Ros2Body:
    """Return the body as soon as the robot has told where it is and what its lidar is like.

    Raises:
        InputError: it has not, after ``settings.wait`` seconds; or its scans cannot be a lidar's.
    """
    body, until = Ros2Body(spec, settings, door), clock() + settings.wait
    while True:
        body.hear(0.0)
        missing = what_is_missing(body)
        if missing is None:
            assert body.latest is not None
            lidar = Lidar.of(body.latest, settings.scan)
            body.hull = replace(spec, range=lidar.range, view=lidar.view, beams=lidar.beams)
            return body
        if clock() >= until:
            raise InputError(f"body.ros2: waited {settings.wait:g} s: {missing}")
        sleep(POLL)


def what_is_missing(body: Ros2Body) -> str | None:
    """Return what an agent still lacks of a robot to begin, with a remedy; None: nothing."""
    settings, sweep = body.settings, body.latest
    if settings.use_sim_time and body.door.time is None:
        return "nothing on /clock; start the simulation, or leave use_sim_time out"
    if sweep is None:
        return f"nothing on {settings.scan}; start the lidar's driver, or name its topic in scan"
    if settings.evidence == "map" and body.grids.latest is None:
        return f"nothing on {settings.map}; start SLAM, or name its map's topic in map"
    base = body.frame(settings.base_frame)
    for frame, remedy in ((base, "base_frame or map_frame"), (sweep.frame, "the lidar's frame_id")):
        found = body.transforms.lookup(body.frame(settings.map_frame), frame)
        if isinstance(found, Gap):
            known = ", ".join(sorted(body.transforms.frames)) or "none"
            return (
                f"no transform from {settings.map_frame} to {brief(frame)}; start what tells it, or correct "
                f"{remedy} (frames told of: {known})"
            )
    return None
