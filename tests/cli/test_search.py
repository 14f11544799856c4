"""``vedette search``: the files and the status of a run, and one clear line for whatever is wrong."""

from __future__ import annotations

import json
import signal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from PIL import Image

from tests.support.commands import FILES, Command, check_files, refused, start
from tests.support.places import ROOT
from tests.support.search_missions import EYE, SMALL
from vedette.domains.search import prediction
from vedette.missions.search.case import read_case
from vedette.record.summary import Traffic

FIELDS = [
    "schema_version", "completed", "outcome", "lost", "left", "seed", "scenario", "coordination", "scheme",
    "fusion",
    "worth", "radio", "faults", "vehicles", "time_s",
    "found_s", "found_by", "declared_m", "target_m", "error_m",
    "declare", "counted", "detection_then", "outside_then",
    "duration_s", "detection", "t50_s", "t90_s", "mean_time_s", "outside", "bound", "koopman",
    "path_m",
    "rounds", "sweeps", "bound_ratio", "messages", "bytes", "comparison",
]  # fmt: skip
ALARMS = {"type": "exponential", "range": 100, "sigma": 60, "noise": 10, "false_alarm": 0.02}
QUICK = ("--no-compare", "--trials", 50)


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command, run in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys)


def scenario(**changes: Any) -> str:
    """Write the small scenario with other fields; return its name."""
    Path("small.yaml").write_text(yaml.safe_dump(SMALL | changes))
    return "small.yaml"


def check_run(folder: Path) -> None:
    """Everything is there and loads, and the summary has all its fields."""
    check_files(folder, "search")
    assert list(json.loads((folder / "summary.json").read_text())) == FIELDS


# -- what a run leaves --------------------------------------------------------------------------------


def test_a_search_that_finds_leaves_every_file_and_says_where_the_pictures_are(vedette: Command) -> None:
    ran = vedette("search", scenario(), "--seed", 1, "--out", "out")
    assert ran.status == 0, ran
    assert ran.err == ""
    assert "found after" in ran.out
    assert str(Path("out") / "detection.png") in ran.out
    check_run(Path("out"))
    assert {path.name for path in Path("out").iterdir()} == FILES["search"]
    summary = json.loads((Path("out") / "summary.json").read_text())
    assert summary["completed"] is True
    assert summary["found_s"] == summary["time_s"]
    assert summary["found_by"] in summary["path_m"]
    assert list(summary["comparison"]) == ["none", "shared", "negotiated"]
    own = {field: summary[field] for field in ("detection", "t50_s", "t90_s", "mean_time_s")}
    assert summary["comparison"]["negotiated"] == own
    counted = summary["counted"]
    assert (counted["trials"], counted["of"], counted["mistaken"]) == (1000, "looks", 0)
    assert counted["found_low"] <= counted["found"] <= counted["found_high"]
    assert abs(counted["found"] - own["detection"]) <= counted["band"]
    assert counted["missed"] == round(1000 * (1.0 - counted["found"]))
    assert summary["declare"] is None
    assert own["detection"] <= summary["bound"]["detection"]
    assert own["mean_time_s"] >= summary["bound"]["mean_time_s"]
    assert summary["detection_then"] <= own["detection"] + 1e-6
    for name in summary["path_m"]:
        assert set(summary["bytes"][name]) == set(Traffic.__dataclass_fields__)


def test_json_prints_the_summary_alone(vedette: Command) -> None:
    ran = vedette("search", scenario(), "--max-time", 6, "--out", "out", "--json", *QUICK)
    assert (ran.status, ran.err) == (1, "")
    assert ran.out == (Path("out") / "summary.json").read_text()
    summary = json.loads(ran.out)
    assert summary["outcome"] == "time_limit"
    assert summary["found_s"] is None
    assert summary["duration_s"] == 6.0
    assert list(summary["comparison"]) == ["negotiated"]
    check_run(Path("out"))


def test_a_search_shorter_than_a_step_leaves_every_file(vedette: Command) -> None:
    ran = vedette("search", scenario(), "--max-time", 1, "--out", "out", *QUICK)
    assert ran.status == 1, ran
    assert json.loads((Path("out") / "summary.json").read_text())["mean_time_s"] == 0.0
    check_run(Path("out"))


