"""An exploration from its ``run.mcap``: the snapshots that were recorded, for pictures and replay."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.laid import around, laid
from vedette.missions.explore.expected import Forecaster
from vedette.record.explore.details import RobotDetails, Spots, read
from vedette.record.explore.log import ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.explore.markers import links_in
from vedette.record.read import Moment, Mover, facts_of, grid_of, metrics_of, moments


@dataclass
class _Robot(Mover):
    """A robot as the record has it up to now."""

    name: str = ""
    driven: float = 0.0
    details: RobotDetails = field(default_factory=RobotDetails)

    def hear(self, messages: Mapping[str, Any]) -> None:
        """Take what is told of it."""
        super().hear(messages)
        if (driven := messages.get(f"/{self.topic}/driven")) is not None:
            self.driven = driven.data
        if (told := messages.get(f"/{self.topic}/details")) is not None:
            self.details = read(told.data, RobotDetails)

    def robot(self) -> RobotSample:
        """Return it as it is now."""
        goal = (float(self.path[-1, 0]), float(self.path[-1, 1])) if len(self.path) else None
        told = msgspec.structs.asdict(self.details)
        sample = *self.at, self.state, self.alive, self.path, self.name
        return RobotSample(*sample, goal, self.driven, **told)


def read_scene(path: Path) -> ExploreScene:
    """Return what an exploration's record is of.

    Raises:
        InputError: it cannot be read, or is of another kind of mission.
    """
    facts = facts_of(path)
    robots = tuple(name.removeprefix("robot ") for name in facts if name.startswith("robot "))
    name = facts.get("world") or (facts.get("team") if facts.get("mission") == "explore" else None)
    if name is None or not robots:
        raise InputError(f"{path}: it is of no mission that this version draws")
    frames: list[GridFrame] = []
    planning: GridFrame | None = None
    for moment in moments(path):
        if "/map" in moment.messages and (frame := _frame(moment.messages["/map"])) not in frames:
            frames.append(frame)
        if "/team_impact" in moment.messages:
            planning = _frame(moment.messages["/team_impact"])
        if frames and planning is not None:
            break  # the map of a whole team stays where it is; a robot's own grows
    if not frames:
        raise InputError(f"{path}: there is no map in it; nothing can be drawn")
    frame = frames[0] if len(frames) == 1 else around(frames)
    return ExploreScene(name=name, vehicles=robots, frame=frame, planning=planning or frame)


def read_snapshots(path: Path, scene: ExploreScene) -> Iterator[ExploreSnapshot]:
    """Yield the snapshots of an exploration's record; grids, which it has every 5 s, stay until the next.

    Raises:
        InputError: it cannot be read.
    """
    facts = facts_of(path)
    robots = [_Robot(facts[f"robot {name}"], name=name) for name in scene.vehicles]
    classes: NDArray[np.uint8] = np.zeros(scene.frame.shape, np.uint8)
    impact: NDArray[np.float32] | None = None
    left_out: Spots = ()
    forecaster = Forecaster()
    for moment in moments(path):
        messages = moment.messages
        try:
            for robot in robots:
                robot.hear(messages)
            if "/left_out" in messages:
                left_out = read(messages["/left_out"].data, Spots)
        except ValueError as error:
            raise InputError(f"{path}: at {moment.stamp / 1e9:g} s: {error}") from None
        if "/map" in messages:
            classes = _laid(messages["/map"], scene.frame)
        if "/team_impact" in messages:
            impact = grid_of(messages["/team_impact"]).astype(np.float32) / np.float32(100.0)
        if "/tf" in messages:
            team = [robot.robot() for robot in robots]
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
    metric = metrics_of(moment)
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


def _frame(grid: Any) -> GridFrame:
    info, corner = grid.info, grid.info.origin.position
    return GridFrame(_digits(info.resolution), info.height, info.width, corner.x, corner.y)


def _digits(resolution: float) -> float:
    """Return a side as it was before a message held it with 24 bits."""
    return float(f"{resolution:.7g}")


def _laid(grid: Any, frame: GridFrame) -> NDArray[np.uint8]:
    """Return the classes of a map (R, C) on the scene's grid."""
    values, own = grid_of(grid), _frame(grid)
    classes = np.where(values < 0, UNKNOWN, np.where(values > 0, OCCUPIED, FREE)).astype(np.uint8)
    return classes if own == frame else laid(classes, own, frame)
