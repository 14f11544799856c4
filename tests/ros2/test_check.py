"""What the check finds at robots that lack one thing each, and that it names the remedy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from tests.support.ros2_doors import SENSOR, WHOLE, FakeDoor, at, scan
from vedette.ros2.check import SCAN, Finding, check, could_start
from vedette.ros2.door import Joint, Told
from vedette.ros2.offered import Offered, Writer
from vedette.ros2.scans import LaserSweep
from vedette.ros2.settings import Ros2Settings

BEGUN = 1.7e9  # the time of day [s]


def looked(
    offer: Offered, leave_out: type | None = None, **settings: object
) -> tuple[list[Finding], FakeDoor]:
    """Check a robot that tells all that is needed, as time goes by, but for what is left out."""
    time = [BEGUN]

    def tell() -> list[Told]:
        told: list[Told] = [*at(time[0] - 0.1, 0.0), *at(time[0], 0.0), scan(time[0] - 0.05)]
        return [each for each in told if leave_out is None or not isinstance(each, leave_out)]

    door = FakeDoor(offer=offer, telling=tell)
    findings = check(
        Ros2Settings(namespace="r", **settings),  # type: ignore[arg-type]
        door,
        lambda: time[0],
        lambda span: time.__setitem__(0, time[0] + 0.2),
    )
    return findings, door


def bad(findings: list[Finding]) -> str:
    assert not could_start(findings)
    return "; ".join(finding.said for finding in findings if finding.good is False)


def with_writers(topic: str, writers: tuple[Writer, ...]) -> Mapping[str, tuple[Writer, ...]]:
    return {**WHOLE.writers, topic: writers}


def test_a_robot_that_tells_all_lacks_nothing_and_is_sent_nothing() -> None:
    findings, door = looked(WHOLE)
    assert {finding.good for finding in findings} == {True}
    assert could_start(findings)
    assert (door.asked, door.cancelled) == ([], [])


@pytest.mark.parametrize(
    ("offer", "leave_out", "settings", "named"),
    [
        (replace(WHOLE, writers=with_writers("/r/scan", ())), LaserSweep, {}, "nobody publishes /r/scan"),
        (WHOLE, LaserSweep, {}, "nothing came"),
        (
            replace(WHOLE, types={"/r/scan": ("sensor_msgs/msg/PointCloud2",)}),
            LaserSweep,
            {},
            "PointCloud2, not sensor_msgs/msg/LaserScan",
        ),
        (
            replace(WHOLE, types={"/front": (SCAN,)}, writers=with_writers("/r/scan", ())),
            LaserSweep,
            {},
            "scans are on /front",
        ),
        (replace(WHOLE, writers={}), Joint, {}, "nobody publishes /r/tf or /tf"),
        (WHOLE, Joint, {}, "/r/tf has none of this robot's frames"),
        (WHOLE, None, {"base_frame": "base_lnik"}, "did you mean 'base_link'"),
        (WHOLE, None, {"map_frame": "world"}, "no transform from world to base_link"),
        (WHOLE, None, {"evidence": "map"}, "no map on /r/map; start SLAM"),
        (
            replace(WHOLE, writers=with_writers("/r/map", (SENSOR,))),
            None,
            {"evidence": "map"},
            "/r/map is not published transient local",
        ),
        (WHOLE, None, {"use_sim_time": True}, "nothing on /clock"),
        (replace(WHOLE, navigator=False), None, {}, "nobody offers /r/navigate_to_pose"),
    ],
)
def test_what_is_missing_is_named_with_a_remedy(
    offer: Offered, leave_out: type | None, settings: dict[str, object], named: str
) -> None:
    findings, _ = looked(offer, leave_out, **settings)
    assert named in bad(findings)
    assert not any("\n" in finding.said for finding in findings)


@pytest.mark.parametrize(
    ("offer", "named"),
    [
        (replace(WHOLE, state="inactive"), "inactive: agents wait"),
        (replace(WHOLE, writers=with_writers("/r/tf_static", (SENSOR,))), "not published transient local"),
        (replace(WHOLE, writers=with_writers("/clock", (SENSOR,))), "use_sim_time: true"),
    ],
)
def test_what_an_agent_can_live_with_is_a_note(offer: Offered, named: str) -> None:
    findings, _ = looked(offer)
    assert could_start(findings)
    assert named in "; ".join(finding.said for finding in findings if finding.good is None)


def test_a_clock_an_hour_off_is_a_note_and_clocks_that_differ_on_the_robot_are_a_fault() -> None:
    door, time = FakeDoor(offer=WHOLE), [BEGUN]

    def check_with(of_scans: float, of_tf: float) -> list[Finding]:
        door.telling = lambda: [*at(time[0] + of_tf, 0.0), scan(time[0] + of_scans)]
        return check(
            Ros2Settings(namespace="r"),
            door,
            lambda: time[0],
            lambda span: time.__setitem__(0, time[0] + 0.2),
        )

    notes = [finding.said for finding in check_with(-3600.0, -3600.0) if finding.good is None]
    assert any("3600 s before this host's time" in said for said in notes)
    assert "set the clocks" in bad(check_with(0.0, -30.0))


def test_scans_that_no_lidar_sends_are_a_fault() -> None:
    door, time = FakeDoor(offer=WHOLE), [BEGUN]
    empty = LaserSweep("laser", BEGUN, 0.0, 0.1, 0.0, 0.1, 6.0, np.empty(0))
    door.telling = lambda: [*at(time[0], 0.0), empty]
    findings = check(
        Ros2Settings(namespace="r"), door, lambda: time[0], lambda s: time.__setitem__(0, time[0] + 1.0)
    )
    assert "0 beams" in bad(findings)
