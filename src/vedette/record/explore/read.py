"""An exploration from its ``run.mcap``: the snapshots that were recorded, for pictures and replay."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import atan2
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.missions.explore.expected import Forecaster
from vedette.record.explore.details import RobotDetails, Spots, read
from vedette.record.explore.log import ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.markers import links_in
from vedette.record.log import DEAD, LEFT
from vedette.record.read import Moment, facts_of, moments

NO_PATH = np.empty((0, 2))


@dataclass
class _Robot:
    """A robot as the record has it up to now."""

    name: str
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    state: str = "waiting"
    path: NDArray[np.float64] = field(default_factory=lambda: NO_PATH)
    driven: float = 0.0
    details: RobotDetails = field(default_factory=RobotDetails)

    def hear(self, topic: str, messages: Mapping[str, Any]) -> None:
        """Take what is told of it under a topic."""
        if (pose := messages.get(f"/{topic}/pose")) is not None:
            self.at = _pose(pose.pose)
        if (state := messages.get(f"/{topic}/state")) is not None:
            self.state = state.data
        if (path := messages.get(f"/{topic}/path")) is not None:
            self.path = np.array([_pose(each.pose)[:2] for each in path.poses]).reshape(-1, 2)
        if (driven := messages.get(f"/{topic}/driven")) is not None:
            self.driven = driven.data
        if (told := messages.get(f"/{topic}/details")) is not None:
            self.details = read(told.data, RobotDetails)

    def sample(self) -> RobotSample:
        """Return it as it is now."""
        alive = self.state not in (DEAD, LEFT)
        goal = (float(self.path[-1, 0]), float(self.path[-1, 1])) if len(self.path) else None
        told = msgspec.structs.asdict(self.details)
        return RobotSample(*self.at, self.state, alive, self.path, self.name, goal, self.driven, **told)


def read_scene(path: Path) -> ExploreScene:
    """Return what an exploration's record is of.

    Raises:
        InputError: it cannot be read, or is of another kind of mission.
    """
    facts = facts_of(path)
    robots = tuple(name.removeprefix("robot ") for name in facts if name.startswith("robot "))
    if "world" not in facts or not robots:
        raise InputError(f"{path}: not of an exploration; only their pictures are drawn anew")
    grids: dict[str, GridFrame] = {}
    for moment in moments(path):
        for topic in ("/map", "/team_impact"):
            if topic in moment.messages:
                grids[topic] = _frame(moment.messages[topic])
        if len(grids) == 2:
            break
    if "/map" not in grids:
        raise InputError(f"{path}: there is no map in it; nothing can be drawn")
    frame = grids["/map"]
    planning = grids.get("/team_impact", frame)
    return ExploreScene(name=facts["world"], vehicles=robots, frame=frame, planning=planning)


def read_snapshots(path: Path, scene: ExploreScene) -> Iterator[ExploreSnapshot]:
    """Yield the snapshots of an exploration's record; grids, which it has every 5 s, stay until the next.

    Raises:
        InputError: it cannot be read.
    """
    facts = facts_of(path)
    robots = {facts[f"robot {name}"]: _Robot(name) for name in scene.vehicles}
    classes: NDArray[np.uint8] = np.zeros(scene.frame.shape, np.uint8)
    impact: NDArray[np.float32] | None = None
    left_out: Spots = ()
    forecaster = Forecaster()
    for moment in moments(path):
        messages = moment.messages
        try:
            for topic, robot in robots.items():
                robot.hear(topic, messages)
            if "/left_out" in messages:
                left_out = read(messages["/left_out"].data, Spots)
        except ValueError as error:
            raise InputError(f"{path}: at {moment.stamp / 1e9:g} s: {error}") from None
        if "/map" in messages:
            classes = _classes(messages["/map"])
        if "/team_impact" in messages:
            impact = _grid(messages["/team_impact"]).astype(np.float32) / np.float32(100.0)
        if "/tf" in messages:
            team = [robot.sample() for robot in robots.values()]
            snapshot = _snapshot(moment, team, classes, impact)
            expected = forecaster.add(snapshot.progress)
            yield replace(snapshot, left_out=left_out, expected=expected)


def _snapshot(
    moment: Moment,
    robots: list[RobotSample],
    classes: NDArray[np.uint8],
    impact: NDArray[np.float32] | None,
) -> ExploreSnapshot:
    told = moment.messages
    metric = {name.rpartition("/")[2]: told[name].data for name in told if name.startswith("/metrics/")}
    frontiers = metric.get("frontiers")
    return ExploreSnapshot(
        t=moment.stamp / 1e9,
        robots=tuple(robots),
        coverage=metric.get("coverage"),
        known_fraction=metric.get("known_fraction"),
        entropy=metric.get("entropy"),
        classes=classes,
        impact=impact,
        links=links_in(told["/links"], robots) if "/links" in told else None,
        known_m2=metric.get("known_m2", 0.0),
        frontiers=None if frontiers is None else int(frontiers),
    )


def _pose(pose: Any) -> tuple[float, float, float]:
    turn = 2.0 * atan2(pose.orientation.z, pose.orientation.w)
    return pose.position.x, pose.position.y, turn


def _frame(grid: Any) -> GridFrame:
    info, corner = grid.info, grid.info.origin.position
    return GridFrame(_digits(info.resolution), info.height, info.width, corner.x, corner.y)


def _digits(resolution: float) -> float:
    """Return a side as it was before a message held it with 24 bits."""
    return float(f"{resolution:.7g}")


def _grid(grid: Any) -> NDArray[np.int8]:
    return np.asarray(grid.data, np.int8).reshape(grid.info.height, grid.info.width)


def _classes(grid: Any) -> NDArray[np.uint8]:
    values = _grid(grid)
    return np.where(values < 0, UNKNOWN, np.where(values > 0, OCCUPIED, FREE)).astype(np.uint8)
