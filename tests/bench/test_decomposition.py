"""What the bench of where robots' time goes tells apart, and its table."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bench import decomposition as bench_decomposition
from bench.decomposition import KINDS, LOOK, PHASES, Case, Decomposition, Shares, decomposition_table
from tests.support.schemas import valid
from tests.support.small_missions import begun
from vedette.sim.explore.run import views
from vedette.sim.explore.simulation import ExploreSimulation

RESULT = Shares(
    world="cave", robots=3, planner="tours", seed=0, outcome="complete", time_s=70.0,
    seconds={phase: dict.fromkeys(KINDS, 2.0) for phase in PHASES}, cpu_s=9.0, commit="abc",
)  # fmt: skip


def told(simulation: ExploreSimulation, shift: float, turn: float) -> dict[str, float]:
    """What is told of the half second in which all that a team does is to be moved so far and turned."""
    decomposition = Decomposition(simulation)
    decomposition.look(views(simulation))
    before = decomposition.seconds()
    simulation.robots.bodies.poses[:, 0] += shift
    simulation.robots.bodies.poses[:, 2] += turn
    decomposition.look(views(simulation))
    after = decomposition.seconds()
    kinds = {kind: sum(after[phase][kind] - before[phase][kind] for phase in PHASES) for kind in KINDS}
    return {kind: seconds for kind, seconds in kinds.items() if seconds}


def test_what_nobody_has_seen_is_new_and_what_is_known_is_not() -> None:
    simulation = begun(8.0)
    decomposition = Decomposition(simulation)
    decomposition.look(views(simulation))
    assert decomposition.seconds()[PHASES[0]]["new area"] == LOOK  # each has seen what the other has not
    assert told(simulation, 0.2, 0.0) == {"known ground": LOOK}
    assert told(simulation, 0.0, 0.2) == {"turning": LOOK}
    assert told(simulation, 0.0, 2 * np.pi) == {"standing": LOOK}


def test_the_time_of_who_gives_way_is_told_apart() -> None:
    simulation = begun(8.0)
    simulation.drivers[0].refuge = np.zeros((1, 2))
    assert told(simulation, 0.2, 0.0) == {"known ground": LOOK / 2, "giving way": LOOK / 2}


def test_all_time_until_a_robot_has_finished_is_of_one_kind(tmp_path: Path) -> None:
    result = bench_decomposition.run_case(Case("maze", 1, "nearest", 0), "abc")
    seconds = sum(sum(kinds.values()) for kinds in result.seconds.values())
    assert seconds == pytest.approx(result.time_s, abs=2 * LOOK)
    valid("bench-decomposition", json.dumps(asdict(result)))


def test_the_table_has_means_by_kind_and_phase() -> None:
    longer = {phase: dict.fromkeys(KINDS, 4.0) for phase in PHASES}
    late = replace(RESULT, seed=1, time_s=130.0, seconds=longer)
    table = decomposition_table([RESULT, late, replace(RESULT, planner="burgard")])
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:4]]
    assert rows[1] == ["cave", "3", "tours", "2", "100", *["9 (3/3/3)"] * len(KINDS)]
    assert rows[0][2:5] == ["burgard", "1", "70"]


def test_missions_are_gone_on_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[Case] = []

    def fake(case: Case, commit: str) -> Shares:
        ran.append(case)
        return replace(RESULT, seed=case.seed, commit=commit)

    monkeypatch.setattr(bench_decomposition, "run_case", fake)
    for seeds in ("0", "0,1"):
        options = ["--worlds", "cave", "--planners", "tours", "--seeds", seeds, "--jobs", "1"]
        run = CliRunner().invoke(bench_decomposition.decomposition, [*options, "--out", str(tmp_path)])
        assert run.exit_code == 0
    assert ran == [Case("cave", 3, "tours", 0), Case("cave", 3, "tours", 1)]