def test_options_reach_the_search(vedette: Command) -> None:
    ran = vedette(
        "search", scenario(worth="mean-time"), "--coordination", "shared", "--scheme", "jacobi", "--fusion",
        "sums", "--seed", 4, "--max-time", 8, "--trials", 0, "--no-compare", "--json", "--out", "out",
    )  # fmt: skip
    summary = json.loads(ran.out)
    named = [summary[name] for name in ("coordination", "scheme", "fusion", "worth", "seed")]
    assert named == ["shared", "jacobi", "sums", "mean-time", 4]
    assert summary["counted"] is None


def test_faults_are_survived_and_all_files_are_there(vedette: Command) -> None:
    ran = vedette(
        "search", scenario(), "--kill", "1@6", "--link-loss", 0.05, "--link-delay", 0.05, "--json", "--out",
        "out", *QUICK,
    )  # fmt: skip
    assert ran.status in (0, 1)
    summary = json.loads(ran.out)
    first, *others = summary["path_m"].values()
    assert first == pytest.approx(180.0, abs=4.0)
    assert min(others) > first
    check_run(Path("out"))


def test_a_team_that_dies_has_status_1_and_all_files(vedette: Command) -> None:
    kills = [word for k in (1, 2, 3) for word in ("--kill", f"{k}@{k}")]
    ran = vedette("search", scenario(), *kills, "--out", "out", *QUICK)
    assert ran.status == 1
    assert "team lost" in ran.out
    check_run(Path("out"))


def test_with_false_alarms_each_trial_is_a_search_of_its_own(vedette: Command) -> None:
    arguments = ("--no-compare", "--trials", 3, "--json", "--out", "out")
    ran = vedette("search", scenario(detector=ALARMS, duration=24), *arguments)
    summary = json.loads(ran.out)
    counted = summary["counted"]
    assert (counted["trials"], counted["of"], counted["off"]) == (3, "runs", None)
    assert round(3 * counted["found"]) + counted["mistaken"] + counted["missed"] == 3
    check_run(Path("out"))


def test_with_false_alarms_what_was_found_comes_before_what_was_reported_by_names_of_their_own(
    vedette: Command,
) -> None:
    alarming = {"type": "definite", "detection": 0.3, "range": 80, "false_alarm": 0.9}
    ran = vedette("search", scenario(detector=alarming), "--no-compare", "--trials", 3, "--out", "out")
    lines = ran.out.splitlines()
    found, reported = (
        next(k for k, line in enumerate(lines) if line.startswith(words))
        for words in (
            "declared found, counted over 3 searches: 0 % (0 to 56 %)",
            "some true report, predicted",
        )
    )
    assert found < reported
    assert (
        "where it is not: 0; never declared: 3; declared at a posterior of 95 % within 100 m" in lines[found]
    )
    assert "probability of detection" not in ran.out
    summary = json.loads((Path("out") / "summary.json").read_text())
    assert summary["declare"] == {"probability": 0.95, "radius_m": 100.0}
    assert (summary["counted"]["found"], summary["counted"]["missed"]) == (0.0, 3)
    assert summary["detection"] > 0.3


def test_a_declared_place_that_is_wrong_is_a_mistake_with_status_1(vedette: Command) -> None:
    wrong = {"declare": {"probability": 0.3, "radius": 150}, "target": {"start": [1150, 750]}}
    ran = vedette(
        "search", scenario(detector=ALARMS, **wrong), "--json", "--out", "out", *QUICK[:1], "--trials", 0
    )
    assert ran.status == 1
    summary = json.loads(ran.out)
    assert summary["outcome"] == "mistaken"
    assert summary["completed"] is False
    assert summary["error_m"] > 150.0
    assert summary["found_by"] is None


def test_animate_adds_a_gif_and_without_out_a_new_folder_is_made(vedette: Command) -> None:
    assert vedette("search", scenario(), "--max-time", 4, "--animate", *QUICK).status == 1
    folder = Path("runs") / "small-001"
    check_run(folder)
    with Image.open(folder / "mission.gif") as image:
        assert image.format == "GIF"
        assert getattr(image, "n_frames", 0) >= 2


