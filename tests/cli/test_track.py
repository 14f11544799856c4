"""``vedette track``: the files and the status of a run, and one clear line for whatever is wrong."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import pytest
import yaml

from tests.support.commands import FILES, Command, check_files, refused, start
from tests.support.track_scenes import content


@pytest.fixture
def track(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command, run in a folder with a short scenario."""
    monkeypatch.chdir(tmp_path)
    Path("short.yaml").write_text(yaml.safe_dump(content(duration=6)))
    return Command(monkeypatch, capsys, "track")


# -- what a run leaves --------------------------------------------------------------------------------


def test_a_run_leaves_every_file_and_is_compared_with_all_other_ways(track: Command) -> None:
    ran = track("short.yaml", "--out", "out")
    assert ran.status == 0, ran
    assert ran.err == ""
    assert "complete" in ran.out
    assert "to compare: optimum" in ran.out
    assert str(Path("out") / "tracks.png") in ran.out
    check_files(Path("out"), "track")
    assert {path.name for path in Path("out").iterdir()} == FILES["track"]
    summary = json.loads((Path("out") / "summary.json").read_text())
    assert summary["completed"] is True
    assert summary["scenario"] == "short"
    assert list(summary["comparison"]) == ["none", "shared", "negotiated", "optimum"]
    own = {key: summary[key] for key in ("entropy_mean_nat", "nees", "position_rmse_m")}
    assert own.items() <= summary["comparison"]["negotiated"].items()


def test_tracks_that_are_surer_than_they_are_right_are_said_in_a_line_and_in_the_summary(
    track: Command,
) -> None:
    plain = content(duration=6)
    plain["targets"][2] |= {"sd": [1, 1], "start": [250, 230]}  # 42 m off, and told to be known to 1 m
    Path("wrong.yaml").write_text(yaml.safe_dump(plain))
    ran = track("wrong.yaml", "--out", "out", "--no-compare")
    assert ran.status == 0
    assert "the tracks are surer than they are right: NEES " in ran.out
    assert "0.32 to 2.05 is consistent" in ran.out
    in_view = json.loads((Path("out") / "summary.json").read_text())["in_view"]
    unseen = [name for name, share in in_view.items() if not share]
    assert unseen
    assert f"never seen by anybody: {', '.join(unseen)}" in ran.out
    assert json.loads((Path("out") / "summary.json").read_text())["consistency"] == "overconfident"


def test_json_prints_the_summary_alone_and_no_compare_leaves_the_rest_out(track: Command) -> None:
    ran = track("short.yaml", "--out", "out", "--json", "--no-compare")
    assert (ran.status, ran.err) == (0, "")
    assert ran.out == (Path("out") / "summary.json").read_text()
    assert json.loads(ran.out)["comparison"] == {}


def test_a_mission_cut_short_has_status_1_and_all_files(track: Command) -> None:
    ran = track("short.yaml", "--out", "out", "--max-time", 2.5, "--json", "--no-compare")
    assert ran.status == 1
    assert json.loads(ran.out)["outcome"] == "time_limit"
    check_files(Path("out"), "track")


def test_a_team_that_dies_has_status_1_and_all_files(track: Command) -> None:
    kills = [word for k in (1, 2, 3) for word in ("--kill", f"{k}@2")]
    ran = track("short.yaml", *kills, "--out", "out", "--no-compare")
    assert ran.status == 1
    assert "team lost" in ran.out
    check_files(Path("out"), "track")


def test_options_reach_the_mission_and_force_writes_into_an_existing_folder(track: Command) -> None:
    Path("out").mkdir()
    (Path("out") / "mine.txt").write_text("keep")
    ran = track(
        "short.yaml", "--coordination", "shared", "--scheme", "jacobi", "--fusion", "sums", "--seed", 4,
        "--objective", "final-entropy", "--max-time", 2, "--link-loss", 0.1, "--link-delay", 0.03, "--json",
        "--animate", "--no-compare", "--out", "out", "--force",
    )  # fmt: skip
    summary = json.loads(ran.out)
    assert (summary["coordination"], summary["scheme"], summary["fusion"]) == ("shared", "jacobi", "sums")
    assert (summary["objective"], summary["seed"]) == ("final-entropy", 4)
    assert (Path("out") / "mine.txt").read_text() == "keep"
    assert (Path("out") / "mission.gif").exists()


