"""The study of held-out worlds: what comes first, what is unfinished, and what is asked."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bench import held_out as bench_held_out
from bench.held_out import BETWEEN, STARTS, buildings, in_order, runs
from bench.held_out_table import NEAREST, OURS, REFERENCE, counted, judged, report
from tests.support.recordings import carmen_log
from vedette.sim.worlds import GENERATORS, maze
from vedette.study.mission import RunResult
from vedette.study.run import MapWorld, Run
from vedette.study.workers import Workers

LARGE = [MapWorld(Path(f"{name}.yaml"), None, name, name, 0.1) for name in ("small", "large")]


def row(
    planner: str, world: str, seed: int, time: float, robots: int = 3, **more: object
) -> dict[str, object]:
    return {
        "planner": planner, "world": world, "world_id": f"{world} {seed}", "seed": 0, "robots": robots,
        "case": f"{world} {seed} {robots}", "max_time": 1000.0, "completed": True, "error": "",
        "t90_s": time / 4, "t99_s": time / 2, "time_s": time, **more,
    }  # fmt: skip


def lines_of(text: str) -> list[list[str]]:
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines() if "|" in line]


def test_every_kind_of_world_comes_before_the_second_and_other_starts_come_last() -> None:
    order = list(in_order(range(2 * BETWEEN), LARGE, (3, 8)))
    assert len(order) == len(set(order)) == 2 * (2 * BETWEEN * len(GENERATORS) + STARTS * len(LARGE))
    names = [world.name for (world, _), robots in order if robots == 3][: BETWEEN * len(GENERATORS) + 1]
    assert names == [*(list(GENERATORS) * BETWEEN), "small"]
    last = [place for place, _ in order[-2 * len(LARGE) * (STARTS - 1) :]]
    assert {start for _, start in last} == {1, 2}


def test_planners_are_run_side_by_side_and_one_robot_by_nearest_too() -> None:
    found = runs((5,), [], (3, 1), 77.0)
    by_case = [
        [run.setup.planner for run in found if run.case == case]
        for case in dict.fromkeys(r.case for r in found)
    ]
    assert by_case == [[OURS, REFERENCE]] * 3 + [[OURS, REFERENCE, NEAREST]] * 3
    assert {run.setup.max_time for run in found} == {77.0}
    assert [run.case for run in found] == sorted(
        (run.case for run in found), key=[r.case for r in found].index
    )


def test_what_is_unfinished_stays_and_counts_against_the_planner_that_is_judged() -> None:
    late = {"completed": False, "t99_s": None}
    ours, other = counted([row(OURS, "cave", 1, 400.0, **late), row(REFERENCE, "cave", 1, 500.0, **late)])
    assert [ours[name] for name in ("t90_s", "t99_s", "time_s")] == [100.0, 1000.0, 1000.0]
    assert [other[name] for name in ("t90_s", "t99_s", "time_s")] == [125.0, 500.0, 500.0]


def test_the_table_pairs_by_world_and_tells_what_is_unfinished() -> None:
    rows = [row(OURS, "cave", 1, 80.0), row(REFERENCE, "cave", 1, 100.0)]
    rows += [row(OURS, "kth", 2, 45.0), row(REFERENCE, "kth", 2, 100.0), row(OURS, "maze", 3, 1.0)]
    rows += [row(OURS, "maze", 4, 5.0, error="it broke"), row(REFERENCE, "maze", 4, 5.0)]
    rows += [row(OURS, "office", 5, 10.0, completed=False), row(REFERENCE, "office", 5, 1000.0)]
    found = {line[1]: line for line in lines_of(report(rows))[2:] if line[0] == "3"}
    assert set(found) == {"all", "cave", "office", "kth", "real buildings"}
    assert found["cave"][3:7] == ["1", "0.80", "0.80", "0.80"]
    assert found["all"][3] == "3"
    assert found["all"][6].startswith("0.71 (")  # the cube root of 0.80 * 0.45 * 1
    assert found["office"][4:8] == ["0.01", "0.01", "1.00", "1 : 0"]
    assert found["all"][8] == "3"


@pytest.mark.parametrize(("factor", "verdict"), [(0.71, "MET"), (0.73, "MISSED")])
def test_ratios_are_held_against_what_is_asked(factor: float, verdict: str) -> None:
    rows = []
    for robots in (1, 3, 8):
        for world in GENERATORS:
            rows += [row(planner, world, 1, 100.0, robots) for planner in (REFERENCE, NEAREST)]
            rows.append(row(OURS, world, 1, 100.0 * factor, robots))
    found = {each.criterion.name: each for each in judged(rows)}
    assert len(found) == 8
    assert (
        found["3 robots, 90 %, of burgard"].verdict == found["8 robots, 90 %, of burgard"].verdict == verdict
    )
    assert found["1 robot, complete, of nearest"].measured == pytest.approx(factor)
    assert found["any kind of world, of burgard"].verdict == "MET"
    rows.append(row(OURS, "maze", 2, 300.0, 8))
    rows.append(row(REFERENCE, "maze", 2, 100.0, 8))
    worst = judged(rows)[-1]
    assert worst.verdict == "MISSED"
    assert worst.note.startswith("maze, 8 robots")
    assert worst.measured == pytest.approx((3 * factor) ** 0.5)


def test_a_log_becomes_a_map_and_the_smaller_building_comes_first(tmp_path: Path) -> None:
    small, large = (maze(np.random.default_rng(1), side, side) for side in (10.0, 14.0))
    (tmp_path / "plan").mkdir()
    plan = large.save(tmp_path / "plan")
    (tmp_path / "hall.log").write_text(carmen_log(small))
    found = buildings([plan, tmp_path / "hall.log"], tmp_path / "worlds")
    assert [building.name for building in found] == ["hall", "plan"]
    assert np.mean(found[1].build().solid == large.solid) == 1.0


def test_missions_that_are_there_are_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[Run] = []

    def fake(run: Run) -> RunResult:
        ran.append(run)
        figures = {name: row(run.setup.planner, "", 0, 100.0)[name] for name in ("t90_s", "t99_s", "time_s")}
        return RunResult(
            {**figures, "outcome": "complete", "completed": True, "error": ""}, {}, (), (), (), ()
        )

    monkeypatch.setattr(bench_held_out, "Workers", functools.partial(Workers, work=fake))
    for seeds, status in (("300", 0), ("300-301", 0)):
        options = ["--seeds", seeds, "--robots", "3", "--jobs", "1", "--out", str(tmp_path / "out")]
        done = CliRunner().invoke(bench_held_out.held_out, options)
        assert done.exit_code == status, done.output
    assert len(ran) == len(set(ran)) == 2 * 2 * len(GENERATORS)
    assert "Missions: 12 of 12, 0 broke." in (tmp_path / "out" / "held-out.md").read_text()
    late = ["--seeds", "302", "--minutes", "0", "--jobs", "1", "--out", str(tmp_path / "out")]
    assert CliRunner().invoke(bench_held_out.held_out, late).exit_code == 1
    assert len(ran) == 12