def test_the_record_has_the_pdf_the_vehicles_and_the_truth(vedette: Command) -> None:
    vedette("search", scenario(), "--max-time", 8, "--out", "out", *QUICK)
    with (Path("out") / "run.mcap").open("rb") as file:
        topics = {channel.topic for _, channel, _ in make_reader(file).iter_messages()}
    own = {"/vehicle_1/pose", "/vehicle_1/path", "/vehicle_1/state"}
    assert (
        topics
        >= {"/pdf", "/pdf_full", "/tf", "/target/truth", "/metrics/detection", "/metrics/entropy"} | own
    )


@pytest.mark.parametrize(
    "prior",
    [
        [{"type": "polygon", "corners": [[100, 100], [900, 150], [500, 700]]}],
        [{"type": "image", "file": "heat.png"}, {"type": "uniform", "weight": 0.2}],
        [{"type": "gaussian", "mean": [500, 400], "covariance": [[9000, 3000], [3000, 6000]]}],
        [{"type": "image", "file": "heat.npy", "extent": [200, 100, 900, 700]}],
        [{"type": "rings", "centre": [600, 400], "distances": [150, 300], "within": [0.5, 0.95]}],
    ],
)
def test_priors_of_every_kind_can_be_searched(vedette: Command, prior: list[dict[str, Any]]) -> None:
    shade = np.zeros((30, 40), np.uint8)
    shade[10:20, 5:25] = 200
    Image.fromarray(shade).save("heat.png")
    np.save("heat.npy", shade / 7.0)
    ran = vedette("search", scenario(prior=prior), "--max-time", 4, "--out", "out", *QUICK)
    assert ran.status in (0, 1), ran.err
    check_run(Path("out"))


def test_nobody_takes_the_target_to_be_in_a_no_go_area_and_searched_tracks_are_thinned(
    vedette: Command,
) -> None:
    known = {
        "prior": [{"type": "uniform"}],
        "searched": [{"path": [[100, 220], [1100, 220]], "width": 40, "detection": 0.75}],
        "no_go": [[[400, 400], [800, 400], [800, 600], [400, 600]]],
    }
    mass = read_case(scenario(**known)).pdf.mass
    assert mass[10:15, 10:20].max() == 0.0
    assert mass[5, 10] == pytest.approx(0.25 * mass[2, 10])
    assert mass.sum() == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["search", "hiker"])
def test_the_examples_can_be_searched(vedette: Command, name: str) -> None:
    path = ROOT / "examples" / "scenarios" / f"{name}.yaml"
    ran = vedette("search", path, "--max-time", 6, "--out", "out", "--json", *QUICK)
    assert (ran.status, json.loads(ran.out)["scenario"]) == (1, name)
    check_run(Path("out"))


def test_a_search_in_utm_coordinates_is_that_at_the_origin_moved(vedette: Command) -> None:
    x, y = 500_000.0, 5_000_000.0

    def moved(place: list[float]) -> list[float]:
        return [place[0] + x, place[1] + y, *place[2:]]

    away = {
        "area": [x, y, x + 1200, y + 800],
        "prior": [part | {"mean": moved(part["mean"])} for part in SMALL["prior"]],
        "vehicles": [each | {"start": moved(each["start"])} for each in SMALL["vehicles"]],
    }
    summaries = []
    for changes in ({}, away):
        arguments = ("--seed", 1, "--json", "--out", "out", "--force", *QUICK)
        ran = vedette("search", scenario(**changes), *arguments)
        assert (ran.status, ran.err) == (0, "")
        summaries.append(json.loads(ran.out))
    here, there = summaries
    assert there["target_m"] == pytest.approx(moved(here["target_m"]), abs=1e-5)
    for name in ("found_s", "detection", "mean_time_s", "path_m", "rounds"):
        assert there[name] == pytest.approx(here[name], rel=1e-6), name


def test_the_example_is_the_search_without_a_file(vedette: Command) -> None:
    built_in = ROOT / "src" / "vedette" / "missions" / "scenarios" / "search.yaml"
    assert (ROOT / "examples" / "scenarios" / "search.yaml").read_bytes() == built_in.read_bytes()
    ran = vedette("search", "--max-time", 6, "--out", "out", "--json", *QUICK)
    assert json.loads(ran.out)["vehicles"] == 4


