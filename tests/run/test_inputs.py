"""What cannot be is refused in one line before anything begins."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vedette import run
from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.maps.world import World
from vedette.team import PlatformSpec

FREE = np.zeros((20, 30), bool)
ROOM = (FREE, 0.1)
TWICE = [PlatformSpec("twin"), PlatformSpec("twin")]


@pytest.mark.parametrize(
    ("mission", "words"),
    [
        (lambda: run.explore("nowhere.yaml"), ["nowhere.yaml"]),
        (lambda: run.explore((np.ones((3, 3)), 0.1)), ["free space"]),
        (lambda: run.explore((np.zeros(9), 0.1)), ["(R, C)"]),
        (lambda: run.explore((FREE, 0.0)), ["resolution", "0.0"]),
        (lambda: run.explore(FREE), ["a world is"]),
        (lambda: run.explore(ROOM, 0), ["team"]),
        (lambda: run.explore(ROOM, TWICE), ["twin", "twice"]),
        (lambda: run.explore(ROOM, ["scout"]), ["scout", "PlatformSpec"]),
        (lambda: run.explore(ROOM, 1.5), ["1.5"]),
        (lambda: run.explore(ROOM, "none.yaml"), ["none.yaml"]),
        (lambda: run.explore(ROOM, seed=-1), ["seed", "-1"]),
        (lambda: run.explore(ROOM, planner="tuors"), ["tuors", "tours"]),
        (lambda: run.explore(ROOM, scheme="tokens"), ["tokens", "token"]),
        (lambda: run.explore(ROOM, fusion="both"), ["both", "replicated"]),
        (lambda: run.explore(ROOM, max_time=float("nan")), ["max_time"]),
        (lambda: run.explore(ROOM, kills=[(4, 1.0)]), ["no robot 4", "in a team of 3"]),
        (lambda: run.explore(ROOM, kills=[("robot-1", 1.0)]), ["kills", "robot-1"]),
        (lambda: run.explore(ROOM, radio="far"), ["far"]),
        (lambda: run.explore(ROOM, faults="none.yaml"), ["none.yaml"]),
        (lambda: run.explore(ROOM, link_loss=2.0), ["link_loss", "2"]),
        (lambda: run.track("none.yaml"), ["none.yaml"]),
        (lambda: run.track({"area": [0, 0, 9, 9]}), ["scenario", "vehicles"]),
        (lambda: run.track(coordination="alone"), ["alone", "none"]),
        (lambda: run.track(objective="entropy"), ["entropy", "final-entropy"]),
        (lambda: run.search({"cell": 32}), ["scenario", "area"]),
        (lambda: run.search(fusion="product"), ["product", "sums"]),
        (lambda: run.search(max_time="long"), ["max_time", "long"]),
    ],
)
def test_what_cannot_be_is_refused_in_a_line_that_names_it(
    mission: Callable[[], Any], words: list[str]
) -> None:
    with pytest.raises(InputError) as refused:
        mission()
    line = str(refused.value)
    assert "\n" not in line
    for word in words:
        assert word in line, line


def test_a_world_a_team_and_a_scenario_may_be_objects_or_files(tmp_path: Path) -> None:
    world = World(GridFrame(0.1, *FREE.shape), FREE, "room")
    specs = [PlatformSpec("robot-1"), PlatformSpec("robot-2")]
    file = tmp_path / "team.yaml"
    file.write_text("platforms: [{}, {}]\n")
    map_file = world.save(tmp_path)
    teams: list[Any] = [2, np.int64(2), specs, file, str(file)]
    worlds: list[Any] = [
        world,
        ROOM,
        (FREE.tolist(), 0.1),
        map_file,
        (str(map_file.with_suffix(".pgm")), 0.1),
    ]
    missions = [run.Explore(world, team, 1) for team in teams] + [run.Explore(each, 2, 1) for each in worlds]
    assert {mission.poses.tobytes() for mission in missions} == {missions[0].poses.tobytes()}
    assert {len(mission.poses) for mission in missions} == {2}
    example = Path(__file__).parents[2] / "examples" / "scenarios" / "track.yaml"
    assert np.array_equal(run.Track(example, 1).poses, run.Track(run.Track(example).scenario, 1).poses)


def test_files_that_a_mission_was_read_from_are_not_written_over(tmp_path: Path) -> None:
    world = World(GridFrame(0.1, *FREE.shape), FREE, "room").save(tmp_path)
    with pytest.raises(InputError, match=r"map\.yaml"):
        run.Explore(world, 1, record=tmp_path)
    mission = run.Explore(world, 1)
    mission.step(10)
    with pytest.raises(InputError, match=r"map\.yaml"):
        mission.result().save(tmp_path)


def test_importing_the_theory_loads_no_mission_and_importing_missions_draws_nothing() -> None:
    code = (
        "import sys, vedette; assert 'vedette.run' not in sys.modules\n"
        "from vedette import run; assert run.explore; assert 'matplotlib' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
