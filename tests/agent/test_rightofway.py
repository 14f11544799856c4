"""Traffic: robots with the local planner and right of way exchange places through doors and corridors."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from vedette.agent.intents import Intent
from vedette.agent.refuges import refuge, retreat
from vedette.agent.rightofway import give_way, queues
from vedette.kernels.distance import distance_field, path_to, shortcut
from vedette.kernels.motion import block_discs
from vedette.maps.world import World
from vedette.sim.body import Bodies
from vedette.sim.starts import choose_starts
from vedette.sim.worlds import office
from vedette.team import PlatformSpec

RESOLUTION = 0.1
DT = 0.1
EMPTY = np.empty((0, 2))
Point = tuple[float, float]


def inflated(solid: NDArray[np.bool_], radius: float = 0.2) -> NDArray[np.bool_]:
    """Cells whose centre is at least ``radius`` from every solid square; brute force."""
    reach = int(np.ceil(radius / RESOLUTION)) + 1
    padded = np.pad(solid, reach, constant_values=True)
    free = np.ones_like(solid)
    rows, cols = solid.shape
    for dr in range(-reach, reach + 1):
        for dc in range(-reach, reach + 1):
            gap = np.hypot(max(abs(dr) - 0.5, 0), max(abs(dc) - 0.5, 0)) * RESOLUTION
            if gap < radius - 1e-9:
                free &= ~padded[reach + dr : reach + dr + rows, reach + dc : reach + dc + cols]
    return free


def box(width: float, height: float) -> NDArray[np.bool_]:
    solid = np.zeros((round(height * 10), round(width * 10)), dtype=np.bool_)
    solid[[0, -1]] = solid[:, [0, -1]] = True
    return solid


def two_rooms() -> NDArray[np.bool_]:
    """9 x 6 m, a wall in the middle with a 0.9 m door."""
    solid = box(9, 6)
    solid[:, 44:46] = True
    solid[26:35, 44:46] = False
    return solid


def corridor(width: float = 1.2) -> NDArray[np.bool_]:
    """10 m of corridor between two rooms of 3 x 4 m."""
    solid = box(16, 4)
    half = round(width * 5)
    solid[:, 30:130] = True
    solid[20 - half : 20 + half, 30:130] = False
    return solid


def t_junction() -> NDArray[np.bool_]:
    """A 1.2 m corridor 10 m long with another one from its middle, 5 m long."""
    solid = np.ones((80, 120), dtype=np.bool_)
    solid[56:68, 10:110] = False
    solid[10:56, 54:66] = False
    return solid


def four_rooms() -> NDArray[np.bool_]:
    """10 x 10 m, a cross of walls with a 0.9 m door in each arm."""
    solid = box(10, 10)
    solid[:, 49:51] = solid[49:51, :] = True
    for low in (20, 70):
        solid[low : low + 9, 49:51] = solid[49:51, low : low + 9] = False
    return solid


@dataclass
class Traffic:
    """Robots that drive to their goals, each planning on the true map."""

    solid: NDArray[np.bool_]
    starts: list[Point]
    headings: float = 0.0
    trail: list[NDArray[np.float64]] = field(default_factory=list)

    def __post_init__(self) -> None:
        poses = np.array([(x, y, self.headings) for x, y in self.starts])
        self.n = len(poses)
        self.bodies = Bodies(self.solid, RESOLUTION, [PlatformSpec()] * self.n, poses)
        self.open = inflated(self.solid)
        self.time = 0.0
        self.goals: list[Point | None] = [None] * self.n
        self.maps = [self.open] * self.n
        self.fields = [np.zeros(self.open.shape, dtype=np.float32)] * self.n
        self.paths: list[NDArray[np.float64]] = [EMPTY] * self.n
        self.beacons = [self.intent(i, EMPTY) for i in range(self.n)]
        self.making_room = [False] * self.n
        self.yields = np.zeros(self.n)

    def cell(self, x: float, y: float) -> int:
        return int(int(y / RESOLUTION) * self.open.shape[1] + int(x / RESOLUTION))

    def send(self, i: int, goal: Point) -> float:
        """Give robot ``i`` a goal; return the length of the unobstructed way [m]."""
        self.goals[i] = goal
        dead = [(*self.bodies.poses[j, :2], 0.5) for j in range(self.n) if not self.bodies.alive[j]]
        self.maps[i] = block_discs(self.open, RESOLUTION, dead)
        self.fields[i] = distance_field(self.maps[i], self.cell(*goal), RESOLUTION)
        x, y, _ = self.bodies.poses[i]
        self.plan(i)
        return float(self.fields[i].flat[self.cell(x, y)])

    def route(self, i: int, open_: NDArray[np.bool_], to_goal: NDArray[np.float32]) -> NDArray[np.float64]:
        x, y, _ = self.bodies.poses[i]
        cells = shortcut(open_, path_to(to_goal, open_, self.cell(x, y)))[::-1]
        if len(cells) == 0:
            return EMPTY
        row, col = np.divmod(cells, open_.shape[1])
        path = (np.column_stack((col, row)) + 0.5) * RESOLUTION
        path[0] = (x, y)
        return path

    def intent(self, i: int, path: NDArray[np.float64]) -> Intent:
        x, y, _ = self.bodies.poses[i]
        return Intent(i, x, y, ahead(path, x, y), slowed=self.bodies.stuck_for(i))

    def plan(self, i: int) -> None:
        """One decision of robot ``i``'s agent: make room, or go on."""
        path = EMPTY
        if self.goals[i] is not None:
            path = self.route(i, self.maps[i], self.fields[i])
        others = [self.beacons[j] for j in range(self.n) if j != i and self.bodies.alive[j]]
        me = self.intent(i, path)
        refuge = give_way(self.open, RESOLUTION, me, others)
        waits = refuge is None and queues(self.open, RESOLUTION, me, others)
        self.making_room[i] = refuge is not None or waits
        self.yields[i] += refuge is not None
        self.paths[i] = np.array([(me.x, me.y)]) if waits else path if refuge is None else refuge
        # Up to half a second old when it is used; who waits tells where it will go.
        self.beacons[i] = self.intent(i, path if waits else self.paths[i])
        if len(self.paths[i]) == 0:
            self.bodies.command(i, None)
        else:
            self.bodies.command(i, self.paths[i], self.open)

    def tick(self) -> None:
        count = round(self.time / DT)
        for i in range(self.n):
            if self.bodies.alive[i] and (count + 2 * i) % 5 == 0:
                self.plan(i)
        self.bodies.step(DT)
        self.time += DT
        self.trail.append(self.bodies.poses.copy())
        for i, goal in enumerate(self.goals):
            if goal is not None and not self.making_room[i] and self.bodies.arrived(i):
                self.goals[i] = None

    def drive(self, goals: dict[int, Point], limit: float) -> tuple[dict[int, float], dict[int, float]]:
        """Send robots and wait for all; return each one's time and unobstructed time [s]."""
        ideal = {i: self.send(i, goal) / 0.5 for i, goal in goals.items()}
        times: dict[int, float] = {}
        while len(times) < len(goals) and self.time < limit:
            self.tick()
            for i in goals:
                if self.goals[i] is None:
                    times.setdefault(i, self.time)
        return times, ideal