# -- cells that are large for a sensor ------------------------------------------------------------------


def test_cells_of_more_than_half_a_range_are_told_and_half_are_not(vedette: Command) -> None:
    for reach, said in ((20, True), (80, False)):
        sensor = {"type": "definite", "detection": 0.9, "range": reach}
        ran = vedette("search", scenario(detector=sensor, duration=20), "--out", "out", "--force", *QUICK)
        assert ran.status in (0, 1)
        assert ("vedette: cell: 40 m is more than half" in ran.err) is said
        assert ("take 10 m or less" in ran.err) is said


def test_cells_of_many_ranges_are_predicted_as_counted(vedette: Command) -> None:
    sensor = {"type": "definite", "detection": 0.9, "range": 3}
    ran = vedette(
        "search", scenario(detector=sensor), "--no-compare", "--trials", 20000, "--json", "--out", "out"
    )
    summary = json.loads(ran.out)
    assert summary["counted"]["off"] <= summary["counted"]["band"] < 0.01
    assert summary["detection"] > 0.02


def test_where_prediction_and_count_disagree_a_line_says_so(
    vedette: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    arguments = ("search", scenario(detector={"type": "definite", "range": 40}), "--no-compare", "--force")
    assert "predicted" not in vedette(*arguments, "--trials", 4000, "--out", "out").out
    monkeypatch.setattr(prediction, "parts_of", lambda pdf, detectors: 1)  # cells as they are: too large
    ran = vedette(*arguments, "--trials", 4000, "--out", "out")
    summary = json.loads((Path("out") / "summary.json").read_text())
    assert summary["counted"]["off"] > summary["counted"]["band"]
    assert "more than the 95 % band of 0.021: smaller cells predict better" in ran.out


# -- a target that drifts to the border -----------------------------------------------------------------

OUT = {"target": {"drift": [40, 0], "diffusion": 1}, "detector": EYE, "duration": 40}


def test_a_drift_to_the_border_is_told_with_what_happens_there(vedette: Command) -> None:
    """Of the two parts of the prior, at x = 350 and 800, the second is at x = 1200 after 10 s."""
    told = "it takes the mean of prior[1] to the area's border after 10 s"
    ran = vedette("search", scenario(**OUT), "--out", "held", *QUICK)
    assert f"{told}: the target is held there" in ran.err
    assert json.loads((Path("held") / "summary.json").read_text())["outside"] is None
    leaving = OUT | {"target": OUT["target"] | {"border": "leave"}}  # type: ignore[operator]
    ran = vedette("search", scenario(**leaving), "--out", "left", *QUICK)
    assert f"{told}: what leaves is not found again" in ran.err
    assert "has left the area undetected with a probability of" in ran.out
    assert "has left" in ran.out.splitlines()[0]
    summary = json.loads((Path("left") / "summary.json").read_text())
    assert summary["detection"] + summary["outside"] == pytest.approx(1.0, abs=0.02)
    assert summary["outside_then"] <= summary["outside"]
    check_run(Path("left"))


def test_a_drift_that_stays_within_the_area_is_not_told(vedette: Command) -> None:
    slow = scenario(target={"drift": [5, 0]})  # 220 m, and 400 m to go
    assert vedette("search", slow, "--out", "out", *QUICK).err == ""
    ran = vedette(
        "search", scenario(target={"drift": [0, 5], "start": [300, 700]}), "--out", "out", "--force"
    )
    assert "takes target.start to the area's border after 20 s" in ran.err


# -- bad input ----------------------------------------------------------------------------------------

ONE = SMALL["vehicles"][0]
GAUSSIAN = SMALL["prior"][0]
RINGS = {"type": "rings", "centre": [600, 400], "distances": [150, 300], "within": [0.5, 0.95]}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"prior": []}, ["prior", "1 to 1000 entries"]),
        ({"prior": [{"type": "gaussain", "mean": [1, 1]}]}, ["prior[0].type", "gaussain", "'gaussian'"]),
        ({"prior": [GAUSSIAN | {"sigma": -5}]}, ["prior[0].sigma", "-5"]),
        ({"prior": [GAUSSIAN | {"sigma": float("nan")}]}, ["prior[0].sigma", "finite"]),
        ({"prior": [GAUSSIAN | {"mean": [90000, 0]}]}, ["prior[0]", "90000", "0.0%"]),
        (
            {"prior": [GAUSSIAN | {"covariance": [[1, 0], [0, 1]]}]},
            ["prior[0]", "either sigma or covariance"],
        ),
        ({"prior": [{"type": "gaussian", "mean": [500, 400]}]}, ["prior[0]", "sigma or covariance"]),
        (
            {"prior": [{"type": "gaussian", "mean": [500, 400], "covariance": [[1, 2], [2, 1]]}]},
            ["prior[0]", "positive definite"],
        ),
        ({"prior": [{"type": "polygon", "corners": [[0, 0], [9, 9]]}]}, ["prior[0].corners", "3 or more"]),
        (
            {"prior": [{"type": "polygon", "corners": [[-90, -90], [-50, -90], [-50, -50]]}]},
            ["prior[0]", "nothing of the polygon"],
        ),
        ({"prior": [{"type": "image", "file": "missing.png"}]}, ["prior[0]", "missing.png"]),
        ({"prior": [{"type": "image", "file": "black.png"}]}, ["prior[0]", "no mass"]),
        (
            {"prior": [{"type": "image", "file": "jet.png"}]},
            ["prior[0]", "heat map jet.png has colours", "grey"],
        ),
        (
            {"prior": [{"type": "image", "file": "black.png", "extent": [5000, 0, 6000, 800]}]},
            ["prior[0]", "beside the area"],
        ),
        ({"prior": [RINGS | {"within": [0.5]}]}, ["prior[0]", "a share for each of 2 distances"]),
        ({"prior": [RINGS | {"distances": [300, 200]}]}, ["prior[0]", "distances must rise"]),
        ({"prior": [RINGS | {"centre": [90000, 0]}]}, ["prior[0]", "rings", "no mass"]),
        ({"searched": [{"path": [[0, 0]], "width": 9, "detection": 0.5}]}, ["searched[0].path"]),
        (
            {"searched": [{"path": [[9000, 0], [9900, 0]], "width": 9, "detection": 0.5}]},
            ["searched[0]", "nothing of the track"],
        ),
        ({"no_go": [[[9000, 0], [9900, 0], [9000, 9]]]}, ["no_go[0]", "nothing of the polygon"]),
        ({"no_go": [[[0, 0], [1200, 0], [1200, 800], [0, 800]]]}, ["prior, less", "no mass"]),
        ({"prior": [GAUSSIAN | {"weight": 0}]}, ["prior[0].weight", "0"]),
        ({"detector": {"type": "definit"}}, ["detector", "definit", "'definite'"]),
        ({"detector": {"type": "definite", "rnage": 4}}, ["detector", "rnage", "'range'"]),
        ({"detector": {"range": 50}}, ["detector", "type"]),
        (
            {"vehicles": [ONE | {"detector": {"type": "exponential", "sigma": -1}}]},
            ["vehicles[0].detector", "-1"],
        ),
        ({"vehicles": []}, ["vehicles", "1 to 64 entries"]),
        ({"vehicles": [ONE | {"start": [5000, 100, 0]}]}, ["vehicles[0].start", "5000", "outside"]),
        ({"vehicles": [ONE | {"start": [100, 100]}]}, ["vehicles[0].start", "a list of 3 numbers"]),
        ({"vehicles": [ONE | {"spede": 30}]}, ["vehicles[0]", "spede", "'speed'"]),
        ({"vehicles": [ONE | {"turn_rate": 0}]}, ["vehicles[0].turn_rate", "0"]),
        ({"vehicles": [ONE | {"name": "a"}, ONE | {"name": "a"}]}, ["vehicles[1].name", "twice"]),
        ({"vehicels": []}, ["vehicels", "'vehicles'"]),
        ({"area": [0, 0, 0, 800]}, ["area"]),
        ({"cell": 0.5}, ["cell", "at most"]),
        (
            {"detector": {"type": "definite", "range": 0.3}},
            ["cell", "133 times", "vehicle-1", "0.3 m", "smaller area"],
        ),
        ({"step": 0.25}, ["step", "multiple"]),
        ({"duration": 1}, ["duration", "at least a step"]),
        ({"horizon": 2}, ["horizon", "plan more than"]),
        ({"target": {"diffusion": -1}}, ["target.diffusion", "-1"]),
        ({"target": {"drift": [1e6, 0]}}, ["small.yaml", "cells"]),
        ({"target": {"start": [5000, 0]}}, ["target.start", "outside"]),
        ({"target": {"border": "leaves"}}, ["target.border", "leaves", "'leave'"]),
        ({"worth": "plian"}, ["worth", "plian", "'plain'"]),
        ({"declare": {"probability": 1.5}}, ["declare.probability", "1.5"]),
    ],
)
def test_scenarios_that_make_no_sense_are_refused(
    vedette: Command, changes: dict[str, Any], words: list[str]
) -> None:
    Image.new("L", (8, 8), 0).save("black.png")
    Image.new("RGB", (8, 8), (200, 30, 30)).save("jet.png")
    ran = vedette("search", scenario(**changes), "--out", "out")
    refused(ran, *words)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--coordination", "negociated"], ["coordination", "'negotiated'"]),
        (["--scheme", "tokens"], ["scheme", "'token'"]),
        (["--fusion", "sum"], ["fusion", "'sums'"]),
        (["--max-time", "0"], ["--max-time"]),
        (["--trials", "-1"], ["--trials"]),
        (["--kill", "4@10"], ["no robot 4"]),
        (["--link-loss", "2"], ["--link-loss"]),
        (["--frobnicate"], ["--frobnicate"]),
    ],
)
def test_options_that_make_no_sense_are_refused(
    vedette: Command, arguments: list[str], words: list[str]
) -> None:
    refused(vedette("search", scenario(), "--out", "out", *arguments), *words)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, ["cannot read"]),
        ("prior: [\n", ["not valid YAML"]),
        ("[1]", ["pairs"]),
        ("", ["area is missing"]),
    ],
)
def test_a_file_that_is_no_scenario_is_refused(
    vedette: Command, content: str | None, words: list[str]
) -> None:
    if content is not None:
        Path("bad.yaml").write_text(content)
    refused(vedette("search", "bad.yaml", "--out", "out"), "bad.yaml", *words)


