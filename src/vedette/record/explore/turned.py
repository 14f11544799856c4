"""A robot's view that lies in a frame of its own, as it lies in the observer's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vedette.align import FramePose
from vedette.align.turned import turned
from vedette.maps import GridFrame
from vedette.record.explore.log import RobotSample
from vedette.record.explore.summary import LeftOut
from vedette.record.explore.views import RobotView


def view_turned(view: RobotView, there: FramePose, onto: GridFrame) -> RobotView:
    """Return a view as it lies in another frame, its grids on ``onto``; ``there``: T_onto_view."""
    back = there.inverse()
    return replace(
        view,
        sample=sample_turned(view.sample, there),
        frame=onto,
        classes=turned(view.classes, view.frame, back, onto),
        seen=turned(view.seen, view.frame, back, onto),
        impact=None,
        left_out=spots_turned(view.left_out, there),
    )


def sample_turned(sample: RobotSample, there: FramePose) -> RobotSample:
    """Return what a robot tells of itself as it lies in another frame."""
    at = there.after(FramePose(sample.x, sample.y, sample.heading))
    stops = there.places(np.array([(stop.x, stop.y) for stop in sample.tour]).reshape(-1, 2)).tolist()
    path = there.places(sample.path)
    return replace(
        sample,
        x=at.x,
        y=at.y,
        heading=at.angle,
        path=path,
        goal=(float(path[-1, 0]), float(path[-1, 1])) if len(path) else None,
        tour=tuple(stop._replace(x=x, y=y) for stop, (x, y) in zip(sample.tour, stops, strict=True)),
    )


def spots_turned(spots: Sequence[LeftOut], there: FramePose) -> tuple[LeftOut, ...]:
    """Return what a robot leaves as it lies in another frame."""
    places = there.places(np.array([(spot.x, spot.y) for spot in spots]).reshape(-1, 2)).tolist()
    return tuple(replace(spot, x=x, y=y) for spot, (x, y) in zip(spots, places, strict=True))