def ahead(path: NDArray[np.float64], x: float, y: float, reach: float = 3.0) -> NDArray[np.float64]:
    """The next ``reach`` metres of a path, from the point on it nearest to the robot."""
    if len(path) < 2:
        return path[:0]
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
    samples = np.arange(0.0, arc[-1] + 0.05, 0.05)
    points = np.column_stack([np.interp(samples, arc, path[:, k]) for k in (0, 1)])
    start = int(np.argmin(np.hypot(*(points - (x, y)).T)))
    rest = points[start : start + round(reach / 0.05) : 4]
    return np.vstack(((x, y), rest, points[min(start + round(reach / 0.05), len(points) - 1)]))


def random_traffic(
    solid: NDArray[np.bool_], n: int, seconds: float, seed: int
) -> tuple[Traffic, float, float]:
    """Send robots to ever new goals; return their time over the unobstructed one and the worst delay [s]."""
    rng = np.random.default_rng(seed)
    cells = np.flatnonzero(inflated(solid, 0.3))
    centres = [
        ((c % solid.shape[1] + 0.5) * RESOLUTION, (c // solid.shape[1] + 0.5) * RESOLUTION) for c in cells
    ]
    starts: list[Point] = []
    while len(starts) < n:
        start = centres[rng.integers(len(centres))]
        if all(np.hypot(start[0] - x, start[1] - y) > 0.6 for x, y in starts):
            starts.append(start)
    traffic = Traffic(solid, starts)
    ideal, since, spent, done, worst = np.zeros(n), np.zeros(n), 0.0, 0.0, 0.0
    while traffic.time < seconds:
        for i in range(n):
            if traffic.goals[i] is None:
                spent += traffic.time - since[i]
                done += ideal[i]
                turn = 1.0  # turning towards the next goal takes this long on average [s]
                ideal[i] = traffic.send(i, centres[rng.integers(len(centres))]) / 0.5 + turn
                since[i] = traffic.time
        traffic.tick()
        worst = max(worst, float((traffic.time - since - ideal).max()))
    return traffic, spent / done, worst


@pytest.mark.parametrize(
    ("solid", "starts", "goals", "bound"),
    [
        pytest.param(
            two_rooms(), [(1.5, 3), (7.5, 3)], [(7.5, 3), (1.5, 3)], 1.2, id="head-on through a door"
        ),
        pytest.param(
            two_rooms(),
            [(1.5, 2.7), (1.5, 3.4), (7.5, 2.7), (7.5, 3.4)],
            [(7.5, 2), (7.5, 4), (1.5, 2), (1.5, 4)],
            1.3,
            id="two against two through a door",
        ),
        pytest.param(
            corridor(1.2),
            [(1.5, 2), (14.5, 2)],
            [(14.5, 2), (1.5, 2)],
            1.15,
            id="swapping ends of a corridor",
        ),
        pytest.param(
            corridor(1.2),
            [(1.5, 2), (1.5, 3), (14.5, 2), (14.5, 3)],
            [(14.5, 2.5), (14.5, 1.5), (1.5, 2.5), (1.5, 1.5)],
            1.6,
            id="two against two in a corridor",
        ),
        pytest.param(corridor(0.9), [(1.5, 2), (14.5, 2)], [(14.5, 2), (1.5, 2)], 1.6, id="one lane"),
        pytest.param(
            two_rooms(),
            [(1 + 0.6 * (k % 3), 2.6 + 0.6 * (k // 3)) for k in range(6)] + [(7.5, 3)],
            [(5.5 + 0.9 * (k % 3), 1.5 + 2 * (k // 3)) for k in range(6)] + [(1.5, 3)],
            1.3,
            id="six leave by a door while a later one enters",
        ),
        pytest.param(
            two_rooms(),
            [(7.5, 3)] + [(1 + 0.6 * (k % 3), 2.6 + 0.6 * (k // 3)) for k in range(6)],
            [(1.5, 3)] + [(5.5 + 0.9 * (k % 3), 1.5 + 2 * (k // 3)) for k in range(6)],
            1.5,
            id="six leave by a door while an earlier one enters",
        ),
        pytest.param(
            t_junction(),
            [(1.6, 6.2), (10.4, 6.2), (6, 1.6)],
            [(10.4, 6.2), (6, 1.6), (1.6, 6.2)],
            1.2,
            id="junction",
        ),
        pytest.param(
            four_rooms(),
            [(2.5, 2.5), (7.5, 2.5), (7.5, 7.5), (2.5, 7.5)],
            [(7.5, 7.5), (2.5, 7.5), (2.5, 2.5), (7.5, 2.5)],
            1.25,
            id="four rooms, opposite corners",
        ),
        pytest.param(
            box(8, 8),
            [(4 + 3 * np.cos(a), 4 + 3 * np.sin(a)) for a in np.arange(8) * np.pi / 4],
            [(4 - 3 * np.cos(a), 4 - 3 * np.sin(a)) for a in np.arange(8) * np.pi / 4],
            1.5,
            id="eight across a circle",
        ),
    ],
)
def test_robots_exchange_places_without_contact_and_without_much_delay(
    solid: NDArray[np.bool_],
    starts: list[Point],
    goals: list[Point],
    bound: float,
) -> None:
    traffic = Traffic(solid, starts)
    times, ideal = traffic.drive(dict(enumerate(goals)), limit=80.0)
    assert len(times) == len(goals)
    assert traffic.bodies.collisions.sum() == 0
    assert traffic.bodies.min_clearance.min() > 0.02
    assert np.mean([times[i] / ideal[i] for i in times]) <= bound


@pytest.mark.parametrize(("solid", "n", "seconds"), [(four_rooms(), 4, 300.0), (two_rooms(), 3, 100.0)])
def test_robots_with_random_goals_never_touch_and_hold_nobody_up_for_long(
    solid: NDArray[np.bool_], n: int, seconds: float
) -> None:
    traffic, ratio, worst = random_traffic(solid, n, seconds, seed=7)
    assert traffic.bodies.collisions.sum() == 0
    assert traffic.bodies.min_clearance.min() > 0.02
    assert ratio <= 1.3
    assert worst <= 30.0


def packed(n: int, apart: float) -> list[Point]:
    """Places in the left one of two rooms, so far apart."""
    return [(1.0 + apart * (k % 5), 1.6 + apart * (k // 5)) for k in range(n)]


def gap(width: int) -> NDArray[np.bool_]:
    """Two rooms with a gap of so many cells in the wall between them."""
    solid = two_rooms()
    solid[:, 44:46] = True
    solid[30 - width // 2 : 30 - width // 2 + width, 44:46] = False
    return solid


@pytest.mark.parametrize(
    ("solid", "starts", "seconds"),
    [
        pytest.param(two_rooms(), packed(16, 0.7), 40, id="sixteen at ease"),
        pytest.param(two_rooms(), packed(24, 0.5), 60, id="twenty-four in a heap"),
        pytest.param(gap(5), packed(12, 0.7), 40, id="twelve before a gap of half a metre"),
    ],
)
def test_a_crowd_leaves_by_a_door_at_three_seconds_a_robot(
    solid: NDArray[np.bool_], starts: list[Point], seconds: float
) -> None:
    beyond = [(5.5 + 0.6 * (k % 5), 1.2 + 0.8 * (k // 5)) for k in range(len(starts))]
    traffic = Traffic(solid, starts)
    times, _ = traffic.drive(dict(enumerate(beyond)), limit=seconds)
    assert len(times) == len(starts)
    assert traffic.bodies.collisions.sum() == 0


def spaced(world: World, traffic: Traffic, n: int, apart: float, rng: np.random.Generator) -> list[Point]:
    """Random places, so far apart, 8 to 15 m of way from the first robot's start."""
    ways = distance_field(traffic.open, traffic.cell(*traffic.starts[0]), RESOLUTION)
    places: list[Point] = []
    for cell in rng.permutation(np.flatnonzero((ways > 8.0) & (ways < 15.0) & inflated(world.solid, 0.3))):
        x, y = world.frame.centres(np.array([cell]))[0].tolist()
        if all(np.hypot(x - u, y - v) > apart for u, v in places):
            places.append((x, y))
    return places[:n]


@pytest.mark.parametrize("seed", [0, 1])
def test_twenty_robots_all_leave_the_furnished_room_that_they_start_in(seed: int) -> None:
    world = office(np.random.default_rng(seed))
    team = [PlatformSpec(name=str(k)) for k in range(20)]
    starts = choose_starts(world, team, np.random.default_rng([seed, 1]))
    traffic = Traffic(world.solid, [(x, y) for x, y, _ in starts.tolist()])
    goals = spaced(world, traffic, 20, 0.6, np.random.default_rng(seed))
    times, _ = traffic.drive(dict(enumerate(goals)), limit=75.0)
    assert len(times) == 20
    assert traffic.bodies.collisions.sum() == 0


@pytest.mark.parametrize("seed", range(5))
def test_of_a_crowd_before_a_door_somebody_waits_for_nobody_and_no_two_wait_for_each_other(seed: int) -> None:
    rng = np.random.default_rng(seed)
    traffic = Traffic(two_rooms(), [(x, y) for x, y in rng.uniform((2.5, 1.5), (4.0, 4.5), (9, 2))])
    crowd = []
    for i in range(traffic.n):
        traffic.send(i, (7.0, 3.0))
        crowd.append(traffic.intent(i, traffic.route(i, traffic.open, traffic.fields[i])))
    waits = np.array(
        [[a is not b and queues(traffic.open, RESOLUTION, a, [b]) for b in crowd] for a in crowd]
    )
    assert waits.any()
    assert not (waits & waits.T).any()
    first = crowd[int(np.argmin([abs(a.x - 4.4) + abs(a.y - 3.05) for a in crowd]))]
    order = np.linalg.matrix_power(waits.astype(int), traffic.n)
    assert not order.any()  # nobody waits, by way of others, for itself
    assert first in [a for a, row in zip(crowd, waits, strict=True) if not row.any()]


@pytest.mark.parametrize("moving", [0, 1])
def test_a_robot_standing_in_a_door_makes_room_whatever_its_priority(moving: int) -> None:
    starts = [(4.5, 3.0), (4.5, 3.0)]
    starts[moving] = (1.5, 3.0)
    traffic = Traffic(two_rooms(), starts)
    times, ideal = traffic.drive({moving: (7.5, 3.0)}, limit=40.0)
    assert times[moving] <= 1.2 * ideal[moving]
    assert traffic.bodies.collisions.sum() == 0


def test_the_earlier_robot_gives_way_to_one_that_has_no_other_way_out() -> None:
    solid = corridor(0.9)
    solid[:, 100:] = True  # a dead end
    traffic = Traffic(solid, [(1.5, 2.0), (8.0, 2.0)])
    times, _ = traffic.drive({0: (8.5, 2.0), 1: (1.5, 1.0)}, limit=90.0)
    assert set(times) == {0, 1}
    assert traffic.bodies.collisions.sum() == 0


def test_a_dead_robot_in_one_of_two_doors_is_driven_around() -> None:
    solid = two_rooms()
    solid[8:17, 44:46] = False
    traffic = Traffic(solid, [(1.5, 3.0), (4.5, 3.0)])
    traffic.bodies.kill(1)
    times, _ = traffic.drive({0: (7.5, 3.0)}, limit=60.0)
    assert 0 in times
    assert traffic.bodies.collisions.sum() == 0


def test_block_discs_clears_exactly_the_cells_whose_centre_lies_in_a_disc() -> None:
    open_ = np.ones((40, 50), dtype=np.bool_)
    discs = [(1.0, 1.0, 0.5), (4.9, 3.9, 0.33), (-0.1, 2.0, 0.4), (9.0, 9.0, 0.5)]
    free = block_discs(open_, RESOLUTION, discs)
    for row in range(40):
        for col in range(50):
            x, y = (col + 0.5) * RESOLUTION, (row + 0.5) * RESOLUTION
            assert free[row, col] == all(np.hypot(x - a, y - b) >= r for a, b, r in discs)
    assert open_.all()


def test_where_no_ground_is_known_there_is_no_refuge() -> None:
    nothing = np.zeros((0, 0), np.bool_)
    me = Intent(1, 3.0, 5.0, np.array([(3.0, 5.0), (6.0, 5.0)]))
    mate = Intent(0, 6.0, 5.0, np.array([(6.0, 5.0), (3.0, 5.0)]))
    assert refuge(nothing, RESOLUTION, me, mate, [], 0.0) is None
    assert retreat(nothing, RESOLUTION, me, mate.path, [mate]) is None


def test_in_the_open_nobody_gives_way() -> None:
    open_ = inflated(box(10, 10))
    me = Intent(1, 3.0, 5.0, np.array([(3.0, 5.0), (6.0, 5.0)]))
    mate = Intent(0, 6.0, 5.0, np.array([(6.0, 5.0), (3.0, 5.0)]))
    assert give_way(open_, RESOLUTION, me, [mate]) is None


def test_before_a_door_only_the_later_robot_gives_way_and_its_refuge_is_clear_of_the_other_s_path() -> None:
    open_ = inflated(two_rooms())
    east = np.column_stack((np.linspace(3.0, 6.0, 16), np.full(16, 3.05)))
    first, second = Intent(0, 3.0, 3.05, east), Intent(1, 6.0, 3.05, east[::-1])
    assert give_way(open_, RESOLUTION, first, [second]) is None
    path = give_way(open_, RESOLUTION, second, [first])
    assert path is not None
    assert path[0] == pytest.approx((6.0, 3.05))
    assert np.hypot(*(east - path[-1]).T).min() >= 0.2 + 0.2 + 0.1


def test_two_robots_that_go_the_same_way_through_a_door_do_not_give_way() -> None:
    open_ = inflated(two_rooms())
    path = np.column_stack((np.linspace(3.0, 6.0, 16), np.full(16, 3.05)))
    leader, follower = Intent(0, 3.6, 3.05, path[3:]), Intent(1, 3.0, 3.05, path)
    assert give_way(open_, RESOLUTION, leader, [follower]) is None
    assert give_way(open_, RESOLUTION, follower, [leader]) is None


def test_a_robot_that_stands_does_not_make_room_for_one_that_has_arrived() -> None:
    open_ = inflated(two_rooms())
    me = Intent(1, 4.43, 3.05, EMPTY)
    arrived = Intent(0, 4.0, 3.05, np.array([(4.0, 3.05)]))
    assert give_way(open_, RESOLUTION, me, [arrived]) is None
    goes_on = replace(arrived, path=np.array([(4.0, 3.05), (6.0, 3.05)]))
    assert give_way(open_, RESOLUTION, me, [goes_on]) is not None