# -- interruption and determinism, in processes of their own --------------------------------------------


def test_ctrl_c_leaves_every_file_valid_and_has_status_130(tmp_path: Path) -> None:
    process = start(["search", "--seed", "2", "--out", "out"], tmp_path)
    assert process.stdout is not None
    for line in process.stdout:
        if b"10." in line:  # the search is under way
            break
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert b"Traceback" not in err
    assert b"interrupted" in out
    check_run(tmp_path / "out")
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["outcome"] == "interrupted"
    assert {path.name for path in (tmp_path / "out").iterdir()} == FILES["search"]


def test_summary_and_record_are_the_same_bytes_whatever_the_threads_and_the_hash_seed(tmp_path: Path) -> None:
    (tmp_path / "small.yaml").write_text(
        yaml.safe_dump(SMALL | {"duration": 20, "target": {"diffusion": 2.0}})
    )
    runs = []
    for number, threads, hashes in ((1, "1", "0"), (2, "2", "1"), (3, "1", "random")):
        out = f"out-{number}"
        arguments = [
            "search",
            "small.yaml",
            "--link-loss",
            "0.05",
            "--trials",
            "100",
            "--no-compare",
            "--out",
            out,
        ]
        variables = {f"{name}_NUM_THREADS": threads for name in ("OMP", "OPENBLAS", "RAYON", "MKL")}
        runs.append((out, start(arguments, tmp_path, PYTHONHASHSEED=hashes, **variables)))
    for _, process in runs:
        assert process.wait(timeout=120) in (0, 1)
    for name in ("summary.json", "run.mcap"):
        first, *others = [(tmp_path / out / name).read_bytes() for out, _ in runs]
        assert others == [first, first], name