def test_where_the_optimum_cannot_be_had_it_is_left_out_and_asking_for_it_is_refused(track: Command) -> None:
    Path("rich.yaml").write_text(yaml.safe_dump(content(duration=2, decisions=5)))
    refused(track("rich.yaml", "--coordination", "optimum", "--out", "out"), "joint choices", "fewer")
    refused(track("short.yaml", "--coordination", "optimum", "--continuous", "--out", "out"), "--continuous")
    ran = track("rich.yaml", "--json")
    assert ran.status == 0
    assert list(json.loads(ran.out)["comparison"]) == ["none", "shared", "negotiated"]
    check_files(Path("runs") / "rich-001", "track")


# -- bad input ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["missing.yaml"], ["missing.yaml"]),
        (["."], ["."]),
        ([""], []),
        (["--coordination", "negotiate"], ["coordination", "negotiated"]),
        (["--scheme", "tokens"], ["scheme", "token"]),
        (["--fusion", "sum"], ["fusion", "sums"]),
        (["--objective", "trajectroy"], ["objective", "trajectory"]),
        (["--kill", "5@10"], ["no robot 5", "in a team of 4"]),
        (["--kill", "2"], ["robot@seconds"]),
        (["--max-time", "0"], ["--max-time"]),
        (["--max-time", "nan"], ["--max-time"]),
        (["--link-delay", "-1"], ["--link-delay"]),
        (["--link-delay", "0.3"], ["round of 4 vehicles", "longer horizon"]),
        (["--link-loss", "1.5"], ["--link-loss"]),
        (["--seed", "-1"], ["--seed"]),
        (["--frobnicate"], ["--frobnicate"]),
        (["one.yaml", "two.yaml"], ["two.yaml"]),
    ],
)
def test_options_that_make_no_sense_are_refused(
    track: Command, arguments: list[str], words: list[str]
) -> None:
    refused(track("--out", "out", *arguments), *words)


def test_a_scenario_that_makes_no_sense_is_refused_with_file_and_field(track: Command) -> None:
    Path("bad.yaml").write_text(yaml.safe_dump(content(horizon=0)))
    refused(track("bad.yaml", "--out", "out"), "bad.yaml", "horizon")
    Path("bad.yaml").write_text(yaml.safe_dump(content(horizn=3)))
    refused(track("bad.yaml", "--out", "out"), "bad.yaml", "did you mean 'horizon'?")


def test_an_existing_folder_is_refused_without_force(track: Command) -> None:
    Path("there").mkdir()
    refused(track("short.yaml", "--out", "there"), "there", "--force")
    assert list(Path("there").iterdir()) == []


# -- interruption and determinism, in processes of their own --------------------------------------------


@pytest.mark.parametrize(("word", "compared"), [(b"10.0 s", 0), (b"to compare: shared", 2)])
def test_ctrl_c_leaves_every_file_valid_and_has_status_130(
    tmp_path: Path, word: bytes, compared: int
) -> None:
    scenario = content() if not compared else content(duration=12)
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(scenario))
    process = start(["track", "scene.yaml", "--out", "out"], tmp_path)
    assert process.stdout is not None
    for line in process.stdout:
        if word in line:
            break
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert b"Traceback" not in err
    assert b"interrupted" in out
    check_files(tmp_path / "out", "track")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["outcome"] == "interrupted"
    assert summary["completed"] is False
    assert len(summary["comparison"]) in (compared, max(1, compared))
    assert not [path for path in (tmp_path / "out").iterdir() if path.name not in FILES["track"]]


def test_summary_and_record_are_the_same_bytes_whatever_the_threads_and_the_hash_seed(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(content(duration=8)))
    runs = []
    for number, threads, hashes in ((1, "1", "0"), (2, "2", "random")):
        out = f"out-{number}"
        variables = {f"{name}_NUM_THREADS": threads for name in ("OMP", "OPENBLAS", "RAYON", "MKL")}
        arguments = ["track", "scene.yaml", "--link-loss", "0.05", "--out", out]
        runs.append((out, start(arguments, tmp_path, PYTHONHASHSEED=hashes, **variables)))
    for _, process in runs:
        assert process.wait(timeout=120) == 0
    for name in ("summary.json", "run.mcap"):
        first, second = [(tmp_path / out / name).read_bytes() for out, _ in runs]
        assert first == second, name
