"""What the bench of crowds counts as idle, and its table."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bench import crowds as bench_crowds
from bench.crowds import Crowd, CrowdResult, crowds, crowds_table
from bench.idleness import Idleness
from tests.support.schemas import valid
from tests.support.small_missions import begun
from vedette.domains.mapping.tour import STAY
from vedette.errors import InputError
from vedette.sim.explore.run import views
from vedette.sim.explore.simulation import ExploreSimulation

RESULT = CrowdResult(
    world="cave", robots=8, seed=0, outcome="complete", coverage=0.9991, t90_s=40.0, t99_s=60.0, time_s=70.0,
    last_gain_s=61.0, standing_s=4.0, idle_s=3.0, never_left=0, collisions=0, cpu_s=9.0, commit="abc",
)  # fmt: skip


def stand(idleness: Idleness, simulation: ExploreSimulation, times: tuple[float, ...]) -> float:
    for now in times:
        idleness.look(now, views(simulation))
    return idleness.longest


def test_who_stands_while_there_is_work_that_nobody_has_is_idle_and_for_how_long() -> None:
    simulation = begun(8.0)
    for mission in simulation.missions:
        mission.strategy = STAY
    assert stand(Idleness(simulation), simulation, (8.0, 9.0, 20.0)) == 12.0


def test_who_goes_somewhere_is_not_idle() -> None:
    simulation = begun(8.0)
    for mission in simulation.missions:
        mission.strategy = STAY
    idleness = Idleness(simulation)
    stand(idleness, simulation, (8.0, 9.0))
    simulation.robots.bodies.poses[:, 0] += 0.4
    assert stand(idleness, simulation, (20.0, 21.0)) == 1.0


def test_who_stands_when_all_is_known_is_not_idle() -> None:
    simulation = begun(70.0)  # 99 % are known after 61 s
    for mission in simulation.missions:
        mission.strategy = STAY
    assert stand(Idleness(simulation), simulation, (70.0, 71.0, 100.0)) == 0.0


def test_work_that_somebody_is_on_its_way_to_makes_nobody_idle() -> None:
    simulation = begun(8.0)
    first, second = simulation.missions
    second.strategy = STAY
    while simulation.now < 12.0 and not len(first.strategy):
        simulation.step()
    idleness = Idleness(simulation)
    stand(idleness, simulation, (12.0,))
    classes = views(simulation)
    all_work = idleness.work(classes)
    first.strategy = STAY
    assert np.count_nonzero(idleness.work(classes)) > np.count_nonzero(all_work)


def test_the_table_has_a_line_a_kind_of_world_and_size_of_team_with_the_worst_of_each() -> None:
    slow = replace(RESULT, seed=1, time_s=130.0, last_gain_s=80.0, idle_s=21.0, outcome="unreached")
    lines = crowds_table([RESULT, slow, replace(RESULT, robots=20)]).splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:4]]
    assert rows[0] == ["cave", "8", "2", "1", "100", "50", "4", "21", "0", "0.9991"]
    assert rows[1][:3] == ["cave", "20", "1"]


def test_missions_of_crowds_are_gone_on_with_and_written_line_by_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ran: list[Crowd] = []

    def fake(case: Crowd, commit: str) -> CrowdResult:
        ran.append(case)
        return replace(RESULT, world=case.world, robots=case.robots, seed=case.seed, commit=commit)

    monkeypatch.setattr(bench_crowds, "run_crowd", fake)
    for seeds in ("0", "0,1"):
        options = [
            "--worlds",
            "cave",
            "--robots",
            "8",
            "--seeds",
            seeds,
            "--jobs",
            "1",
            "--out",
            str(tmp_path),
        ]
        assert CliRunner().invoke(crowds, options).exit_code == 0
    assert ran == [Crowd("cave", 8, 0), Crowd("cave", 8, 1)]
    lines = (tmp_path / "crowds.jsonl").read_text(encoding="utf-8").splitlines()
    assert [valid("bench-crowd", line)["seed"] for line in lines] == [0, 1]


def test_a_kind_of_world_that_there_is_not_is_refused(tmp_path: Path) -> None:
    refused = CliRunner().invoke(crowds, ["--worlds", "forest", "--out", str(tmp_path)])
    assert isinstance(refused.exception, InputError)
    assert "office, cave, maze" in str(refused.exception)
