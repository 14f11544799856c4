"""A study of somebody's own parts: every worker finds them, a process and one of a cluster alike."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.support.commands import start
from tests.support.dask_cluster import PATIENCE, Cluster
from tests.support.own_parts import example, module
from tests.support.schemas import valid
from vedette.study.combinations import runs_of
from vedette.study.spec import load_spec

HALL = """
import numpy as np
from vedette.maps import GridFrame
from vedette.maps.world import World

def hall(rng, width, height, resolution):
    solid = np.ones((round(height / resolution), round(width / resolution)), bool)
    solid[2:-2, 2:-2] = False
    return World(GridFrame(resolution, *solid.shape), solid, "hall")
"""
PLANNER = """
from vedette.domains.mapping import layers
from vedette.domains.mapping.planners import Planner
from vedette.domains.mapping.platform import MappingPlatform

class Stays(MappingPlatform):
    def reply(self, belief, others, current):
        raise RuntimeError("no way")

STAYS = Planner("", layers.rate(), Stays)
"""


def spec(folder: Path, planners: list[str], kind: str, seeds: int = 1) -> Path:
    folder.mkdir(exist_ok=True)
    path = folder / "own.yaml"
    content = {
        "planners": planners,
        "worlds": [{"kind": kind, "seeds": list(range(seeds)), "width": 10, "height": 10}],
        "robots": [1],
        "platform": {"beams": 90, "rate": 2},
        "setup": {"max_time": 30},
    }
    path.write_text(json.dumps(content))
    return path


def own_spec(folder: Path, seeds: int = 1) -> tuple[Path, str]:
    """A study in a folder of its own, and the name of its planner."""
    folder.mkdir()
    name = f"{example('own_planner', folder)}:SIDES"
    return spec(folder, [name, "nearest"], f"{module(folder, HALL)}:hall", seeds), name


def figures(out: Path) -> dict[str, dict[str, Any]]:
    """The figures of each planner's runs."""
    files = [valid("study-run", file.read_bytes()) for file in (out / "runs").glob("*.json")]
    return {file["run"]["planner"]: file["result"]["figures"] for file in files}


def test_processes_carry_out_an_own_planner_in_an_own_world(tmp_path: Path) -> None:
    path, name = own_spec(tmp_path / "spec")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    process = start(["study", str(path), "--jobs", "2", "--out", "out"], elsewhere)
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, (out, err)
    found = figures(elsewhere / "out")
    assert set(found) == {name, "nearest"}
    assert [each["error"] for each in found.values()] == ["", ""]


def test_a_worker_tells_in_which_line_an_own_planner_broke(tmp_path: Path) -> None:
    name = f"{module(tmp_path, PLANNER)}:STAYS"
    process = start(
        ["study", str(spec(tmp_path, [name], "maze", 2)), "--jobs", "2", "--out", "out"], tmp_path
    )
    assert process.communicate(timeout=PATIENCE)[1] == b""
    assert process.returncode == 1
    said = f"PartError: planner {name}: reply: RuntimeError: no way ({name.partition(':')[0]}.py, line 8)"
    assert figures(tmp_path / "out")[name]["error"] == said


@pytest.mark.slow
@pytest.mark.parametrize("standing", [False, True], ids=["made for it", "standing elsewhere"])
def test_a_cluster_carries_out_an_own_planner_in_an_own_world(
    tmp_path: Path, standing: bool, cluster: Callable[[], Cluster]
) -> None:
    path, name = own_spec(tmp_path / "spec", seeds=2)
    environment = {}
    if standing:
        running = cluster()
        running.worker()
        environment["DASK_SCHEDULER_ADDRESS"] = running.address
    process = start(["study", str(path), "--backend", "dask", "--out", "out"], tmp_path, **environment)
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, (out, err)
    assert figures(tmp_path / "out")[name]["error"] == ""


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Callable[[], Cluster]]:
    """Makes a cluster when it is asked for."""
    made: list[Cluster] = []

    def make() -> Cluster:
        made.append(Cluster(tmp_path))
        return made[0]

    yield make
    for each in made:
        each.end()


def test_a_run_of_an_own_part_is_another_once_its_code_is_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def keys(planner: str, kind: str) -> list[str]:
        path = spec(tmp_path, ["nearest", planner], kind)
        return [run.key("code") for run in runs_of(load_spec(path), path)]

    same, other = (module(tmp_path, PLANNER) for _ in range(2))
    (tmp_path / f"{other}.py").write_text(PLANNER.replace("no way", "no path"))
    hall = module(tmp_path, HALL)
    assert keys(f"{same}:STAYS", "maze")[0] == keys(f"{other}:STAYS", "maze")[0]
    by_module, by_other, in_hall = (
        keys(f"{same}:STAYS", "maze")[1],
        keys(f"{other}:STAYS", "maze")[1],
        keys(f"{same}:STAYS", f"{hall}:hall")[1],
    )
    assert len({by_module, by_other, in_hall}) == 3


@pytest.mark.parametrize(
    ("planner", "kind", "said"),
    [
        ("nowhere_at_all:P", "maze", "planners: planner: cannot import nowhere_at_all: ModuleNotFoundError"),
        (
            "math:pi",
            "maze",
            "planners: planner math:pi: is float, not a Planner; see docs/how-to/own-planner",
        ),
        ("tours", "math:p", "worlds[0].kind: kind: math has no 'p'; did you mean 'pi'?"),
    ],
)
def test_an_own_part_that_there_is_not_is_told_with_the_file_before_anything_runs(
    tmp_path: Path, planner: str, kind: str, said: str
) -> None:
    path = spec(tmp_path, [planner], kind)
    with pytest.raises(ValueError, match=r"own\.yaml: ") as told:
        runs_of(load_spec(path), path)
    assert said in str(told.value)
