"""``vedette explore``: the files and the status of a run, and one clear line for whatever is wrong."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.support.commands import FILES, Command, check_files, refused, start
from tests.support.places import ROOT
from tests.support.small_missions import TWO_ROOMS, drawn
from vedette.maps import FREE, UNKNOWN, read_map


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command, run in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys)


@pytest.fixture(scope="session")
def world(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the map of two rooms."""
    folder = tmp_path_factory.mktemp("world")
    drawn(TWO_ROOMS).save(folder)
    return folder


# -- what a run leaves --------------------------------------------------------------------------------


def test_a_run_leaves_every_file_and_says_where_the_pictures_are(vedette: Command, world: Path) -> None:
    ran = vedette("explore", world / "map.yaml", "--robots", 2, "--out", "out")
    assert ran.status == 0, ran
    assert ran.err == ""
    assert "complete" in ran.out
    assert str(Path("out") / "progress.png") in ran.out
    check_files(Path("out"), "explore")
    assert {path.name for path in Path("out").iterdir()} == FILES["explore"]
    frame, classes = read_map(Path("out") / "map.yaml")
    true_frame, true_classes = read_map(world / "map.yaml")
    assert frame == true_frame
    known = classes != UNKNOWN
    assert np.mean(known[true_classes == FREE]) > 0.995
    assert np.mean(classes[known] == true_classes[known]) > 0.97
    summary = json.loads((Path("out") / "summary.json").read_text())
    assert summary["completed"] is True
    assert summary["world"] == world.name


def test_what_may_be_meant_otherwise_is_told_once_and_the_mission_goes_on(
    vedette: Command, tmp_path: Path
) -> None:
    """A room of 4 x 4 m on ground of grey 205, which free_thresh 0.25 makes free: the team starts inside."""
    pixels = np.full((120, 120), 205, np.uint8)
    pixels[39:81, 39:81] = 0
    pixels[40:80, 40:80] = 254
    Image.fromarray(pixels).save(tmp_path / "room.png")
    (tmp_path / "room.yaml").write_text(
        "{image: room.png, resolution: 0.1, origin: [0, 0, 0], occupied_thresh: 0.65, free_thresh: 0.25}"
    )
    ran = vedette("explore", "room.yaml", "--robots", 1, "--out", "out", "--json")
    assert ran.status == 0
    assert ran.err == (
        "vedette: room.yaml: free_thresh 0.25 makes grey 205 (12636 pixels) free, which map savers write for "
        "unknown; if it is unknown, set free_thresh to 0.196\n"
    )
    known = read_map(Path("out") / "map.yaml")[1] != UNKNOWN
    assert known[40:80, 40:80].mean() > 0.99
    assert not known[:38].any()


def test_robots_that_do_not_know_how_far_their_ground_goes_are_told_of_without_a_share(
    vedette: Command, world: Path
) -> None:
    options = "--unbounded", "--robots", 2, "--max-time", 4, "--out"  # all is seen after 7 s
    ran = vedette("explore", world / "map.yaml", *options, "out")
    summary = json.loads((Path("out") / "summary.json").read_text())
    assert (summary["coverage"], summary["t50_s"], summary["auc_s"]) == (None, None, None)
    assert summary["known_m2"] > 10.0
    assert summary["rate_m2_s"] == pytest.approx(summary["known_m2"] / summary["time_s"], rel=1e-3)
    assert summary["frontiers"] > 0
    assert f"{summary['known_m2']:.0f} m2 of " in ran.out
    assert "%" not in ran.out + ran.err
    assert f", {summary['frontiers']} frontiers left)" in ran.out


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--area", "0,0;4,0"), "area: 2 corners; a polygon has 3 to 1000"),
        (("--area", ""), "--area: '' must be x,y in m"),
        (("--area", "0,0;4,0;4;0,4"), "--area: '4' must be x,y in m"),
        (("--area", "0,0,1;4,0,1;4,4,1"), "--area: '0,0,1' must be x,y in m"),
        (("--area", "0,0;4,nan;4,4"), "area: corner [4, nan]; give metres within 2.1e+07"),
        (("--area", "0,0;1e9,0;4,4"), "area: corner [1e+09, 0]; give metres within 2.1e+07"),
        (
            ("--area", "1,1;3,3;2,2;4,4"),
            "area: all corners are on a line; give them in order round the ground",
        ),
        (("--area", "3,3;3,3;3,3"), "area: all corners are on a line; give them in order round the ground"),
        (("--area", "90,90;94,90;94,94"), "that is free lies in it; its corners are in m"),
        (("--area", "0,0;4,0;4,4", "--starts", "6,2"), "start 6,2 is not all within the area"),
        (
            ("--area", "0,0;9e5,0;9e5,9e5", "--unbounded"),
            "9000000 x 9000000 cells of 0.1 m; at most 67108864",
        ),
        (("--area", "5.01,5.01;5.04,5.01;5,5.04", "--unbounded"), "no cell of 0.1 m has its middle in it"),
    ],
)
def test_an_area_that_does_not_fit_is_told_in_one_line(
    vedette: Command, world: Path, options: tuple[str, ...], said: str
) -> None:
    refused(vedette("explore", world / "map.yaml", *options, "--out", "out"), said)
    assert not Path("out").exists()


