"""The operator's side: what robots report, as the observer and the status table take it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vedette.domains.mapping.impact import ImpactCodec
from vedette.domains.mapping.platform import GivenUp
from vedette.maps import GridFrame
from vedette.net.report import Condition, Report, classes_of, read_report, seen_of
from vedette.overlay import LinkStatus, Place, Status
from vedette.record.explore.log import RobotSample
from vedette.record.explore.views import GroundFigures, RobotView, left_out
from vedette.record.figures import RoundFigures
from vedette.record.summary import Traffic

DEAD = "dead"


def view_of(payload: bytes, frame: GridFrame, codec: ImpactCodec) -> tuple[Condition, RobotView]:
    """Return what a robot reports, over the map of this frame.

    Raises:
        ValueError: malformed, or of another map.
    """
    report = read_report(payload)
    if (report.rows, report.cols) != frame.shape:
        raise ValueError(f"report of a map of {report.rows} x {report.cols} cells, not {frame.shape}")
    condition = report.condition
    return condition, RobotView(
        sample=_sample(condition),
        classes=classes_of(report),
        seen=seen_of(report),
        impact=None if report.impact is None else codec.decode(report.impact),
        figures=_figures(report),
        left_out=left_out([GivenUp(*spot) for spot in condition.given_up], condition.name),
    )


def status_of(condition: Condition) -> Status:
    """Return a robot's overlay as it told of it."""
    place = Place(condition.number, condition.parent, condition.neighbours, condition.size)
    links = tuple(
        LinkStatus(link.robot, link.role, link.loss, link.offset, link.round_trip, link.silent)
        for link in condition.links
    )
    return Status(condition.root, condition.epoch, 0, place, condition.age, 0.0, links)


def _sample(condition: Condition) -> RobotSample:
    path = np.array(condition.path[: len(condition.path) // 2 * 2], np.float64).reshape(-1, 2)
    goal = (float(path[-1, 0]), float(path[-1, 1])) if len(path) else None
    at = condition.x, condition.y, condition.heading
    return RobotSample(*at, condition.state, True, path, condition.name, goal)


def _figures(report: Report) -> GroundFigures:
    told = report.condition
    return GroundFigures(
        travelled_m=told.travelled,
        collisions=told.collisions,
        min_clearance_m=told.min_clearance,
        rounds=RoundFigures(told.rounds, told.sweeps, told.bounded, told.bound_ratios),
        messages=_traffic(told.messages),
        bytes=_traffic(told.bytes),
    )


def _traffic(counts: Mapping[str, int]) -> Traffic:
    return Traffic(**{kind: counts.get(kind, 0) for kind in Traffic.__dataclass_fields__})
