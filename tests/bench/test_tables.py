"""The benchmark's verdicts and tables, the mission table's figures, and how it goes on after a stop."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from bench import __main__ as speed_command
from bench import journal
from bench.cases import MAP_ROBOTS, Case, Result, map_cases, office_cases
from bench.command import WholeNumbers
from bench.criteria import BenchReport, Criterion, Measurement, verdicts
from bench.half_known import half_known
from bench.missions import conduct, missions
from bench.missions_table import JUDGED, judge, missions_table
from bench.speed import Run, run_mission
from bench.table import figure, markdown
from tests.support.schemas import valid
from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.sim.worlds import office
from vedette.team import PlatformSpec

RESULT = Result(
    world="office",
    robots=3,
    planner=JUDGED,
    seed=0,
    outcome="complete",
    completed=True,
    coverage=0.999,
    map_error_share=0.0,
    collisions=0,
    t90_s=80.0,
    t99_s=140.0,
    time_s=200.0,
    path_m=90.0,
    wall_s=5.0,
    commit="abc",
)


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|\n").split("|")]


# -- criteria ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("at_least", "measured", "met"),
    [
        (False, 40.0, True),
        (False, 40.001, False),
        (False, 3.0, True),
        (True, 40.0, True),
        (True, 39.999, False),
        (True, 100.0, True),
        (False, math.nan, False),
        (True, math.nan, False),
    ],
)
def test_a_criterion_is_met_up_to_its_limit_and_not_by_nan(
    at_least: bool, measured: float, met: bool
) -> None:
    criterion = Criterion("x", 40.0, "ms", at_least)
    assert criterion.met(measured) is met
    assert Measurement(criterion, measured, "").verdict == ("MET" if met else "MISSED")


@pytest.mark.parametrize("at_least", [False, True])
@pytest.mark.parametrize("measured", [0.5, 39.0, 40.0, 41.0, 900.0])
def test_the_ratio_is_at_least_one_exactly_where_the_criterion_is_met(
    at_least: bool, measured: float
) -> None:
    criterion = Criterion("x", 40.0, "ms", at_least)
    assert (criterion.ratio(measured) >= 1.0) == criterion.met(measured)


def test_the_verdicts_show_asked_measured_ratio_and_verdict() -> None:
    slow = Measurement(Criterion("replan", 40.0, "ms"), 80.0, "p95")
    fast = Measurement(Criterion("mission", 30.0, "x", at_least=True), 75.0, "")
    lines = verdicts([slow, fast]).splitlines()
    assert cells(lines[2]) == ["replan", "<= 40 ms", "80 ms", "0.5", "MISSED", "p95"]
    assert cells(lines[3]) == ["mission", ">= 30 x", "75 x", "2.5", "MET", ""]


def test_nothing_measured_of_a_thing_asked_to_be_none_is_met() -> None:
    assert (
        cells(verdicts([Measurement(Criterion("collisions", 0.0, ""), 0.0, "")]).splitlines()[2])[4] == "MET"
    )
    assert Measurement(Criterion("collisions", 0.0, ""), 1.0, "").verdict == "MISSED"


@pytest.mark.parametrize(
    ("measured", "verdict"), [(None, "NOT MEASURED"), (math.nan, "MISSED"), (math.inf, "MISSED")]
)
def test_what_has_no_number_is_shown_and_written_as_none(measured: float | None, verdict: str) -> None:
    without = Measurement(Criterion("growth", 1.25, "x"), measured, "why")
    assert cells(verdicts([without]).splitlines()[2])[2:] == [
        "-",
        "0" if measured == math.inf else "-",
        verdict,
        "why",
    ]
    file = BenchReport(about={}, quick=True, measurements=(without.judged(),))
    (written,) = valid("bench", file.to_json())["measurements"]
    assert (written["measured"], written["verdict"]) == (None, verdict)


def test_a_table_has_lines_of_equal_length_and_marks_the_columns_on_the_right() -> None:
    text = markdown(("a", "number"), [("long name", "1"), ("b", "22")], "lr")
    assert len({len(line) for line in text.splitlines()}) == 1
    assert text.splitlines()[1] == "| --------- | -----: |"
    assert text.splitlines()[3] == "| b         |     22 |"


@pytest.mark.parametrize(
    ("value", "shown"),
    [(None, "-"), (math.nan, "-"), (0.0, "0"), (0.12345, "0.1235"), (99.48, "99.48"), (12345.6, "12346")],
)
def test_a_figure_has_four_digits_that_count(value: float | None, shown: str) -> None:
    assert figure(value) == shown


# -- speed ------------------------------------------------------------------------------------------


def test_a_half_known_map_has_half_the_free_cells_and_hardly_an_error() -> None:
    world = office(np.random.default_rng(1), 12.0, 10.0)
    classes = half_known(world, PlatformSpec(range=3.0), np.random.default_rng(1))
    assert 0.5 <= np.mean(classes[~world.solid] != UNKNOWN) < 0.7
    assert np.mean((classes == FREE) & world.solid) < 0.005
    assert np.any((classes == OCCUPIED) & world.solid)


@pytest.fixture(scope="module")
def run() -> Run:
    return run_mission(0, 12.0, 10.0, robots=2, max_time=5.0)


def test_a_run_tells_the_most_that_any_robot_sent_in_kilobytes(run: Run) -> None:
    assert run.negotiation() == max(sent.negotiation for sent in run.summary.bytes.values()) / 1000 > 0
    assert run.fusion() == max(sent.fusion for sent in run.summary.bytes.values()) / 1000 > 0


def test_each_criterion_is_held_against_the_worst_mission(run: Run) -> None:
    slow = replace(run, planning=replace(run.planning, p95=70.0), real_time=2.0)
    quick = replace(run, planning=replace(run.planning, p95=7.0), real_time=200.0)
    assert speed_command.replan(Criterion("", 40.0, "ms"), [quick, slow]).measured == 70.0
    assert speed_command.real_time(Criterion("", 30.0, "x", at_least=True), [quick, slow]).measured == 2.0


def test_the_report_is_json_with_machine_figures_and_verdicts() -> None:
    measured = [Measurement(Criterion("replan", 40.0, "ms"), 80.0, "p95")]
    judged = tuple(each.judged() for each in measured)
    written = valid("bench", BenchReport(about={"machine": "m"}, quick=False, measurements=judged).to_json())
    assert written["about"] == {"machine": "m"}
    assert written["quick"] is False
    assert written["measurements"] == [
        {
            "name": "replan",
            "asked": 40.0,
            "unit": "ms",
            "at_least": False,
            "measured": 80.0,
            "verdict": "MISSED",
            "note": "p95",
        }
    ]


# -- options ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "numbers"),
    [("0-3", (0, 1, 2, 3)), ("1,3,6", (1, 3, 6)), ("7, 1-2", (7, 1, 2)), ("1,1-2", (1, 2))],
)
def test_lists_of_numbers_are_read(text: str, numbers: tuple[int, ...]) -> None:
    assert WholeNumbers(0).convert(text, None, None) == numbers


@pytest.mark.parametrize("text", ["", "x", "1-", "-1", "3-1", "1,,2", "1.5"])
def test_other_lists_are_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"^value must be (numbers or ranges|at least one number).*; got "):
        WholeNumbers(0).convert(text, None, None)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--robots", "0"], "--robots"),
        (["--planners", "tour"], "did you mean 'tours'"),
        (["--only-maps"], "nothing to run"),
        (["--maps", "/nowhere"], "has no maps"),
    ],
)
def test_bad_options_are_told_in_one_line(arguments: list[str], message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        missions.main([*arguments, "--out", str(tmp_path / "out")], standalone_mode=False)
    assert not (tmp_path / "out").exists()


# -- missions ---------------------------------------------------------------------------------------


def test_the_cases_are_every_seed_team_and_planner_and_every_map_in_natural_order(tmp_path: Path) -> None:
    offices = office_cases(range(10), (1, 3, 6), ("tours", "nearest"))
    assert len({case.key for case in offices}) == 60
    for name in ("cave-10", "cave-2", "atrium"):
        (tmp_path / f"{name}.yaml").touch()
    maps = map_cases(tmp_path, ("tours",))
    assert [case.key for case in maps] == [
        (name, MAP_ROBOTS, "tours", 0) for name in ("atrium", "cave-2", "cave-10")
    ]


def fake(case: Case, commit: str) -> Result:
    world, robots, planner, seed = case.key
    if seed == 13:
        raise RuntimeError("unlucky")
    return replace(RESULT, world=world, robots=robots, planner=planner, seed=seed, commit=commit)


def test_missions_done_before_are_not_run_again(tmp_path: Path) -> None:
    path, said, ran = tmp_path / "missions.jsonl", [""], [0]

    def counted(case: Case, commit: str) -> Result:
        ran[0] += 1
        return fake(case, commit)

    assert conduct(office_cases((0, 1), (3,), ("tours",)), path, 1, said.append, counted, Result) == 0
    assert conduct(office_cases((0, 1, 2), (3,), ("tours",)), path, 1, said.append, counted, Result) == 0
    assert ran[0] == 3
    assert [done.seed for done in journal.read(path, Result).values()] == [0, 1, 2]
    assert "2 of 3 missions done before; 1 to run" in said


def test_a_mission_that_breaks_is_told_and_counted_and_the_others_go_on(tmp_path: Path) -> None:
    path, said = tmp_path / "missions.jsonl", [""]
    assert conduct(office_cases((12, 13, 14), (3,), ("tours",)), path, 1, said.append, fake, Result) == 1
    assert [done.seed for done in journal.read(path, Result).values()] == [12, 14]
    assert any("office 13, 3 robots, tours: broke: RuntimeError('unlucky')" in line for line in said)


def test_an_interrupted_mission_is_no_result(tmp_path: Path) -> None:
    path = tmp_path / "missions.jsonl"
    with pytest.raises(KeyboardInterrupt):
        conduct(
            [Case(3, "tours")],
            path,
            1,
            lambda _: None,
            lambda *_: replace(RESULT, outcome="interrupted"),
            Result,
        )
    assert journal.read(path, Result) == {}


def test_the_journal_gives_back_what_was_put_in_and_forgets_what_it_is_told_to(tmp_path: Path) -> None:
    path = tmp_path / "missions.jsonl"
    other = replace(RESULT, seed=1, t99_s=None, coverage=0.1 + 0.2)
    journal.append(path, RESULT)
    journal.append(path, other)
    assert [valid("bench-mission", line)["world"] for line in path.read_text().splitlines()]
    assert journal.read(path, Result) == {RESULT.key: RESULT, other.key: other}
    journal.forget(path, {RESULT.key}, Result)
    assert journal.read(path, Result) == {other.key: other}


@pytest.mark.parametrize("line", ["{", "[]", '{"world": "office"}', json.dumps(asdict(RESULT))[:-9]])
def test_a_broken_line_in_the_journal_is_named(line: str, tmp_path: Path) -> None:
    path = tmp_path / "missions.jsonl"
    journal.append(path, RESULT)
    with path.open("a") as file:
        file.write(line)
    with pytest.raises(InputError, match="line 2: not a result; delete the line"):
        journal.read(path, Result)


def test_the_table_has_a_row_a_group_and_planner_with_least_most_sum_and_mean() -> None:
    results = [
        RESULT,
        replace(RESULT, seed=1, completed=False, coverage=0.98, t99_s=None, time_s=500.0, collisions=2),
        replace(RESULT, seed=2, map_error_share=0.004, t90_s=110.0, t99_s=160.0, time_s=260.0),
        replace(RESULT, planner="nearest", time_s=400.0),
        replace(RESULT, world="cave", robots=1),
    ]
    rows = [cells(line) for line in missions_table(results).splitlines()[2:]]
    assert [row[:2] for row in rows] == [
        ["offices, 3 robots", JUDGED],
        ["offices, 3 robots", "nearest"],
        ["cave, 1 robot", JUDGED],
    ]
    assert rows[0][2:] == ["2/3", "98.00", "0.400", "2", "90", "150 (2/3)", "320", "260", "90"]


def test_the_criteria_judge_the_default_alone_and_name_the_worst_mission() -> None:
    results = [
        RESULT,
        replace(RESULT, seed=4, coverage=0.994, completed=False, outcome="time_limit"),
        replace(RESULT, seed=5, coverage=0.90),
        replace(RESULT, planner="nearest", collisions=3, map_error_share=1.0),
    ]
    complete, coverage, errors, collisions = judge(results)
    assert complete.measured == pytest.approx(200 / 3)
    assert (complete.verdict, complete.note) == ("MISSED", "offices, 3 robots, seed 4 (time_limit)")
    assert coverage.measured == pytest.approx(90.0)
    assert (coverage.verdict, coverage.note) == ("MISSED", "missed by 2, most by offices, 3 robots, seed 5")
    assert (errors.verdict, collisions.verdict) == ("MET", "MET")


def test_yardsticks_alone_are_not_judged() -> None:
    assert judge([replace(RESULT, planner="nearest")]) == []
