"""The benches as commands, with the small variants that they offer: whole, nothing replaced."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from bench.ablation import WHOLE, carry_out_variant, variants
from bench.scale.series import DOMAINS
from tests.support.places import ROOT
from tests.support.schemas import valid
from vedette.sim.explore.simulation import ExploreSetup
from vedette.study.run import GeneratedWorld, Run
from vedette.team import PlatformSpec


def run(module: str, *arguments: str | Path) -> str:
    """Return what ``python -m module arguments`` writes; it has to succeed."""
    command = [sys.executable, "-m", module, *map(str, arguments)]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600, check=False)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def measurements(path: Path) -> list[dict[str, Any]]:
    schema = path.stem.removesuffix("-quick").replace("scale", "bench-scale").replace("stone", "bench-stone")
    rows: list[dict[str, Any]] = valid(schema, path.read_bytes())["measurements"]
    return rows


@pytest.mark.slow
def test_the_smoke_run_of_all_measures_everything_but_large_teams(tmp_path: Path) -> None:
    said = run("bench", "--quick", "--out", tmp_path)
    speed, scale = measurements(tmp_path / "bench-quick.json"), measurements(tmp_path / "scale-quick.json")
    assert (len(speed), len(scale)) == (9, len(DOMAINS) * 5)
    assert all(row["measured"] > 0 and row["name"] in said for row in speed)
    assert [row["name"].split(", ", 1)[1] for row in scale if row["measured"] is None] == [
        "constant density: median link, from n=256 on"
    ] * len(DOMAINS)


@pytest.mark.slow
def test_the_smoke_run_of_stone_soups_managers_judges_ours(tmp_path: Path) -> None:
    pytest.importorskip("stonesoup")
    run("bench.stonesoup", "--quick", "--out", tmp_path)
    assert all(row["measured"] > 0 for row in measurements(tmp_path / "stonesoup-quick.json"))


@pytest.mark.slow
def test_a_table_of_two_missions_is_measured_and_judged(tmp_path: Path) -> None:
    run("vedette", "world", "office", "--width", "12", "--height", "10", "--out", tmp_path / "tiny")
    options = ("--maps", tmp_path / "tiny", "--seeds", "0", "--robots", "3", "--planners", WHOLE)
    run("bench.missions", *options, "--out", tmp_path)
    text = (tmp_path / "missions.md").read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in line.split("|")[1:4]] for line in text.splitlines() if " 1/1 " in line]
    assert rows == [["offices, 3 robots", WHOLE, "1/1"], ["map, 4 robots", WHOLE, "1/1"]]
    assert "| missions complete" in text


@pytest.mark.slow
@pytest.mark.parametrize("planner", [WHOLE, *variants()])
def test_every_variant_of_the_ablation_carries_out_a_mission(planner: str) -> None:
    setup = ExploreSetup(planner=planner, max_time=1800.0)
    world = GeneratedWorld("office", 1, 12.0, 10.0, 0.1)
    result = carry_out_variant(Run(world, 2, "together", PlatformSpec("robot"), setup))
    assert result.figures["completed"], result.error
