"""What a robot's condition says, as the operator's figures and pictures take it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from vedette.net.report import Condition
from vedette.overlay import LinkStatus, Place, Status
from vedette.record.figures import RobotFigures, RoundFigures
from vedette.record.summary import Traffic


def status_of(condition: Condition) -> Status:
    """Return a robot's overlay as it told of it."""
    place = Place(condition.number, condition.parent, condition.neighbours, condition.size)
    links = tuple(
        LinkStatus(link.robot, link.role, link.loss, link.offset, link.round_trip, link.silent)
        for link in condition.links
    )
    return Status(condition.root, condition.epoch, 0, place, condition.age, 0.0, links)


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