@pytest.mark.parametrize("corner", [(448262.5, 5411932.25), (-19_999_000.03, 19_999_000.07)])
def test_a_mission_far_from_the_origin_goes_as_one_that_is_near(
    vedette: Command, world: Path, tmp_path: Path, corner: tuple[float, float]
) -> None:
    """Coordinates of UTM, and the farthest there are: nothing on the way loses the centimetres."""
    (tmp_path / "map.pgm").write_bytes((world / "map.pgm").read_bytes())
    (tmp_path / "map.yaml").write_text(f"{{image: map.pgm, resolution: 0.1, origin: {[*corner, 0.0]}}}")
    options = ("--robots", 2, "--link-loss", 0.1, "--return-home", "--json", "--out")
    near = json.loads(vedette("explore", world / "map.yaml", *options, "near").out)
    far = json.loads(vedette("explore", tmp_path / "map.yaml", *options, "far").out)
    assert far["outcome"] == "complete"
    assert far["collisions"] == 0
    assert far["coverage"] == pytest.approx(near["coverage"], abs=0.001)
    assert far["time_s"] == pytest.approx(near["time_s"], rel=0.1)
    frame, _ = read_map(Path("far") / "map.yaml")
    assert (frame.origin_x, frame.origin_y) == corner
    x_min, x_max, y_min, y_max = (f"{value:.2f}".rstrip("0") for value in frame.extent)
    ran = vedette("explore", tmp_path / "map.yaml", "--starts", f"{corner[0] + 90},{y_min}")
    assert f"{x_min} to {x_max} m, y is {y_min} to {y_max} m" in ran.err


def test_json_prints_the_summary_alone(vedette: Command, world: Path) -> None:
    ran = vedette("explore", world / "map.yaml", "--robots", 1, "--out", "out", "--json")
    assert (ran.status, ran.err) == (0, "")
    assert ran.out == (Path("out") / "summary.json").read_text()
    assert json.loads(ran.out)["schema_version"] == 3


def test_a_mission_that_runs_out_of_time_has_status_1_and_all_files(vedette: Command, world: Path) -> None:
    ran = vedette("explore", world / "map.yaml", "--out", "out", "--max-time", 3, "--json")
    assert ran.status == 1
    assert json.loads(ran.out)["outcome"] == "time_limit"
    check_files(Path("out"), "explore")


def test_a_team_that_dies_has_status_1_and_all_files(vedette: Command, world: Path) -> None:
    ran = vedette(
        "explore", world / "map.yaml", "--robots", 2, "--kill", "1@0", "--kill", "2@2.5", "--out", "out"
    )
    assert ran.status == 1
    assert "team lost" in ran.out
    check_files(Path("out"), "explore")


def test_without_out_each_run_gets_a_new_folder_under_runs(vedette: Command, world: Path) -> None:
    for _ in range(2):
        assert vedette("explore", world / "map.yaml", "--max-time", 1).status == 1
    assert sorted(path.name for path in Path("runs").iterdir()) == [f"{world.name}-001", f"{world.name}-002"]
    for folder in Path("runs").iterdir():
        check_files(folder, "explore")


