"""``vedette monitor``: the files and the status of a run, and one clear line for whatever is wrong."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from tests.support.commands import FILES, Command, check_files, refused
from tests.support.monitor_scenes import SMALL
from tests.support.places import ROOT
from vedette.domains.monitoring.case import DEFAULT, default_case, read_case

QUICK = ("--no-compare", "--max-time", 6)


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command, run in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys, "monitor")


def scenario(**changes: Any) -> str:
    """Write the small scenario with other fields; return its name."""
    Path("small.yaml").write_text(yaml.safe_dump(SMALL | changes))
    return "small.yaml"


def summary(folder: str) -> dict[str, Any]:
    """Of a run."""
    loaded: dict[str, Any] = json.loads((Path(folder) / "summary.json").read_text())
    return loaded


# -- what a run leaves --------------------------------------------------------------------------------


def test_a_mission_leaves_every_file_and_is_compared_with_all_other_ways(vedette: Command) -> None:
    ran = vedette(scenario(), "--seed", 1, "--out", "out", "--animate")
    assert ran.status == 0, ran
    assert ran.err == ""
    assert "pictures: out/field.png, out/curves.png" in ran.out
    check_files(Path("out"), "monitor")
    assert {path.name for path in Path("out").iterdir()} == FILES["monitor"] | {"mission.gif"}
    told = summary("out")
    assert told["completed"] is True
    assert set(told["comparison"]) == {"none", "shared", "negotiated", "optimum", "lawnmower", "random"}
    own = told["comparison"]["negotiated"]
    assert own == {field: told[field] for field in own}
    assert own["rmse"] < 3.0  # the field's own deviation


def test_the_same_seed_leaves_the_same_bytes_and_another_a_different_field(vedette: Command) -> None:
    for folder, seed in (("a", 1), ("b", 1), ("c", 2)):
        assert vedette(scenario(), "--no-compare", "--seed", seed, "--out", folder).status == 0
    for name in ("summary.json", "run.mcap", "field.png", "curves.png"):
        assert (Path("a") / name).read_bytes() == (Path("b") / name).read_bytes()
    assert summary("a")["rmse"] != summary("c")["rmse"]


def test_a_time_limit_before_the_end_is_told_by_the_status(vedette: Command) -> None:
    ran = vedette(scenario(), *QUICK, "--out", "out")
    assert ran.status == 1
    assert summary("out")["outcome"] == "time_limit"


def test_a_team_goes_on_when_links_lose_messages_and_a_robot_dies(vedette: Command) -> None:
    ran = vedette(scenario(), "--no-compare", "--link-loss", 0.2, "--kill", "1@8", "--out", "out")
    assert ran.status == 0, ran
    assert summary("out")["lost"] == ["rover"]


def test_without_a_file_it_does_what_the_example_says() -> None:
    example = ROOT / "examples" / "scenarios" / DEFAULT
    built_in = ROOT / "src" / "vedette" / "missions" / "scenarios" / DEFAULT
    assert example.read_text() == built_in.read_text()
    assert read_case(example).scenario == default_case().scenario


def test_a_field_of_ones_own_is_read_and_measured(vedette: Command) -> None:
    x = np.linspace(0.0, 6.0, 40)
    np.save("own.npy", 100.0 * np.sin(x[:, None]) * np.cos(x[None, :]) - 50.0)
    ran = vedette(scenario(field={"type": "file", "file": "own.npy"}, model={}), *QUICK, "--out", "out")
    assert ran.status == 1, ran
    assert 20.0 < summary("out")["deviation"] < 100.0


@pytest.mark.parametrize(
    "changes",
    [
        {"area": [0, 0, 2, 40], "vehicles": [{"start": [1, 1]}]},
        {"area": [0, 0, 40, 2], "vehicles": [{"start": [1, 1]}]},
        {"sensor": {"noise": 0.5, "side": 11}},
    ],
    ids=["narrow", "flat", "as wide a block as there is room for"],
)
def test_areas_and_blocks_of_odd_shapes_are_measured_and_drawn(
    vedette: Command, changes: dict[str, Any]
) -> None:
    ran = vedette(scenario(**changes), *QUICK, "--out", "out")
    assert ran.status == 1, ran
    check_files(Path("out"), "monitor")


# -- bad input ----------------------------------------------------------------------------------------

VEHICLE = SMALL["vehicles"][0]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"area": [0, 0, 1, 12]}, ("area: must be",)),
        ({"cell": 0.01, "area": [0, 0, 90, 90]}, ("cell: the area has", "take larger ones")),
        ({"sensor": {"noise": -1}}, ("sensor.noise", "-1")),
        ({"sensor": {"noise": 1, "side": 4}}, ("sensor.side: must be odd", "4")),
        ({"model": {"deviation": 0}}, ("model.deviation", "0")),
        ({"model": {"length": 0.2}}, ("model: length 0.2 m is less than a cell",)),
        ({"model": {"length": 1e6}}, ("model: length 1e+06 m is more than 1000 cells", "1000 m or less")),
        ({"model": {"drift": [1e308, 0]}}, ("model.drift[0]: must be a number from -300 to 300",)),
        ({"model": {"mean": 1e308}}, ("model.mean: must be a number from",)),
        ({"field": {"type": "plume", "source": [5, 5], "wind": [0, 1e308]}}, ("field.wind[1]",)),
        ({"area": [0, 0, 5000, 12]}, ("cell: the area is 5000 cells of 1 m long, at most 2048",)),
        ({"sensor": {"noise": 1e-300}}, ("sensor.noise", "1e-300")),
        (
            {"sensor": {"noise": 1e-9}, "model": {"deviation": 3.0, "length": 5.0}},
            ("sensor.noise: 1e-09 of rover is less than 1e-08 of the field's deviation of 3",),
        ),
        ({"field": {"type": "drawm"}}, ("field", "drawm")),
        ({"field": {"type": "file", "file": "gone.npy"}}, ("gone.npy",)),
        ({"vehicles": []}, ("vehicles",)),
        ({"vehicles": [VEHICLE, VEHICLE]}, ("vehicles[1].name: 'rover' is used twice",)),
        ({"vehicles": [VEHICLE | {"start": [99, 2]}]}, ("vehicles[0].start: 99, 2 is outside the area",)),
        ({"no_go": [[[1, 1], [4, 1], [4, 4], [1, 4]]]}, ("vehicles[0].start: 2, 2 is in no_go",)),
        ({"no_go": [[[1, 1], [2, 2], [3, 3]]]}, ("no_go[0]: all corners are on a line",)),
        ({"vehicles": [VEHICLE | {"budget": {"path": 0.5}}]}, ("vehicles[0].budget", "0.5 m", "next cell")),
        (
            {"vehicles": [VEHICLE | {"budget": {"energy": 5, "per_metre": 0}}]},
            ("vehicles[0].budget.per_metre: energy is never spent",),
        ),
        ({"vehicles": [VEHICLE | {"budget": {"path": 5, "energy": 5}}]}, ("vehicles[0].budget.energy",)),
        (
            {"vehicles": [VEHICLE | {"budget": {"energy": 5, "per_second": 10}}]},
            ("vehicles[0].budget: it lasts for 0.5 s", "the first step of 1 s"),
        ),
        (
            {"vehicles": [VEHICLE | {"budget": {"energy": 5, "per_second": 4, "per_metre": 2}}]},
            ("vehicles[0].budget: it lasts for 0.833 m", "next cell"),
        ),
        ({"vehicles": [VEHICLE | {"start": [16, 12]}]}, ("vehicles[0].start", "x is 0 to below 16 m")),
        ({"layers": 9}, ("layers: at most one a step",)),
        ({"gama": 0.5}, ("unknown field 'gama'", "gamma")),
    ],
)
def test_a_scenario_that_cannot_be_is_refused_in_a_line(
    vedette: Command, changes: dict[str, Any], words: tuple[str, ...]
) -> None:
    refused(vedette(scenario(**changes)), "small.yaml", *words)


def test_a_horizon_that_a_round_does_not_leave_time_for_is_refused_in_a_line(vedette: Command) -> None:
    refused(vedette(scenario(horizon=2)), "horizon: a round of 2 vehicles takes")
    refused(vedette(scenario(step=0.25)), "step: must be a multiple of the simulator", "got 0.25")


def test_a_field_that_cannot_be_measured_is_refused_in_a_line(vedette: Command) -> None:
    np.save("flat.npy", np.ones((5, 5)))
    refused(
        vedette(scenario(field={"type": "file", "file": "flat.npy"}, model={}, sensor={"noise": 1e-12})),
        "small.yaml: sensor.noise: 1 of heron is more than 100 times the field's deviation",
    )
    refused(
        vedette(scenario(field={"type": "jacksboro"}, model={"mean": 0, "deviation": 1, "length": 5})),
        "small.yaml: model.deviation: the field is up to",
    )
    holes = np.ones((4, 4))
    holes[1, 1] = np.nan
    np.save("holes.npy", holes)
    field = {"type": "file", "file": "holes.npy"}
    refused(vedette(scenario(field=field)), "field.file", "has no number in 12 cells")
    field = {"type": "file", "file": "holes.npy", "extent": [0, 0, 8, 12]}
    refused(vedette(scenario(field=field)), "does not cover the area's whole cells")


@pytest.mark.parametrize("size", [1e30, 1e150, 1e300])
def test_numbers_beyond_all_that_can_be_computed_with_are_refused_in_a_line(
    vedette: Command, size: float
) -> None:
    np.save("huge.npy", np.linspace(-size, size, 192).reshape(12, 16))
    ran = vedette(scenario(field={"type": "file", "file": "huge.npy"}, model={}))
    refused(ran, "field.file: huge.npy has numbers up to", "another unit", "nan")


def test_a_number_for_no_data_is_told_apart_from_a_field_that_varies_much(vedette: Command) -> None:
    field = np.add.outer(np.arange(12.0), np.arange(16.0))
    field[3, 4] = -9999.0
    np.save("hole.npy", field)
    ran = vedette(scenario(field={"type": "file", "file": "hole.npy"}, model={}))
    refused(ran, "model.deviation: the field is up to", "nan for what stands for no data")
