"""Robots start where they fit, together, and able to reach each other."""

from __future__ import annotations

import math

import numpy as np
import pytest

from vedette.errors import InputError
from vedette.kernels.components import largest
from vedette.kernels.distance import distance_field
from vedette.maps import GridFrame
from vedette.maps.world import World, reachable_poses, standable
from vedette.sim.indoors import indoors
from vedette.sim.starts import choose_starts, clearance, parse_starts
from vedette.sim.worlds import GENERATORS, office
from vedette.team import PlatformSpec


def spec(number: int, start: tuple[float, ...] | None = None, radius: float = 0.2) -> PlatformSpec:
    return PlatformSpec(name=f"robot-{number}", radius=radius, start=start)


def two_rooms() -> World:
    """4 x 2 m and 2 x 2 m, without a door between; origin (10, 20)."""
    solid = np.zeros((20, 61), np.bool_)
    solid[:, 40] = True
    return World(GridFrame(0.1, 20, 61, 10.0, 20.0), solid, "two rooms")


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_starts_are_read_with_and_without_heading() -> None:
    assert parse_starts("1,2; -3.5,4e0,90;") == [(1.0, 2.0), (-3.5, 4.0, 90.0)]


@pytest.mark.parametrize("text", ["", "1", "1,2,3,4", "a,b", "1,nan", "1,2;;3,4", "1;2", "1,inf"])
def test_unreadable_starts_are_one_line(text: str) -> None:
    with pytest.raises(InputError, match=r"--starts: entry \d must be"):
        parse_starts(text)


def test_given_starts_are_kept_and_headings_turned_to_radians() -> None:
    starts = choose_starts(two_rooms(), [spec(1, (11.0, 21.0, 90.0)), spec(2, (12.0, 21.0))], rng())
    np.testing.assert_allclose(starts, [[11.0, 21.0, math.pi / 2], [12.0, 21.0, 0.0]])


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("count", [1, 3, 6, 20])
def test_a_team_starts_together_in_one_area_clear_of_walls_and_each_other(seed: int, count: int) -> None:
    world = office(rng(seed))
    specs = [spec(i + 1) for i in range(count)]
    starts = choose_starts(world, specs, rng(seed))
    np.testing.assert_array_equal(starts, choose_starts(world, specs, rng(seed)))
    area = reachable_poses(world, 0.2, starts[0, 0], starts[0, 1])
    for x, y, heading in starts:
        assert clearance(world, x, y, 1.0) >= 0.2 - 1e-9
        assert area[world.frame.cell(x, y)]
        assert heading == 0.0
    apart = np.hypot(*(starts[:, None, :2] - starts[None, :, :2]).transpose(2, 0, 1))
    np.fill_diagonal(apart, np.inf)
    if count > 1:
        assert apart.min() >= 0.7 - 1e-5
    if count <= 6:
        assert apart.min(axis=1).max(initial=0.0, where=np.isfinite(apart.min(axis=1))) < 1.3


def test_the_others_join_the_first_given_start() -> None:
    starts = choose_starts(two_rooms(), [spec(1), spec(2, (15.0, 21.0)), spec(3)], rng())
    assert (starts[:, 0] > 14.1).all()
    assert np.hypot(*(starts[[0, 2], :2] - starts[1, :2]).T).max() < 1.0


def test_without_a_given_start_the_larger_area_is_chosen() -> None:
    for seed in range(10):
        assert (choose_starts(two_rooms(), [spec(1), spec(2)], rng(seed))[:, 0] < 14.0).all()


def building(door: int) -> World:
    """A room of 4 x 3 m, its door so many cells wide, and a shed of 2 m², on open ground of 12 x 12 m."""
    solid = np.zeros((120, 120), np.bool_)
    for row, col, rows, cols in ((40, 30, 31, 41), (90, 90, 15, 21)):
        solid[row : row + rows, col : col + cols] = True
        solid[row + 1 : row + rows - 1, col + 1 : col + cols - 1] = False
    solid[40, 50 : 50 + door] = False
    return World(GridFrame(0.1, 120, 120), solid, "house")


@pytest.mark.parametrize("door", [0, 1, 9])
def test_a_team_starts_inside_though_the_map_calls_the_outside_free(door: int) -> None:
    world = building(door)
    inside = np.zeros_like(world.solid)
    inside[41:70, 31:70] = True
    assert (indoors(world, 0.2) <= inside).all()
    assert (
        indoors(world, 0.2).sum() > (0.8 if door > 1 else 0.999) * 25 * 35
    )  # not where the door is opposite
    for seed in range(10):
        starts = choose_starts(world, [spec(i + 1) for i in range(3)], rng(seed))
        assert all(inside[world.frame.cell(x, y)] for x, y, _ in starts)


def test_where_nothing_is_between_walls_a_team_starts_in_the_largest_area() -> None:
    solid = np.zeros((30, 40), np.bool_)
    solid[:, 10] = True
    world = World(GridFrame(0.1, 30, 40), solid, "fence")
    np.testing.assert_array_equal(indoors(world, 0.2), largest(standable(world, 0.2)))
    assert indoors(world, 0.2)[:, 11:].any()


@pytest.mark.parametrize("kind", GENERATORS)
@pytest.mark.parametrize("radius", [0.1, 0.2, 0.35])
def test_in_a_generated_world_the_largest_area_is_indoors(kind: str, radius: float) -> None:
    for seed in range(3):
        world = GENERATORS[kind](rng(seed), 20.0, 15.0, 0.1)
        np.testing.assert_array_equal(indoors(world, radius), largest(standable(world, radius)))


