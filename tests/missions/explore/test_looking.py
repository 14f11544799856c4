"""A robot that turns as it is advised has looked, in the end, where it was to look, and with few turns."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.agent.events import Pose
from vedette.missions.explore.looking import DIRECTION, SAME_SPOT, Looking
from vedette.team import PlatformSpec

SENSORS = {
    "view": st.sampled_from([30.0, 45.0, 90.0, 180.0, 270.0, 359.0, 360.0]),
    "beams": st.sampled_from([8, 16, 90, 360]),
}


def beams(spec: PlatformSpec, heading: float) -> NDArray[np.float64]:
    """Directions of one scan, as the simulated lidar has them."""
    offsets = (np.arange(spec.beams) + 0.5) / spec.beams - 0.5
    directions: NDArray[np.float64] = heading + np.radians(spec.view) * offsets
    return directions


def widest_gap(sent: list[float], start: float, width: float) -> float:
    """Widest angle of a sector in which no beam was sent, its ends being beams."""
    inside = sorted((angle - start) % math.tau for angle in sent)
    return max(np.diff([0.0, *(angle for angle in inside if angle <= width), width]))


def gaps(spec: PlatformSpec, distance: float) -> tuple[float, float]:
    """Angle between beams, and what may be left of it: two cells of 0.05 m, where it is over six."""
    between = math.radians(spec.view) / spec.beams
    if between * distance <= 6 * 0.05:
        return between, between
    return between, max(min(between, 2 * 0.05 / distance), 2 * DIRECTION)


def follow(looking: Looking, pose: Pose, direction: float | None, distance: float) -> list[float]:
    """Do as advised, about a direction or (None) all round; return all beams sent."""
    sent: list[float] = []
    for _ in range(1500):
        scan = beams(looking.spec, pose.heading)
        looking.add(pose, scan)
        sent += scan.tolist()
        heading = (
            looking.around(pose, distance) if direction is None else looking.toward(pose, direction, distance)
        )
        if heading is None:
            return sent
        pose = Pose(pose.x, pose.y, heading)
    raise AssertionError("it turns for ever")


@settings(max_examples=60)
@given(st.fixed_dictionaries(SENSORS), st.floats(0.5, 8.0), st.floats(-3.0, 3.0), st.booleans())
def test_until_a_scan_was_taken_where_it_turned_to_it_stays_there(
    sensor: dict[str, float], distance: float, heading: float, around: bool
) -> None:
    spec = PlatformSpec(view=sensor["view"], beams=int(sensor["beams"]))
    looking, pose = Looking(spec, 0.05), Pose(0.0, 0.0, heading)
    for _ in range(5):
        looking.add(pose, beams(spec, pose.heading))
        turn = looking.around(pose, distance) if around else looking.toward(pose, 1.0, distance)
        if turn is None:
            return
        pose = Pose(0.0, 0.0, turn)
        again = looking.around(pose, distance) if around else looking.toward(pose, 1.0, distance)
        assert again is not None
        assert math.isclose(again, pose.heading, abs_tol=DIRECTION)


@settings(max_examples=60)
@given(heading=st.floats(-7.0, 7.0), distance=st.floats(0.3, 6.0), **SENSORS)
def test_a_look_all_round_leaves_no_gap_wider_than_between_beams_or_two_cells(
    heading: float, distance: float, view: float, beams: int
) -> None:
    spec = PlatformSpec(view=view, beams=beams)
    sent = follow(Looking(spec, 0.05), Pose(1.0, 2.0, heading), None, distance)
    between, allowed = gaps(spec, distance)
    assert widest_gap(sent, min(sent), math.tau) <= allowed + 3 * DIRECTION
    sweep = math.ceil(between / allowed) + 1
    assert len(sent) / beams <= math.ceil(360.0 / view) * sweep + 2  # scans: no more than it takes


@settings(max_examples=60)
@given(heading=st.floats(-7.0, 7.0), direction=st.floats(-4.0, 4.0), distance=st.floats(0.3, 6.0), **SENSORS)
def test_a_look_at_something_covers_the_view_that_was_planned_about_it(
    heading: float, direction: float, distance: float, view: float, beams: int
) -> None:
    spec = PlatformSpec(view=view, beams=beams)
    sent = follow(Looking(spec, 0.05), Pose(1.0, 2.0, heading), direction, distance)
    between, allowed = gaps(spec, distance)
    width = math.radians(view) - 2 * between
    assert widest_gap(sent, direction - width / 2, width) <= allowed + 3 * DIRECTION


def test_a_lidar_that_sees_all_round_never_turns() -> None:
    looking = Looking(PlatformSpec(), 0.05)
    assert looking.all_round
    assert looking.toward(Pose(0.0, 0.0, 0.0), 1.0, 6.0) is None
    assert looking.around(Pose(0.0, 0.0, 0.0), 2.0) is None


def test_what_is_seen_from_elsewhere_does_not_count() -> None:
    looking = Looking(PlatformSpec(view=180.0), 0.05)
    here, there = Pose(0.0, 0.0, 0.0), Pose(3.0 * SAME_SPOT, 0.0, 0.0)
    looking.add(here, beams(looking.spec, 0.0))
    assert looking.toward(here, 0.0, 2.0) is None
    assert looking.toward(there, 0.0, 2.0) == pytest.approx(looking.between)
    looking.add(there, beams(looking.spec, np.pi))
    assert looking.toward(there, np.pi, 2.0) is None
    assert looking.toward(there, 0.0, 2.0) is not None
