"""What a robot's condition says, as the operator's figures and pictures take it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.net.names import robot_name
from vedette.net.report import Condition, Report
from vedette.overlay import LinkStatus, Place, Status
from vedette.record.figures import RobotFigures, RoundFigures
from vedette.record.links import Link, links_of
from vedette.record.log import VehicleSample
from vedette.record.summary import Traffic

UNHEARD = "not heard yet"  # state of a vehicle of the scenario that has told nothing


def now_of(reports: Mapping[int, Report]) -> float:
    """Return the time of a mission that goes by a common clock [s]."""
    return max((report.condition.time for report in reports.values()), default=0.0)


def vehicle_name(names: Sequence[str], robot: int) -> str:
    """Return what a robot is called: by the names that there are, else by its number."""
    return names[robot] if robot < len(names) else robot_name(robot)


def status_of(condition: Condition) -> Status:
    """Return a robot's overlay as it told of it."""
    place = Place(condition.number, condition.parent, condition.neighbours, condition.size)
    links = tuple(
        LinkStatus(link.robot, link.role, link.loss, link.offset, link.round_trip, link.silent)
        for link in condition.links
    )
    return Status(condition.root, condition.epoch, 0, place, condition.age, 0.0, links)


def links_among(reports: Mapping[int, Report], numbers: Sequence[int]) -> tuple[Link, ...]:
    """Return the links that both ends tell of, by the places of their robots among ``numbers``, from 1."""
    place = {number - 1: i for i, number in enumerate(numbers)}
    told = [reports.get(robot) for robot in range(max(reports, default=-1) + 1)]
    links = links_of([None if each is None else status_of(each.condition) for each in told])
    return tuple(replace(link, a=place[link.a], b=place[link.b]) for link in links)


def sample_of(condition: Condition, state: str | None = None) -> VehicleSample:
    """Return a vehicle as it told of itself; ``state``: what has become of it since, None: nothing."""
    at = condition.x, condition.y, condition.heading
    return VehicleSample(*at, state or condition.state, state is None, path_of(condition))


def path_of(condition: Condition) -> NDArray[np.float64]:
    """Return what is ahead of a robot, ``(k, 2)`` [m], team frame."""
    return np.array(condition.path[: len(condition.path) // 2 * 2], np.float64).reshape(-1, 2)


def figures_of(condition: Condition) -> RobotFigures:
    """Return what a robot has counted."""
    return RobotFigures(
        travelled_m=condition.travelled,
        rounds=RoundFigures(condition.rounds, condition.sweeps, condition.bounded, condition.bound_ratios),
        messages=_traffic(condition.messages),
        bytes=_traffic(condition.bytes),
    )


def _traffic(counts: Mapping[str, int]) -> Traffic:
    return Traffic(**{kind: counts.get(kind, 0) for kind in Traffic.__dataclass_fields__})