def test_a_team_file_starts_and_options_reach_the_mission(vedette: Command, world: Path) -> None:
    Path("team.yaml").write_text("platforms: [{name: scout, speed: 1.0, range: 4}, {name: mule}, {}]")
    ran = vedette(
        "explore", world / "map.yaml", "--team", "team.yaml", "--robots", 2, "--starts", "1.5,1.5;5.5,1.5",
        "--planner", "nearest", "--scheme", "jacobi", "--fusion", "channel", "--seed", 4, "--json",
        "--max-time", 2, "--out", "out",
    )  # fmt: skip
    summary = json.loads(ran.out)
    assert list(summary["path_m"]) == ["scout", "mule"]
    assert (summary["planner"], summary["scheme"], summary["fusion"]) == ("nearest", "jacobi", "channel")
    assert summary["seed"] == 4


def test_an_image_with_a_resolution_is_a_map(vedette: Command, world: Path) -> None:
    Image.open(world / "map.pgm").save("plain.png")
    ran = vedette("explore", "plain.png", "--resolution", 0.1, "--max-time", 1, "--out", "out", "--json")
    assert ran.status == 1
    assert json.loads(ran.out)["world"] == "plain"


def test_force_writes_into_an_existing_folder(vedette: Command, world: Path) -> None:
    Path("out").mkdir()
    (Path("out") / "mine.txt").write_text("keep")
    assert vedette("explore", world / "map.yaml", "--max-time", 1, "--out", "out", "--force").status == 1
    assert (Path("out") / "mine.txt").read_text() == "keep"
    check_files(Path("out"), "explore")


def test_animate_adds_a_gif(vedette: Command, world: Path) -> None:
    assert vedette("explore", world / "map.yaml", "--max-time", 3, "--out", "out", "--animate").status == 1
    gifs = list(Path("out").glob("*.gif"))
    assert len(gifs) == 1
    with Image.open(gifs[0]) as image:
        assert image.format == "GIF"


def test_a_generated_world_is_a_map_to_explore(vedette: Command) -> None:
    made = vedette("world", "maze", "--seed", 3, "--width", 10, "--height", 10, "--out", "made")
    assert made.status == 0, made
    ran = vedette("explore", "made/map.yaml", "--max-time", 1, "--out", "out", "--json")
    assert ran.status == 1


@pytest.mark.parametrize("arguments", [["--help"], ["explore", "--help"], ["world", "-h"], ["--version"]])
def test_help_and_version_have_status_0(vedette: Command, arguments: list[str]) -> None:
    ran = vedette(*arguments)
    assert ran.status == 0
    assert ran.out


# -- bad input ----------------------------------------------------------------------------------------


def test_a_map_that_is_missing_or_a_folder_is_refused(vedette: Command, world: Path) -> None:
    refused(vedette("explore", "nowhere.yaml", "--out", "out"), "nowhere.yaml")
    refused(vedette("explore", "nowhere.png", "--resolution", 0.1, "--out", "out"), "nowhere.png")
    refused(vedette("explore", world, "--out", "out"), "folder")
    refused(vedette("explore", "", "--out", "out"))


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("text.yaml", b"just: text\n"),
        ("broken.yaml", b"image: [\n"),
        ("binary.yaml", bytes(range(256))),
        ("noimage.yaml", b"image: missing.pgm\nresolution: 0.1\n"),
        ("text.png", b"no picture at all"),
        ("empty.pgm", b""),
    ],
)
def test_a_file_that_is_no_map_is_refused(vedette: Command, name: str, content: bytes) -> None:
    Path(name).write_bytes(content)
    arguments = [] if name.endswith("yaml") else ["--resolution", "0.1"]
    refused(vedette("explore", name, "--out", "out", *arguments))


@pytest.mark.parametrize("resolution", ["0", "-0.1", "nan", "inf", "1e9", "1e-9", "wide", ""])
def test_a_resolution_that_makes_no_sense_is_refused(vedette: Command, world: Path, resolution: str) -> None:
    refused(vedette("explore", world / "map.pgm", f"--resolution={resolution}", "--out", "out"), "resolution")


def test_an_image_without_a_resolution_and_a_resolution_without_an_image_are_refused(
    vedette: Command, world: Path
) -> None:
    refused(vedette("explore", world / "map.pgm", "--out", "out"), "resolution", "map.yaml")
    refused(vedette("explore", "--resolution", 0.1, "--out", "out"), "--resolution")


