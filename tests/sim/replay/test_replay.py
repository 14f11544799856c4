"""A log that goes through agents gives what it saw: once, wholly, and the same map however it is cut."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.commands import Command, refused
from tests.support.recordings import carmen_log, flaser, ranges_from
from vedette.errors import InputError
from vedette.logs import RecordedLog, read_carmen
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame, read_map
from vedette.maps.world import World
from vedette.record.replay.summary import Replayed, ReplayedBuilding
from vedette.sim.replay.run import Replay, ReplaySetup
from vedette.sim.worlds import maze


@pytest.fixture(scope="module")
def building() -> World:
    return maze(np.random.default_rng(4), 12.0, 10.0)


@pytest.fixture(scope="module")
def recorded(building: World, tmp_path_factory: pytest.TempPathFactory) -> RecordedLog:
    path = tmp_path_factory.mktemp("logs") / "maze.log"
    path.write_text(carmen_log(building))
    return read_carmen(path)


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys)


def truth(world: World, replayed: Replayed) -> NDArray[np.uint8]:
    """The true classes of the replayed map's cells."""
    frame, other = replayed.frame, world.frame
    rows = round((frame.origin_y - other.origin_y) / 0.1) + np.arange(frame.rows)
    cols = round((frame.origin_x - other.origin_x) / 0.1) + np.arange(frame.cols)
    padded = np.pad(world.classes(), 60, constant_values=OCCUPIED)
    return padded[np.ix_(rows + 60, cols + 60)]


@pytest.mark.parametrize(("robots", "planner"), [(1, "tours"), (3, "tours"), (3, "predicted")])
def test_the_map_is_that_of_the_building_and_everybody_has_it(
    building: World, recorded: RecordedLog, robots: int, planner: str
) -> None:
    replayed = Replay(recorded, ReplaySetup(robots, planner=planner)).run()
    known = replayed.classes != UNKNOWN
    assert (replayed.sights, replayed.complete, replayed.agreed) == (len(recorded.scans), True, True)
    assert np.mean(replayed.classes[known] != truth(building, replayed)[known]) < 0.03
    assert np.count_nonzero(replayed.classes == FREE) > 0.97 * np.count_nonzero(~building.solid)
    assert replayed.known_m2[-1] == pytest.approx(np.count_nonzero(known) * 0.01)


def test_however_a_log_is_cut_and_whatever_is_lost_the_map_is_the_same(recorded: RecordedLog) -> None:
    whole = Replay(recorded, ReplaySetup()).run().classes
    for setup in (ReplaySetup(2), ReplaySetup(5, link_loss=0.3, seed=1)):
        replayed = Replay(recorded, setup).run()
        assert replayed.agreed
        assert np.mean(replayed.classes != whole) < 0.002  # where a robot's evidence is at its limit


def test_the_same_log_gives_the_same_bytes(recorded: RecordedLog) -> None:
    one, other = (Replay(recorded, ReplaySetup(2, link_loss=0.2, seed=3)).run() for _ in range(2))
    np.testing.assert_array_equal(one.classes, other.classes)
    np.testing.assert_array_equal(one.counts, other.counts)
    assert one.known_m2 == other.known_m2


def test_where_nothing_hides_anything_every_cell_that_was_tried_was_seen(tmp_path: Path) -> None:
    solid = np.zeros((140, 140), bool)
    solid[[0, -1]] = solid[:, [0, -1]] = True
    hall = World(GridFrame(0.1, 140, 140), solid, "hall")
    angles = np.radians(np.arange(-90.0, 90.0, 0.5))
    places = [(x, 7.05, heading) for x in (4.05, 7.05, 9.05) for heading in (0.0, np.pi)]
    lines = [
        flaser(ranges_from(hall, *at, angles, 12.0).tolist(), *at, float(k)) for k, at in enumerate(places)
    ]
    path = tmp_path / "hall.log"
    path.write_text("\n".join(lines))
    tried, seen, *_ = Replay(read_carmen(path), ReplaySetup(reach=2.0)).run().counts
    assert tried[:7].min() > 100
    np.testing.assert_array_equal(seen[:8], tried[:8])
    assert tried[8:].sum() == 0  # nothing beyond the range


def test_shares_are_as_many_scans_each_in_order(recorded: RecordedLog) -> None:
    shares = ReplaySetup(4).shares(recorded)
    assert [scan for share in shares for scan in share] == list(recorded.scans)
    sizes = [len(share) for share in shares]
    assert max(sizes) - min(sizes) <= 1
    with pytest.raises(InputError, match="too few for 64 robots"):
        ReplaySetup(64).shares(RecordedLog("short", recorded.scans[:100], 8.0))


def test_a_replay_that_is_stopped_says_how_far_it_came(recorded: RecordedLog) -> None:
    replay = Replay(recorded, ReplaySetup())
    replayed = replay.run(lambda share: replay.stop() if share > 0.3 else None)
    assert not replayed.complete
    assert 0.2 < replayed.sights / replayed.of_sights < 0.4
    assert ReplayedBuilding.of(replayed).complete is False


def test_the_command_leaves_maps_pictures_and_figures(
    vedette: Command, building: World, tmp_path: Path
) -> None:
    for name in ("east", "west"):
        (tmp_path / f"{name}.log").write_text(carmen_log(building, 2.0))
    ran = vedette("replay", "east.log", "west.log", "--robots", 2, "--out", "out")
    assert ran.status == 0
    assert "east: " in ran.out
    assert "2 robots, all of one map" in ran.out
    left = {path.name for path in (tmp_path / "out").iterdir()}
    maps = {f"{name}.{ending}" for name in ("east", "west") for ending in ("yaml", "pgm", "png")}
    assert left == {"summary.json", "observation.png", *maps}
    east, west = json.loads((tmp_path / "out" / "summary.json").read_text())["buildings"]
    assert (east["log"], west["log"]) == ("east", "west")
    assert east["observation"] == west["observation"]
    _, classes = read_map(tmp_path / "out" / "east.yaml")
    assert np.count_nonzero(classes == FREE) * 0.01 == pytest.approx(east["free_m2"])


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("a.log", "b/a.log"), "two logs are called a; their maps would be one file: replay them apart"),
        (("observation.log",), "a log called observation would have the picture of what all logs' scans see"),
        (("a.log", "--robots", "40"), "too few for 40 robots"),
        (("nowhere.log",), "cannot read log nowhere.log: No such file"),
        (("a.log", "--resolution", "3"), "resolution of a world must be 0.02 to 0.2 m; got 3"),
        (("a.log", "--fusion", "chanel"), "did you mean 'channel'?"),
    ],
)
def test_bad_input_is_told_in_a_line_and_leaves_nothing(
    vedette: Command, building: World, tmp_path: Path, words: tuple[str, ...], told: str
) -> None:
    (tmp_path / "b").mkdir()
    for place in ("a.log", "b/a.log", "observation.log"):
        (tmp_path / place).write_text("\n".join(carmen_log(building, 4.0).splitlines()[:20]))
    refused(vedette("replay", *words, "--out", "out"), told)
    assert not (tmp_path / "out").exists()
