"""A world made of a log is the building in which the log was recorded."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from tests.support.places import ROOT
from tests.support.recordings import carmen_log
from vedette.cli.world import world as world_command
from vedette.errors import InputError
from vedette.kernels.visibility import visible_cells
from vedette.logs import read_carmen
from vedette.maps import read_map
from vedette.maps.world import World
from vedette.sim.worlds import cave, logged, maze

LOGS = Path(os.environ.get("LOGS", ROOT.parent / "shared" / "logs"))


def made_again(tmp_path: Path, world: World, no_return: str = "ignore", reach: float = 20.0) -> World:
    path = tmp_path / "somewhere.log"
    path.write_text(carmen_log(world))
    return logged(read_carmen(path), world.frame.resolution, reach, no_return)


def on_the_grid_of(world: World, made: World) -> np.ndarray:
    """Which of the world's cells are free in the other, both on one lattice."""
    frame, other = made.frame, world.frame
    row, col = round((frame.origin_y - other.origin_y) / 0.1), round((frame.origin_x - other.origin_x) / 0.1)
    free = np.zeros(other.shape, bool)
    rows, cols = (np.arange(frame.rows) + row, np.arange(frame.cols) + col)
    inside = np.ix_((rows >= 0) & (rows < other.rows), (cols >= 0) & (cols < other.cols))
    at = np.ix_(rows[(rows >= 0) & (rows < other.rows)], cols[(cols >= 0) & (cols < other.cols)])
    free[at] = ~made.solid[inside]
    return free


@pytest.mark.parametrize("make", [maze, cave])
def test_it_has_the_free_space_and_the_walls_of_the_building(make: object, tmp_path: Path) -> None:
    world: World = make(np.random.default_rng(4), 14.0, 12.0)  # type: ignore[operator]
    free = on_the_grid_of(world, made_again(tmp_path, world))
    assert np.mean(free[~world.solid]) > 0.97
    assert np.mean(free[world.solid]) < 0.02


def test_beams_that_do_not_come_back_say_nothing_or_that_the_way_is_free(tmp_path: Path) -> None:
    solid = np.zeros((300, 300), bool)  # a yard wider than the lidar sees
    solid[[0, -1]] = solid[:, [0, -1]] = True
    solid[100:120, 100:120] = True
    world = World(maze(np.random.default_rng(0), 30.0, 30.0).frame, solid, "yard")
    path = tmp_path / "yard.log"
    path.write_text("\n".join(carmen_log(world, 15.0).splitlines()))
    log = read_carmen(path)
    ignoring, freeing = (logged(log, 0.1, 8.0, how) for how in ("ignore", "free"))
    places = np.zeros(solid.shape, bool)
    for scan in log.scans:
        places[world.frame.cell(scan.x, scan.y)] = True
    seen = visible_cells(solid, places, 80.0) & ~solid
    assert np.mean(on_the_grid_of(world, freeing)[seen]) > 3 * np.mean(on_the_grid_of(world, ignoring)[seen])


def test_a_log_too_wide_or_too_fine_is_refused(tmp_path: Path) -> None:
    world = maze(np.random.default_rng(1), 10.0, 10.0)
    path = tmp_path / "far.log"
    text = carmen_log(world, 5.0)
    path.write_text(text + "FLASER 1 1 9000 0 0 0 0 0 0 h 0\n")
    with pytest.raises(InputError, match="cells are too many, at most 8000 a side"):
        logged(read_carmen(path), 0.1, 20.0, "ignore")
    path.write_text(text)
    with pytest.raises(InputError, match=r"resolution of a world must be 0.02 to 0.2 m; got 0.001"):
        logged(read_carmen(path), 0.001, 20.0, "ignore")


def test_the_command_writes_a_map_that_a_team_can_explore(tmp_path: Path) -> None:
    path = tmp_path / "hall.log"
    path.write_text(carmen_log(maze(np.random.default_rng(4), 10.0, 10.0)))
    ran = CliRunner().invoke(world_command, ["log", str(path), "--out", str(tmp_path / "hall")])
    assert (ran.exit_code, ran.output[:5]) == (0, "hall:")
    frame, classes = read_map(tmp_path / "hall" / "map.yaml")
    made = logged(read_carmen(path), 0.1, 20.0, "ignore")
    assert frame.shape == made.frame.shape
    np.testing.assert_array_equal(classes == 1, ~made.solid)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("log",), "vedette world log needs a FILE"),
        (("office", "a.log"), "office is generated, without a file; of a recording: vedette world log a.log"),
        (("log", "a.log", "--seed", "3"), "--seed is of generated worlds; leave it out"),
        (("cave", "--range", "3"), "--range is of recordings; leave it out"),
    ],
)
def test_what_does_not_go_together_is_refused(words: tuple[str, ...], told: str, tmp_path: Path) -> None:
    ran = CliRunner().invoke(world_command, [*words, "--out", str(tmp_path / "out")])
    assert isinstance(ran.exception, InputError)
    assert told in str(ran.exception)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "free", "size"),
    [
        ("intel", 520.0, (39.7, 37.1)),
        ("freiburg-079", 391.0, (45.7, 17.5)),
        ("csail", 900.0, (57.4, 79.7)),
        ("infinite-corridor", 4140.0, (249.5, 235.5)),
    ],
)
def test_real_buildings_have_the_size_that_their_logs_were_recorded_in(
    name: str, free: float, size: tuple[float, float]
) -> None:
    path = LOGS / f"{name}.log.gz"
    if not path.exists():
        pytest.skip(f"no {path.name} in {LOGS}")
    world = logged(read_carmen(path), 0.1, 20.0, "ignore")
    assert (~world.solid).sum() * 0.01 == pytest.approx(free, rel=0.02)
    assert (world.frame.cols * 0.1, world.frame.rows * 0.1) == pytest.approx(size, abs=0.2)
