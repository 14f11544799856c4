"""What an agent waits for before it begins, what it says meanwhile, and how it ends if that never comes."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from tests.support.ros2_doors import SENSOR, WHOLE, FakeDoor, at, scan
from vedette.cli import commands
from vedette.cli.agent import told_by_options
from vedette.errors import InputError, InputWarning
from vedette.net.config import load_config
from vedette.ros2.body import Ros2Body
from vedette.ros2.door import Joint, Told
from vedette.ros2.offered import Offered
from vedette.ros2.robot import SOON, Patience, awaited
from vedette.ros2.scans import LaserSweep
from vedette.ros2.settings import Ros2Settings
from vedette.team import PlatformSpec

BEGUN = 1.7e9  # the time of day [s]


@dataclass
class Watched:
    """Time as a waiting agent sees it, and what it said."""

    now: float = 0.0
    said: list[str] = field(default_factory=list)

    @property
    def patience(self) -> Patience:
        return Patience(lambda: self.now, self.pass_, self.said.append, lambda: BEGUN + self.now)

    def pass_(self, span: float) -> None:
        self.now += span


def tells(watch: Watched, leave_out: type | None = None, ahead: float = 0.0) -> Any:
    """What a robot tells whenever it is asked; ``ahead``: of its lidar's clock [s]."""

    def telling() -> list[Told]:
        now = BEGUN + watch.now
        told: list[Told] = [*at(now - 0.1, 0.0), *at(now, 0.0), scan(now + ahead - 0.05)]
        return [each for each in told if leave_out is None or not isinstance(each, leave_out)]

    return telling


def waited(watch: Watched, door: FakeDoor, **settings: Any) -> Ros2Body:
    told: dict[str, Any] = {"namespace": "r", "wait": 10.0, **settings}
    return awaited(PlatformSpec(radius=0.3), Ros2Settings(**told), door, watch.patience)


NO_SCAN = replace(WHOLE, writers={**WHOLE.writers, "/r/scan": ()})


@pytest.mark.parametrize(
    ("offer", "leave_out", "settings", "waits_for", "named"),
    [
        (NO_SCAN, LaserSweep, {}, "nothing on scan", "nobody publishes /r/scan; no scans anywhere"),
        (
            replace(NO_SCAN, types={"/robot1/scan": ("sensor_msgs/msg/LaserScan",)}),
            LaserSweep,
            {},
            "nothing on scan",
            "scans are on /robot1/scan, or correct namespace or scan",
        ),
        (
            replace(WHOLE, types={"/r/scan": ("sensor_msgs/msg/PointCloud2",)}),
            LaserSweep,
            {},
            "nothing on scan",
            "/r/scan is of type sensor_msgs/msg/PointCloud2, not sensor_msgs/msg/LaserScan; name another",
        ),
        (WHOLE, Joint, {}, "no transform from map to base_link", "/r/tf has none of this robot's frames"),
        (
            WHOLE,
            None,
            {"base_frame": "base_lnik"},
            "no transform from map to base_lnik",
            "no transform from map to base_lnik: base_lnik: did you mean 'base_link'?",
        ),
        (
            WHOLE,
            None,
            {"map_frame": "mapp"},
            "no transform from mapp to base_link",
            "no transform from mapp to base_link: mapp: did you mean 'map'?",
        ),
        (
            replace(WHOLE, navigator=False),
            None,
            {},
            "nobody offers navigate_to_pose",
            "nobody offers /r/navigate_to_pose; start Nav2, or correct namespace or navigate_to_pose",
        ),
        (WHOLE, None, {"evidence": "map"}, "nothing on map", "no map on /r/map; start SLAM"),
        (WHOLE, None, {"use_sim_time": True}, "nothing on /clock", "nothing on /clock; start the simulation"),
    ],
)
def test_an_agent_says_what_it_waits_for_and_ends_with_one_line_that_names_it_and_the_remedy(
    offer: Offered, leave_out: type | None, settings: dict[str, Any], waits_for: str, named: str
) -> None:
    watch = Watched()
    door = FakeDoor(offer=offer, navigator=offer.navigator, telling=tells(watch, leave_out))
    with pytest.raises(InputError) as raised:
        waited(watch, door, **settings)
    assert str(raised.value).startswith("body.ros2: waited 10 s: ")
    assert named in str(raised.value)
    assert "\n" not in str(raised.value)
    assert watch.now == pytest.approx(10.0, abs=0.1)
    assert watch.said == [f"waits, for up to 10 s: {waits_for}"]
    assert (door.asked, door.cancelled) == ([], [])