def test_a_map_without_free_space_or_without_room_is_refused(vedette: Command, world: Path) -> None:
    Image.new("L", (50, 50), 0).save("black.png")
    refused(vedette("explore", "black.png", "--resolution", 0.1, "--out", "out"), "no free space")
    refused(vedette("explore", world / "map.yaml", "--robots", 500, "--out", "out"), "500 robots do not fit")
    Path("team.yaml").write_text("platforms: [{radius: 4.0}]\n")
    refused(vedette("explore", world / "map.yaml", "--team", "team.yaml", "--out", "out"), "4 m")


@pytest.mark.parametrize(
    ("starts", "words"),
    [
        ("0.1,0.1", ["in a wall", "nearest free place"]),
        ("100,100", ["outside", "x is 0 to 8 m"]),
        ("-1,1", ["outside"]),
        ("0.6,1.5", ["from a wall"]),
        ("1.5,1.5;1.5,1.5", ["robot-2", "apart"]),
        ("1.5", ["entry 1"]),
        ("1.5,nan", ["entry 1"]),
        ("1.5,a", ["entry 1"]),
        ("", ["entry 1"]),
        ("1.5,1.5;2.5,1.5;2.5,2.5;3.2,1.5", ["4 places for 3 robots"]),
    ],
)
def test_starts_that_are_not_possible_are_refused(
    vedette: Command, world: Path, starts: str, words: list[str]
) -> None:
    refused(
        vedette("explore", world / "map.yaml", "--robots", 3, f"--starts={starts}", "--out", "out"), *words
    )


def test_a_start_that_is_cut_off_is_refused_and_the_reachable_area_told(vedette: Command) -> None:
    drawn(TWO_ROOMS.replace("#              #", "#       #      #")).save(Path())
    ran = vedette("explore", "map.yaml", "--starts", "1.5,1.5;5.5,1.5", "--out", "out")
    refused(ran, "cut off", "reachable from robot-1", "m2")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--planner", "tuors"], ["planner", "tours"]),
        (["--scheme", "tokens"], ["scheme", "token"]),
        (["--fusion", "chanel"], ["fusion", "channel"]),
        (["--robots", "0"], ["--robots", "at least 1"]),
        (["--robots", "-2"], ["--robots"]),
        (["--robots", "two"], ["two"]),
        (["--kill", "4@10"], ["no robot 4", "in a team of 3"]),
        (["--kill", "0@10"], ["no robot 0"]),
        (["--kill", "2"], ["robot@seconds"]),
        (["--kill", "2@-5"], ["robot@seconds"]),
        (["--kill", "2@nan"], ["robot@seconds"]),
        (["--max-time", "0"], ["--max-time"]),
        (["--max-time", "nan"], ["--max-time"]),
        (["--link-delay", "-1"], ["--link-delay"]),
        (["--link-loss", "1.5"], ["--link-loss"]),
        (["--link-loss", "nan"], ["--link-loss"]),
        (["--seed", "-1"], ["--seed"]),
        (["--seed", "x"], ["x"]),
        (["--robot", "3"], ["--robot"]),
        (["--frobnicate"], ["--frobnicate"]),
        (["one-more-argument"], ["one-more-argument"]),
        (["--team", "missing.yaml"], ["missing.yaml"]),
    ],
)
def test_options_that_make_no_sense_are_refused(
    vedette: Command, world: Path, arguments: list[str], words: list[str]
) -> None:
    refused(vedette("explore", world / "map.yaml", "--out", "out", *arguments), *words)


@pytest.mark.parametrize(
    ("team", "words"),
    [
        ("platforms: [{sped: 1.0}]", ["sped", "speed"]),
        ("platfroms: [{}]", ["platfroms", "platforms"]),
        ("platforms: [{speed: fast}]", ["speed", "fast"]),
        ("platforms: []", ["a list under 'platforms:'", "at least one"]),
        ("platforms: [{}]", ["--robots is 2", "lists 1"]),
        ("platforms: [{name: a}, {name: a}]", ["used twice"]),
        ("platforms: [{start: [0.1, 0.1]}, {}]", ["in a wall"]),
    ],
)
def test_team_files_that_make_no_sense_are_refused(
    vedette: Command, world: Path, team: str, words: list[str]
) -> None:
    Path("team.yaml").write_text(team)
    ran = vedette("explore", world / "map.yaml", "--team", "team.yaml", "--robots", 2, "--out", "out")
    refused(ran, *words)


