"""However a mission ends, files, screen and exit status say the same."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from tests.support.commands import Command
from vedette.cli.exploring import closing
from vedette.cli.running import end
from vedette.outcome import Outcome
from vedette.record.explore.summary import ExploreSummary, LeftOut


def summary(outcome: Outcome, left_out: tuple[LeftOut, ...] = ()) -> ExploreSummary:
    return ExploreSummary(
        completed=outcome.completed, outcome=outcome, lost=(), left=(), seed=1, robots=1, planner="tours",
        scheme="token", fusion="replicated", world="hall", radio=None, faults=None, time_s=60.0,
        t50_s=20.0, t90_s=50.0, t95_s=None, t99_s=None, auc_s=30.0, coverage=0.92, known_m2=120.0,
        rate_m2_s=2.0, frontiers=3, beyond=0, no_go_m2=0.0, cut_off_m2=0.0, expected=None, turned_back=(),
        map_errors=0, map_error_share=0.0,
        pose_error_m={"robot-1": 0.0},
        path_m={"robot-1": 12.0}, overlap=0.0, collisions=0, min_clearance_m=0.2, rounds=9, sweeps=9,
        bound_ratio=None, apart_s=0.0, messages={}, bytes={}, maps=(), left_out=left_out,
    )  # fmt: skip


@pytest.mark.parametrize("outcome", Outcome)
def test_file_screen_and_exit_status_agree(outcome: Outcome, capsys: pytest.CaptureFixture[str]) -> None:
    for as_json in (True, False):
        with pytest.raises(SystemExit) as exit_:
            end(summary(outcome), closing(summary(outcome), Path("runs")), as_json)
        assert exit_.value.code == outcome.status
        said = capsys.readouterr().out
        if as_json:
            figures = json.loads(said)
            assert (figures["outcome"], figures["completed"]) == (outcome.value, outcome.completed)
        else:
            assert said.startswith(f"{outcome.value.replace('_', ' ')}: 92.0 % of hall")
            assert (outcome.meaning in said) != outcome.completed


def test_of_ground_that_nobody_knows_area_rate_and_frontiers_are_told_and_never_a_share() -> None:
    open_ended = replace(summary(Outcome.COMPLETE), coverage=None, auc_s=None, t50_s=None, t90_s=None)
    line = closing(open_ended, Path("runs"))[0]
    assert line.startswith("complete: 120 m2 of hall known after 60 s (2.00 m2/s, 3 frontiers left), longest")
    assert "%" not in line


def test_only_ends_with_status_0_are_completed_or_ordered() -> None:
    assert {outcome for outcome in Outcome if outcome.status == 0} == {
        Outcome.ORDERED, *(outcome for outcome in Outcome if outcome.completed)
    }  # fmt: skip


def test_what_there_was_no_room_for_is_counted_with_the_remedy() -> None:
    lines = closing(replace(summary(Outcome.COMPLETE), beyond=1), Path("runs"))
    assert lines[1] == (
        "left out: 1 beam farther off than there is room for; --area says where the ground is"
    )


def test_what_is_left_out_is_counted_by_its_reason() -> None:
    spots = [LeftOut(1.0, k, 9, "unreached" if k else "unseeable", "robot-1") for k in (0.0, 1.0, 2.0)]
    lines = closing(summary(Outcome.COMPLETE, tuple(spots)), Path("runs"))
    assert lines[1] == "frontiers left out: 1 unseeable, 2 unreached; summary.json lists them"


@pytest.mark.parametrize(
    ("ways", "said"),
    [
        ((12.0, 1.1), "0 collisions"),
        ((12.0, 0.9), "0 collisions, 1 robot never left its start"),
        ((0.0, 0.9), "0 collisions, 2 robots never left their start"),
    ],
)
def test_robots_that_never_left_their_start_are_counted(ways: tuple[float, ...], said: str) -> None:
    driven = {f"robot-{number}": way for number, way in enumerate(ways, start=1)}
    lines = closing(replace(summary(Outcome.COMPLETE), path_m=driven), Path("runs"))
    assert lines[0].endswith(f" m, {said}")


def test_who_was_lost_is_named_in_the_summary_and_in_the_last_words(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    vedette, maze, folder = Command(monkeypatch, capsys), tmp_path / "maze", tmp_path / "run"
    ran = vedette("world", "maze", "--seed", 1, "--width", 10, "--height", 10, "--out", maze)
    assert ran.status == 0, ran.err
    ran = vedette("explore", maze / "map.yaml", "--robots", 2, "--kill", "2@3", "--out", folder)
    assert json.loads((folder / "summary.json").read_text())["lost"] == ["robot-2"]
    assert "lost on the way: robot-2" in ran.out
