"""The local planner against its twin, and the bodies' promises: fast along free paths, never in contact."""

from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.kernels import motion
from vedette.kernels.reference import motion as twin
from vedette.sim.body import Bodies
from vedette.team import PlatformSpec

RESOLUTION = 0.1
LIMITS = motion.Limits(radius=0.2, speed=0.5, turn_rate=1.5, period=0.1)
OPEN = np.zeros((100, 100), dtype=np.bool_)


def arc_length(path: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))


def drive(
    path: list[tuple[float, float]], solid: NDArray[np.bool_], heading: float, limit: float = 90.0
) -> tuple[Bodies, float]:
    """Let one robot follow ``path``; return its bodies and the time it took."""
    bodies = Bodies(solid, RESOLUTION, [PlatformSpec()], np.array([(*path[0], heading)]))
    bodies.command(0, np.array(path))
    taken = 0.0
    while not bodies.arrived(0) and taken < limit:
        bodies.step(0.1)
        taken += 0.1
    return bodies, taken


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32 - 1))
def test_clearance_equals_the_distance_to_the_nearest_of_all_solid_squares(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solid = rng.random(tuple(rng.integers(3, 30, 2))) < rng.choice([0.0, 0.02, 0.3])
    for x, y in rng.uniform(-0.2, 3.2, (20, 2)):
        reach = rng.uniform(0.05, 2.0)
        expected = twin.clearance(solid, RESOLUTION, x, y, reach)
        assert motion.clearance(solid, RESOLUTION, x, y, reach) == pytest.approx(expected, abs=1e-12)


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32 - 1))
def test_discs_block_the_cells_that_their_twin_blocks(seed: int) -> None:
    rng = np.random.default_rng(seed)
    free = rng.random(tuple(rng.integers(0, 30, 2))) < 0.8
    resolution = float(rng.choice([0.05, 0.1, 0.3]))
    discs = rng.uniform((-1.0, -1.0, 0.0), (4.0, 4.0, 1.5), (rng.integers(0, 6), 3))
    on_centres = np.round(discs / resolution - 0.5) * resolution + 0.5 * resolution
    for some in (discs, on_centres):
        before, blocked = free.copy(), motion.block_discs(free, resolution, some.tolist())
        assert np.array_equal(blocked, twin.block_discs(free, resolution, some.tolist()))
        assert np.array_equal(free, before)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_steer_equals_its_twin(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solid = rng.random((30, 40)) < rng.choice([0.0, 0.01, 0.03])
    traversable = ~solid & (rng.random((30, 40)) > rng.choice([0.0, 0.05]))
    pose = (rng.uniform(1, 3), rng.uniform(1, 2), rng.uniform(-7, 7))
    path = np.vstack((pose[:2], rng.uniform((0.3, 0.3), (3.7, 2.7), (rng.integers(1, 5), 2))))
    n = int(rng.integers(0, 4))
    others = np.column_stack(
        (
            rng.uniform(0, 4, n),
            rng.uniform(0, 3, n),
            rng.uniform(-0.4, 0.4, (n, 2)),
            np.full(n, 0.2),
            np.full(n, 0.3),
        )
    )
    turning = float(rng.choice((0.0, rng.uniform(-1.5, 1.5), -1.5, 1.5)))
    progress = (rng.uniform(0, 0.5), float(rng.choice(twin.OFFSETS)), turning)
    low, high = rng.integers(-5, 10, 2), rng.integers(20, 45, 2)
    padded = np.pad(traversable, 50)[50 + low[0] : 50 + high[0], 50 + low[1] : 50 + high[1]]
    rows, cols = np.indices(traversable.shape)
    traversable &= (rows >= low[0]) & (rows < high[0]) & (cols >= low[1]) & (cols < high[1])
    rest = (RESOLUTION, pose, path, arc_length(path), progress, others, LIMITS)
    first = int(low[0]), int(low[1])
    begun = motion.steer(solid, np.ascontiguousarray(padded), first, *rest)
    scene = (solid, traversable, (0, 0), *rest)
    assert motion.steer(*scene) == begun
    assert motion.steer(*scene) == pytest.approx(twin.steer(*scene), abs=1e-9)
    assert begun == pytest.approx(twin.steer(solid, padded, first, *rest), abs=1e-9)


@pytest.mark.parametrize("heading", [0.0, np.pi / 2, np.pi, -2.5])
@pytest.mark.parametrize(
    "path",
    [
        [(1, 1), (9, 1)],
        [(1, 1), (5, 1), (5, 5)],
        [(1, 1), (5, 1), (5, 5), (1, 5), (1, 2)],
        [(1, 1), (3, 2), (5, 1.5), (8, 5), (8.2, 8)],
        [(1, 1), (5, 1), (2, 2), (5, 3)],
    ],
)
def test_a_free_path_takes_at_most_a_tenth_longer_than_at_top_speed_plus_turning(
    path: list[tuple[float, float]], heading: float
) -> None:
    bodies, taken = drive(path, OPEN, heading)
    steps = np.diff(np.array(path), axis=0)
    directions = np.concatenate(([heading], np.arctan2(steps[:, 1], steps[:, 0])))
    turns = np.abs((np.diff(directions) + np.pi) % (2 * np.pi) - np.pi)
    turning = turns[turns > np.pi / 4].sum() / 1.5
    assert taken <= 1.1 * np.hypot(*steps.T).sum() / 0.5 + turning
    assert bodies.collisions.sum() == 0


def test_a_robot_in_a_corner_does_not_dither_between_two_ways_to_turn() -> None:
    corner = np.ones_like(OPEN)
    corner[:40, :33] = corner[:36] = False
    path = np.array([(3.395, 3.841), (3.35, 4.05), (1.55, 4.05), (1.0, 4.05)])
    for heading in np.linspace(-np.pi, np.pi, 400):
        bodies = Bodies(OPEN, RESOLUTION, [PlatformSpec()], np.array([(*path[0], heading)]))
        bodies.command(0, path, corner)
        for _ in range(100):
            bodies.step(0.1)
        assert bodies.arrived(0), heading


def test_a_sharp_bend_around_a_wall_is_driven_without_contact_at_nearly_full_speed() -> None:
    solid = OPEN.copy()
    solid[:, 48:52] = True
    solid[40:49, 48:52] = False
    path = [(1.0, 1.0), (4.65, 4.25), (5.35, 4.25), (9.0, 1.0)]
    bodies, taken = drive(path, solid, 0.5)
    assert bodies.arrived(0)
    assert bodies.collisions.sum() == 0
    assert bodies.min_clearance.min() > 0.02
    assert taken <= 1.1 * arc_length(np.array(path))[-1] / 0.5


def test_a_path_through_an_unmapped_wall_stops_short_of_it_and_is_reported_as_stuck() -> None:
    solid = OPEN.copy()
    solid[:, 50:52] = True
    everything = np.ones_like(solid)
    bodies = Bodies(solid, RESOLUTION, [PlatformSpec()], np.array([(4.0, 5.0, 0.0)]))
    bodies.command(0, np.array([(4.0, 5.0), (8.0, 5.0)]), everything)
    for _ in range(100):
        bodies.step(0.1)
    assert bodies.collisions.sum() == 0
    assert bodies.min_clearance.min() > 0.02
    assert bodies.stuck_for(0) > 5.0
    bodies.command(0, np.array([(4.7, 5.0), (8.0, 5.1)]), everything)
    assert bodies.stuck_for(0) > 5.0  # the same goal: the clock runs on


def test_a_robot_outside_the_traversable_cells_comes_back_into_them() -> None:
    traversable = np.zeros_like(OPEN)
    traversable[20:80, 20:80] = True
    bodies = Bodies(OPEN, RESOLUTION, [PlatformSpec()], np.array([(1.7, 5.0, np.pi)]))
    bodies.command(0, np.array([(1.7, 5.0), (6.0, 5.0)]), traversable)
    for _ in range(120):
        bodies.step(0.1)
    assert bodies.arrived(0)


def test_a_dead_robot_stays_and_is_driven_around() -> None:
    bodies = Bodies(OPEN, RESOLUTION, [PlatformSpec()] * 2, np.array([(1.0, 5.0, 0.0), (4.0, 5.0, 0.0)]))
    bodies.kill(1)
    bodies.command(1, np.array([(4.0, 5.0), (9.0, 5.0)]))
    bodies.command(0, np.array([(1.0, 5.0), (8.0, 5.0)]))
    for _ in range(160):
        bodies.step(0.1)
    assert bodies.arrived(0)
    assert bodies.collisions.sum() == 0
    assert bodies.poses[1].tolist() == [4.0, 5.0, 0.0]
    assert bodies.travelled[1] == 0.0


def test_a_goal_that_another_robot_stands_on_counts_as_reached_beside_it() -> None:
    bodies = Bodies(OPEN, RESOLUTION, [PlatformSpec()] * 2, np.array([(1.0, 5.0, 0.0), (4.0, 5.0, 0.0)]))
    bodies.command(0, np.array([(1.0, 5.0), (4.0, 5.0)]))
    for _ in range(80):
        bodies.step(0.1)
    assert bodies.arrived(0)
    assert bodies.stuck_for(0) == 0.0
    assert bodies.collisions.sum() == 0


def test_the_same_commands_give_the_same_motion() -> None:
    path = [(1.0, 1.0), (5.0, 1.0), (5.0, 5.0)]
    one, other = drive(path, OPEN, 0.3)[0], drive(path, OPEN, 0.3)[0]
    assert one.poses.tobytes() == other.poses.tobytes()


def test_a_step_of_six_robots_is_quick() -> None:
    poses = np.array([(2.0 + 0.6 * k, 5.0, 0.0) for k in range(6)])
    bodies = Bodies(OPEN, RESOLUTION, [PlatformSpec()] * 6, poses)
    for i, (x, y, _) in enumerate(poses):
        bodies.command(i, np.array([(x, y), (9.0 - x, 9.0 - y)]))
    start = time.thread_time()
    for _ in range(100):
        bodies.step(0.1)
    assert (time.thread_time() - start) / 100 < 0.008  # ten times the target: a guard against blunders only


def test_a_robot_turns_on_the_spot_at_its_paths_end_and_has_arrived_when_it_faces_as_told() -> None:
    for facing in (2.5, -2.5, 9.0):
        bodies = Bodies(OPEN, RESOLUTION, [PlatformSpec()], np.array([(4.0, 5.0, 0.0)]))
        bodies.command(0, np.array([(4.0, 5.0), (5.0, 5.0)]), facing=facing)
        taken, there = 0.0, None
        while not bodies.arrived(0) and taken < 30.0:
            bodies.step(0.1)
            taken += 0.1
            if there is None and np.hypot(*(bodies.poses[0, :2] - (5.0, 5.0))) <= 0.15:
                there = bodies.poses[0, :2].copy(), taken
        assert there is not None
        np.testing.assert_array_equal(bodies.poses[0, :2], there[0])  # it turned on the spot ...
        turn = abs(np.angle(np.exp(1j * facing)))
        assert taken - there[1] <= turn / 1.5 + 0.2  # ... the shorter way, as fast as it can
        assert np.exp(1j * bodies.poses[0, 2]) == pytest.approx(np.exp(1j * facing))
        assert bodies.stuck_for(0) == 0.0


@settings(deadline=None, max_examples=200)
@given(seed=st.integers(0, 10**6), length=st.one_of(st.floats(0.0, 6.0), st.just(float("inf"))))
def test_what_remains_of_a_path_is_what_its_twin_leaves_to_the_bit(seed: int, length: float) -> None:
    rng = np.random.default_rng(seed)
    path = rng.uniform(0.0, 4.0, size=(int(rng.integers(1, 9)), 2))
    x, y = rng.uniform(0.0, 4.0, size=2).tolist()
    left, twins = motion.remaining(path, x, y, length), twin.remaining(path, x, y, length)
    np.testing.assert_array_equal(left, twins)
