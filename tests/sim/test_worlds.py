"""Generated worlds are what they promise, whatever the seed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray

from vedette.cli.world import world as world_command
from vedette.errors import InputError
from vedette.kernels.components import components, largest
from vedette.maps import FREE, GridFrame, read_map, write_map
from vedette.maps.world import World, reachable_poses, standable
from vedette.sim.worlds import GENERATORS, cave, maze, office
from vedette.sim.worlds.floor_plan import draw_plan
from vedette.sim.worlds.size import WorldScale

SIZES = [(30.0, 20.0, 0.1), (20.0, 30.0, 0.1), (10.0, 10.0, 0.1), (40.0, 30.0, 0.2), (12.0, 11.0, 0.05)]


def flooded(cells: NDArray[np.bool_], start: tuple[int, int]) -> NDArray[np.bool_]:
    """Flood fill by a stack: the oracle of connectedness."""
    seen = np.zeros_like(cells)
    stack = [start]
    while stack:
        row, col = stack.pop()
        inside = 0 <= row < cells.shape[0] and 0 <= col < cells.shape[1]
        if inside and cells[row, col] and not seen[row, col]:
            seen[row, col] = True
            stack += [(row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)]
    return seen


def in_one_piece(cells: NDArray[np.bool_]) -> bool:
    row, col = np.argwhere(cells)[0]
    return bool((flooded(cells, (int(row), int(col))) == cells).all())


@pytest.mark.parametrize("seed", range(6))
def test_components_are_those_of_a_flood_fill(seed: int) -> None:
    rng = np.random.default_rng(seed)
    cells = rng.random(rng.integers(1, 25, size=2)) < rng.uniform(0.3, 0.8)
    labels = components(cells)
    assert ((labels >= 0) == cells).all()
    firsts = [int(np.flatnonzero(labels == label)[0]) for label in range(labels.max() + 1)]
    assert firsts == sorted(firsts)
    for label, first in enumerate(firsts):
        row, col = divmod(first, cells.shape[1])
        np.testing.assert_array_equal(labels == label, flooded(cells, (row, col)))
    assert largest(cells).sum() == max(np.bincount(labels[cells]), default=0)


@pytest.mark.parametrize("kind", sorted(GENERATORS))
def test_the_same_seed_gives_the_same_world_and_others_differ(kind: str) -> None:
    first, again, other = (GENERATORS[kind](np.random.default_rng(seed)).solid for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert first.shape == (200, 300)
    assert (first != other).mean() > 0.05


@pytest.mark.parametrize("seed", range(6))
def test_an_office_has_twelve_rooms_that_a_disc_of_a_quarter_metre_reaches(seed: int) -> None:
    made = office(np.random.default_rng(seed))
    plan = draw_plan(np.random.default_rng(seed), 200, 300, WorldScale(0.1))
    standing = standable(made, 0.25)
    assert len(plan.rooms) >= 12
    assert in_one_piece(standing)
    assert all(room.of(standing).any() for room in plan.rooms)
    claimed = np.zeros(made.frame.shape, np.int64)
    for room in (*plan.rooms, *plan.corridors):
        claimed[room.slices] += 1
        assert min(room.height, room.width) >= 15
    assert claimed.max() == 1
    furniture = made.solid & (claimed == 1)
    assert 0.05 < furniture.sum() / claimed.sum() < 0.3


@pytest.mark.parametrize("seed", range(6))
def test_every_office_door_is_nine_tenths_of_a_metre_wide_between_walls_at_most_two_thick(seed: int) -> None:
    made = office(np.random.default_rng(seed))
    plan = draw_plan(np.random.default_rng(seed), 200, 300, WorldScale(0.1))
    assert len(plan.doors) >= 10
    for door in plan.doors:
        solid = made.solid if door.height > door.width else made.solid.T
        upright = door if door.height > door.width else door.turned()
        assert upright.height == 9
        assert upright.width <= 2
        assert not upright.of(solid).any()
        for end in (upright.row - 1, upright.row_end):
            assert solid[end, upright.col : upright.col_end].all()
        for side in (upright.col - 1, upright.col_end):
            assert not solid[upright.row : upright.row_end, side].any()


@pytest.mark.parametrize(("width", "height", "resolution"), SIZES)
def test_an_office_of_any_size_is_closed_and_in_one_piece(
    width: float, height: float, resolution: float
) -> None:
    for seed in range(2):
        made = office(np.random.default_rng(seed), width, height, resolution)
        assert made.frame == GridFrame(resolution, round(height / resolution), round(width / resolution))
        assert in_one_piece(standable(made, 0.25))
        rim = (made.solid[0], made.solid[-1], made.solid[:, 0], made.solid[:, -1])
        assert all(side.all() for side in rim)


@pytest.mark.parametrize(("width", "height", "resolution"), SIZES)
def test_a_cave_is_what_a_disc_1_2_m_wide_sweeps_in_one_journey(
    width: float, height: float, resolution: float
) -> None:
    for seed in range(2):
        made = cave(np.random.default_rng(seed), width, height, resolution)
        journey = np.argwhere(largest(standable(made, 0.6)))
        free = np.argwhere(~made.solid)
        assert 0.2 < len(free) / made.frame.size < 0.8
        for cell in free[:: max(1, len(free) // 100)]:
            gaps = np.maximum(np.abs(journey - cell) - 0.5, 0.0)  # from each place to the cell's square
            assert np.hypot(gaps[:, 0], gaps[:, 1]).min() * resolution < 0.6


@pytest.mark.parametrize(("width", "height", "resolution"), SIZES)
def test_a_maze_is_in_one_piece_for_a_disc_1_4_m_wide_and_has_loops(
    width: float, height: float, resolution: float
) -> None:
    for seed in range(2):
        made = maze(np.random.default_rng(seed), width, height, resolution)
        standing = standable(made, 0.7)
        assert in_one_piece(standing)
        assert (~made.solid).mean() > 0.75
    islands = components(np.pad(made.solid, 1, constant_values=True)).max()
    assert islands >= 1  # a loop goes round walls that do not touch the rim


@pytest.mark.parametrize("kind", sorted(GENERATORS))
@pytest.mark.parametrize(
    "sizes",
    [{"width": 5.0}, {"height": float("nan")}, {"resolution": 0.5}, {"width": 400.0, "resolution": 0.02}],
)
def test_a_size_out_of_range_is_bad_input(kind: str, sizes: dict[str, float]) -> None:
    with pytest.raises(InputError, match=r"must be|too many"):
        GENERATORS[kind](np.random.default_rng(0), **sizes)


def test_a_world_is_solid_where_the_map_is_occupied_or_unknown(tmp_path: Path) -> None:
    classes = np.array([[0, 1, 2], [1, 1, 0]], np.uint8)
    write_map(tmp_path / "m", GridFrame(0.1, 2, 3, 5.0, 6.0), classes)
    made = World.from_map(tmp_path / "m.yaml")
    np.testing.assert_array_equal(made.solid, classes != FREE)
    assert made.name == "m"
    assert World.from_map(tmp_path / "m.yaml", 0.2).frame == GridFrame(0.2, 2, 3, 5.0, 6.0)


def test_a_map_without_free_space_is_bad_input(tmp_path: Path) -> None:
    write_map(tmp_path / "full", GridFrame(0.1, 2, 2), np.full((2, 2), 2, np.uint8))
    with pytest.raises(InputError, match="no free space"):
        World.from_map(tmp_path / "full.yaml")


def test_reachable_poses_are_those_a_flood_fill_of_standable_cells_reaches() -> None:
    solid = np.zeros((30, 60), np.bool_)
    solid[:, 20] = True
    solid[10:19, 20] = False  # a 0.9 m door
    solid[:, 40] = True
    solid[10:15, 40] = False  # a 0.5 m gap
    made = World(GridFrame(0.1, 30, 60, -1.0, 2.0), solid, "three rooms")
    for radius, rooms in ((0.2, 3), (0.3, 2), (0.5, 1)):
        reached = reachable_poses(made, radius, -0.2, 3.4)
        np.testing.assert_array_equal(reached, flooded(standable(made, radius), (14, 8)))
        assert [bool(reached[:, col].any()) for col in (10, 30, 50)].count(True) == rooms


def test_the_command_writes_a_map_that_reads_back_and_the_same_again(tmp_path: Path) -> None:
    for name in ("a", "b"):
        arguments = ["office", "--seed", "3", "--out", str(tmp_path / name)]
        result = CliRunner().invoke(world_command, arguments, catch_exceptions=False)
        assert result.exit_code == 0
        assert "office, seed 3: 30 x 20 m" in result.output
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == ["map.pgm", "map.yaml", "preview.png"]
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()
    expected = office(np.random.default_rng(3)).solid
    np.testing.assert_array_equal(read_map(tmp_path / "a" / "map.yaml")[1] != FREE, expected)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["ofice", "--out", "{}/new"], "did you mean 'office'"),
        (["maze", "--out", "{}"], "--force"),
        (["maze", "--out", "{}/new", "--resolution", "nan"], "resolution"),
        (["cave", "--out", "{}/new", "--width", "1e9"], "width"),
    ],
)
def test_the_commands_bad_input_leaves_nothing_behind(
    tmp_path: Path, arguments: list[str], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        CliRunner().invoke(
            world_command, [text.format(tmp_path) for text in arguments], catch_exceptions=False
        )
    assert list(tmp_path.iterdir()) == []
