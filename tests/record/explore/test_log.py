"""The run log keeps what the pictures need, within its memory."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from tests.support.record_mission import frames, mission, recorded, rooms, scene
from vedette.maps import GridFrame
from vedette.record.explore.log import ExploreLog, ExploreSnapshot, RobotSample
from vedette.team import PlatformSpec

SOLID = rooms(80, 120)
SPECS = [PlatformSpec(name="robot-1"), PlatformSpec(name="robot-2")]
SCENE = scene("rooms", *frames(SOLID, 0.1, (0.0, 0.0)), ("robot-1", "robot-2"))


def _snapshots(limit: float = 40.0) -> list[ExploreSnapshot]:
    """Return a mission's snapshots with grids of their own."""
    run = mission(SOLID, SPECS, np.random.default_rng(4), (3.0, 3.0), limit=limit, radio=1.0)
    return [ExploreSnapshot(**(vars(s) | {"classes": s.classes.copy()})) for s in run]


@pytest.fixture(scope="module")
def snapshots() -> list[ExploreSnapshot]:
    return _snapshots()


def _log(budget: int = 64 << 20, sinks: tuple[object, ...] = ()) -> ExploreLog:
    return ExploreLog(SCENE, sinks, budget)  # type: ignore[arg-type]


def test_stored_snapshots_come_back_as_they_were(snapshots: list[ExploreSnapshot]) -> None:
    log = _log()
    for snapshot in snapshots:
        log.add(snapshot)
    back = list(log.snapshots())
    assert len(back) == len(snapshots) == len(log)
    for was, now in zip(snapshots, back, strict=True):
        assert now.t == was.t
        assert now.robots == was.robots
        assert now.links == was.links
        np.testing.assert_array_equal(now.classes, was.classes)
        assert was.impact is not None
        assert now.impact is not None
        np.testing.assert_allclose(now.impact, was.impact, atol=0.5 / 255 + 1e-6)


def test_grids_may_be_reused_by_the_caller_after_add() -> None:
    log = _log()
    expected = []
    for snapshot in mission(SOLID, SPECS, np.random.default_rng(4), (3.0, 3.0), limit=20.0):
        expected.append(snapshot.classes.copy())
        log.add(snapshot)  # the mission goes on writing into the same array
    for now, was in zip(log.snapshots(), expected, strict=True):
        np.testing.assert_array_equal(now.classes, was)


def test_curves_and_path_lengths_hold_every_snapshot(snapshots: list[ExploreSnapshot]) -> None:
    log = _log()
    for snapshot in snapshots:
        log.add(snapshot)
    assert log.times.tolist() == [s.t for s in snapshots]
    assert log.coverage.tolist() == [s.coverage for s in snapshots]
    assert log.entropy.tolist() == [s.entropy for s in snapshots]
    assert log.known_fraction.tolist() == [s.known_fraction for s in snapshots]
    assert log.apart.tolist() == [not s.links for s in snapshots]
    assert 0 < log.apart.sum() < len(snapshots)
    total = 0.0
    for before, after in pairwise(snapshots):
        total += np.hypot(after.robots[1].x - before.robots[1].x, after.robots[1].y - before.robots[1].y)
    assert log.path_length.tolist() == [[robot.driven for robot in s.robots] for s in snapshots]
    assert log.path_length[0].tolist() == [0.0, 0.0]
    assert log.path_length[-1, 1] == pytest.approx(total)


def test_a_small_budget_thins_evenly_and_keeps_first_and_last(snapshots: list[ExploreSnapshot]) -> None:
    log = _log(budget=4000)
    for snapshot in snapshots:
        log.add(snapshot)
    times = [s.t for s in log.snapshots()]
    assert times[0] == snapshots[0].t
    assert times[-1] == snapshots[-1].t
    assert 2 < len(times) < len(snapshots) / 2
    assert len(set(np.diff(times[:-1]))) == 1
    assert len(log.times) == len(snapshots)


def test_stages_are_the_first_at_each_third_of_the_final_coverage(snapshots: list[ExploreSnapshot]) -> None:
    log = _log()
    for snapshot in snapshots:
        log.add(snapshot)
    final = snapshots[-1].coverage
    expected = [next(s.t for s in snapshots if s.coverage >= final * k / 3) for k in (1, 2)]
    assert [s.t for s in log.stages()] == [*expected, snapshots[-1].t]


def test_every_snapshot_reaches_every_sink(snapshots: list[ExploreSnapshot]) -> None:
    class Counter:
        def __init__(self) -> None:
            self.times: list[float] = []

        def update(self, snapshot: ExploreSnapshot) -> None:
            self.times.append(snapshot.t)

    sinks = Counter(), Counter()
    log = _log(budget=1, sinks=sinks)
    for snapshot in snapshots:
        log.add(snapshot)
    assert sinks[0].times == sinks[1].times == [s.t for s in snapshots]


def test_a_huge_map_is_kept_in_little_memory() -> None:
    frame = GridFrame(0.05, 4000, 4000)
    log = ExploreLog(scene("cave", frame, frame.coarse(4), ("robot-1",)))
    classes = np.zeros(frame.shape, np.uint8)
    classes[1000:3000, 500:3500] = 1
    robot = RobotSample(1.0, 1.0, 0.0, "driving", True, np.empty((0, 2)), "robot-1", None)
    for t in range(3):
        log.add(ExploreSnapshot(float(t), (robot,), 0.1, 0.4, 1.0, classes, None))
    assert sum(kept.size for kept in log._stored) < 1_000_000


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"t": -1.0}, "order of time"),
        ({"robots": ()}, "the log is of"),
        ({"classes": np.zeros((3, 3), np.uint8)}, "classes must be"),
        ({"impact": np.zeros((3, 3), np.float32)}, "impact must be"),
    ],
)
def test_a_snapshot_that_does_not_fit_is_refused(
    snapshots: list[ExploreSnapshot], change: dict[str, object], words: str
) -> None:
    log = _log()
    log.add(snapshots[0])
    with pytest.raises(ValueError, match=words):
        log.add(ExploreSnapshot(**(vars(snapshots[1]) | change)))
    assert len(log) == 1


def test_an_empty_log_says_so() -> None:
    with pytest.raises(ValueError, match="empty"):
        _log().stages()


def test_the_pretended_mission_is_the_same_for_the_same_seed() -> None:
    one, two = (recorded(SOLID, 2, 7, (3.0, 3.0), limit=15.0) for _ in range(2))
    np.testing.assert_array_equal(one.poses, two.poses)