def test_a_team_of_many_sizes_fits_each_to_its_own_radius() -> None:
    world = office(rng(1))
    specs = [spec(1, radius=0.1), spec(2, radius=0.3), spec(3, radius=0.2), spec(4, radius=0.3)]
    starts = choose_starts(world, specs, rng())
    for i, (x, y, _) in enumerate(starts):
        assert clearance(world, x, y, 1.0) >= specs[i].radius - 1e-9
        for j in range(i):
            assert math.dist(starts[i, :2], starts[j, :2]) >= specs[i].radius + specs[j].radius + 0.1 - 1e-5


def test_a_team_takes_the_places_nearest_by_path_however_far_the_path_leads() -> None:
    """In halls side by side, with doors at alternating ends, what is near straight across is far by path."""
    solid = np.zeros((330, 200), np.bool_)
    for hall in range(1, 6):
        solid[55 * hall] = True
        solid[55 * hall, 2:14] = hall % 2 == 0
        solid[55 * hall, -14:-2] = hall % 2 == 1
    world = World(GridFrame(0.1, 330, 200), solid, "halls")
    specs = [spec(0, (10.0, 2.75), radius=0.5), *(spec(i, radius=0.5) for i in range(1, 160))]
    starts = choose_starts(world, specs, rng())
    field = distance_field(standable(world, 0.5), world.frame.flat(10.0, 2.75), 0.1).ravel()
    order = np.argsort(np.where(standable(world, 0.5).ravel(), field, np.inf), kind="stable")
    places = world.frame.centres(order)
    apart = np.hypot(*(places - starts[0, :2]).T)  # from the nearest that is taken
    for start in starts[1:, :2]:
        place = places[np.argmax(apart >= 1.3 - 1e-6)]
        np.testing.assert_array_equal(start, place)
        apart = np.minimum(apart, np.hypot(*(places - place).T))
    assert np.ptp(starts[:, 1]) > 13.0


@pytest.mark.parametrize(
    ("specs", "message"),
    [
        (
            [spec(1, (9.0, 21.0))],
            "robot-1: start 9,21 is outside the map; x is 10 to 16.1 m, y is 20 to 22 m",
        ),
        ([spec(1, (14.05, 21.0))], "is in a wall; the nearest free place is 13.75,20.95"),
        ([spec(1, (11.0, 20.1))], "is 0.10 m from a wall, its radius is 0.2 m; the nearest free place is"),
        ([spec(1, (11.0, 21.0), radius=1.5)], "nowhere in the map does a disc of radius 1.5 m fit"),
        ([spec(1, radius=1.5)], "nowhere in two rooms does a disc of radius 1.5 m fit"),
        (
            [spec(1, (11.0, 21.0)), spec(2, (11.4, 21.0))],
            "0.40 m from that of robot-1; keep them at least 0.45",
        ),
        ([spec(1, (11.0, 21.0)), spec(2, (11.0, 21.0))], "0.00 m from that of robot-1"),
        (
            [spec(1, (11.0, 21.0)), spec(2), spec(3, (15.0, 21.0))],
            "robot-3: start 15,21 is cut off; reachable from robot-1: x 10.2..13.8 m, y 20.2..21.8 m, 6 m2",
        ),
    ],
)
def test_a_bad_start_is_one_line_with_the_remedy(specs: list[PlatformSpec], message: str) -> None:
    with pytest.raises(InputError) as caught:
        choose_starts(two_rooms(), specs, rng())
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_too_many_robots_are_told_how_many_fit_and_that_many_do() -> None:
    with pytest.raises(InputError, match=r"100 robots do not fit in two rooms; only \d+ do") as caught:
        choose_starts(two_rooms(), [spec(i + 1) for i in range(100)], rng())
    fit = int(str(caught.value).split("only ")[1].split()[0])
    assert fit > 12
    assert len(choose_starts(two_rooms(), [spec(i + 1) for i in range(fit)], rng())) == fit


def test_a_start_that_just_fits_between_cell_centres_is_accepted() -> None:
    solid = np.ones((20, 20), np.bool_)
    solid[5:14, 5:14] = False
    world = World(GridFrame(0.1, 20, 20), solid, "box")
    assert choose_starts(world, [spec(1, (0.7, 0.7))], rng())[0, 0] == 0.7


def test_clearance_is_the_distance_to_the_nearest_solid_square_or_the_rim() -> None:
    generator = rng(5)
    for _ in range(50):
        solid = generator.random((8, 9)) < 0.2
        world = World(GridFrame(0.5, 8, 9, 1.0, -2.0), solid, "random")
        x, y = generator.uniform(1.0, 5.5), generator.uniform(-2.0, 2.0)
        padded = np.pad(solid, 1, constant_values=True)
        squares = [(1.0 + 0.5 * (c - 1), -2.0 + 0.5 * (r - 1)) for r, c in np.argwhere(padded)]
        brute = min(
            math.hypot(max(a - x, x - a - 0.5, 0.0), max(b - y, y - b - 0.5, 0.0)) for a, b in squares
        )
        assert clearance(world, x, y, 0.8) == pytest.approx(min(brute, 0.8), abs=1e-12)