@pytest.mark.parametrize(("ahead", "order"), [(3600.0, "after"), (-3600.0, "before")])
def test_a_lidar_whose_clock_is_an_hour_off_that_of_the_frames_is_named_with_its_remedy(
    ahead: float, order: str
) -> None:
    watch = Watched()
    named = rf"is stamped 3[56]\d\d\.\d s {order} the latest transform of base_link; set the clocks"
    with pytest.raises(InputError, match=named):
        waited(watch, FakeDoor(offer=WHOLE, telling=tells(watch, ahead=ahead)))
    assert watch.said == ["waits, for up to 10 s: no transform from map to laser at the time of its scans"]


def test_a_robot_whose_clocks_agree_is_begun_with_at_once_whatever_this_hosts_clock_shows() -> None:
    watch = Watched()
    door = FakeDoor(offer=WHOLE, telling=lambda: [*at(99.0, 0.0), *at(100.0, 0.0), scan(99.5)])
    body = waited(watch, door)
    assert (watch.now, watch.said) == (0.0, [])
    assert (body.hull.radius, body.hull.range, body.hull.beams) == (0.3, 6.0, 11)
    assert body.hull.view == pytest.approx(np.degrees(1.1))


def test_frames_that_come_late_are_no_reason_to_wait_for_ever() -> None:
    watch = Watched()

    def telling() -> list[Told]:
        now = BEGUN + watch.now
        return [*at(now - 0.7, 0.0), scan(now)]

    waited(watch, FakeDoor(offer=WHOLE, telling=telling))
    assert watch.now < 1.0


def test_what_comes_while_an_agent_waits_is_waited_for_no_more() -> None:
    watch = Watched()
    whole, begun = tells(watch), tells(watch, LaserSweep)
    door = FakeDoor(offer=WHOLE, telling=lambda: (whole if watch.now > 5.0 else begun)())
    waited(watch, door)
    assert SOON < watch.now < 5.2
    assert watch.said == ["waits, for up to 10 s: nothing on scan"]


def test_a_scan_that_no_lidar_sends_ends_an_agent_by_its_topic_and_field() -> None:
    watch = Watched()
    empty = replace(scan(BEGUN), ranges=np.empty(0))
    door = FakeDoor(offer=WHOLE, telling=lambda: [*at(BEGUN, 0.0), empty])
    with pytest.raises(InputError, match="scan: ranges has 0 beams"):
        waited(watch, door)


def test_a_simulated_robot_is_waited_for_in_vain(tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    body = "body: {map: nowhere.yaml, start: [0, 0, 0]}"
    file.write_text(f"team: t\nrobot: 1\nlinks: {{insecure: true}}\n{body}\n")
    with pytest.warns(InputWarning, match="--wait changes nothing: this robot does not run ROS 2"):
        ended = CliRunner().invoke(commands, ["agent", str(file), "--wait", "5"])
    assert isinstance(ended.exception, InputError)


def test_a_namespace_takes_the_place_of_the_files_and_one_that_cannot_be_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text("team: t\nrobot: 1\nlinks: {insecure: true}\nbody: {ros2: {namespace: other, wait: 7}}\n")
    told = told_by_options(load_config(file), {"namespace": "/robot1", "wait": None}).body.ros2
    assert told == Ros2Settings(namespace="/robot1", wait=7.0)
    with pytest.raises(InputError, match="--namespace is 'robot 1'; give a name of ROS"):
        told_by_options(load_config(file), {"namespace": "robot 1"})


def test_how_long_to_wait_is_refused_where_it_makes_no_sense(tmp_path: Path) -> None:
    ended = CliRunner().invoke(commands, ["agent", str(tmp_path), "--wait", "-1"])
    assert "--wait must be above 0" in str(ended.exception)


def test_a_map_that_is_published_for_nobody_who_comes_late_is_named() -> None:
    watch = Watched()
    offer = replace(WHOLE, writers={**WHOLE.writers, "/r/map": (SENSOR,)})
    with pytest.raises(InputError, match="/r/map is not published transient local"):
        waited(watch, FakeDoor(offer=offer, telling=tells(watch)), evidence="map")