def test_an_existing_folder_is_refused_without_force_and_left_as_it_is(vedette: Command, world: Path) -> None:
    Path("there").mkdir()
    ran = vedette("explore", world / "map.yaml", "--out", "there")
    refused(ran, "there", "--force")
    assert list(Path("there").iterdir()) == []


def test_a_folder_that_cannot_be_made_is_refused(vedette: Command, world: Path) -> None:
    Path("file").write_text("")
    refused(vedette("explore", world / "map.yaml", "--out", "file/out"), "file")
    refused(vedette("explore", world / "map.yaml", "--out", "file"), "file")


def test_an_unknown_command_is_refused(vedette: Command) -> None:
    refused(vedette("explroe"), "explroe")


# -- interruption and determinism, in processes of their own --------------------------------------------


def test_ctrl_c_leaves_every_file_valid_and_has_status_130(tmp_path: Path) -> None:
    process = start(["explore", "--out", "out"], tmp_path)
    assert process.stdout is not None
    for line in process.stdout:
        if b"10." in line:  # the mission is under way
            break
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert b"Traceback" not in err
    assert b"interrupted" in out
    check_files(tmp_path / "out", "explore")
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["outcome"] == "interrupted"
    assert not [path for path in (tmp_path / "out").iterdir() if path.name not in FILES["explore"]]


def test_ctrl_c_before_the_mission_writes_nothing_and_shows_no_traceback(tmp_path: Path) -> None:
    code = (
        "import vedette.cli.explore, os, signal, sys\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a background job inherits none
        "def interrupted(*_): os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.modules['vedette.cli.explore'].world_named = interrupted\n"
        "vedette.cli.main()\n"
    )
    ran = subprocess.run(
        [sys.executable, "-c", code, "explore"], cwd=tmp_path, capture_output=True, timeout=60, check=False
    )
    assert ran.returncode == 130
    assert ran.stderr.strip() == b""
    assert list(tmp_path.iterdir()) == []


def test_summary_and_record_are_the_same_bytes_whatever_the_threads_and_the_hash_seed(
    tmp_path: Path, world: Path
) -> None:
    runs = []
    for number, threads, hashes in ((1, "1", "0"), (2, "2", "1"), (3, "1", "random")):
        out = f"out-{number}"
        arguments = ["explore", str(world / "map.yaml"), "--robots", "2", "--link-loss", "0.05", "--out", out]
        variables = {f"{name}_NUM_THREADS": threads for name in ("OMP", "OPENBLAS", "RAYON", "MKL")}
        runs.append((out, start(arguments, tmp_path, PYTHONHASHSEED=hashes, **variables)))
    for _, process in runs:
        assert process.wait(timeout=120) == 0
    for name in ("summary.json", "run.mcap", "map.pgm"):
        first, *others = [(tmp_path / out / name).read_bytes() for out, _ in runs]
        assert others == [first, first], name


# -- large maps ---------------------------------------------------------------------------------------

WILLOW = ROOT.parent / "shared" / "maps" / "willow-full.yaml"


@pytest.mark.slow
@pytest.mark.skipif(not WILLOW.is_file(), reason="the map of a real building is not here")
def test_a_real_building_is_mapped(vedette: Command) -> None:
    ran = vedette("explore", WILLOW, "--max-time", 30, "--robots", 4, "--out", "out", "--json")
    assert ran.status == 1, ran.err
    summary = json.loads(ran.out)
    assert summary["coverage"] > 0.01
    assert summary["collisions"] == 0
    assert min(summary["path_m"].values()) > 1.0


@pytest.mark.slow
def test_a_map_of_4000_by_4000_cells_works(tmp_path: Path) -> None:
    shade = np.full((4000, 4000), 255, np.uint8)
    shade[::200] = shade[:, ::200] = 0
    shade[100::200, :] = 255
    shade[:, 100::200] = 255  # a door in every wall
    for k in range(80, 121):
        shade[k::200, ::200] = 255
        shade[::200, k::200] = 255
    Image.fromarray(shade).save(tmp_path / "large.png")
    began = time.monotonic()
    process = start(
        ["explore", "large.png", "--resolution", "0.05", "--max-time", "60", "--out", "out", "--json"],
        tmp_path,
    )
    out, err = process.communicate(timeout=900)
    assert process.returncode == 1, err
    assert json.loads(out)["outcome"] == "time_limit"
    check_files(tmp_path / "out", "explore")
    assert time.monotonic() - began < 600
