"""The bench of large worlds and teams: one mission measured, its table, and what it goes on with."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner

from bench.large import __main__ as bench_large
from bench.large.cases import Large, LargeResult, Size, run_large
from bench.large.tables import judge, large_table
from bench.large.trees import Version, built, present
from tests.support.schemas import valid
from vedette.errors import InputError

RESULT = LargeResult(
    width=200, height=200, resolution=0.1, robots=50, max_time=20.0, outcome="time_limit", coverage=0.125,
    time_s=20.0, cpu_s=16.0, planning_p50_ms=10.0, planning_p95_ms=20.0, peak_bytes=1_600_000_000,
    record_bytes=1000, sent_bytes=2000.0, commit="new",
)  # fmt: skip
BEFORE, AFTER = Version("before", "old", Path("python")), Version("after", "new", Path(sys.executable))


def test_a_mission_is_measured_in_a_process_of_its_own() -> None:
    here = Version("after", "abc", Path(sys.executable))
    result = run_large(Large(Size(12, 10, 0.1, 2), 3.0, here), "unused")
    assert (result.outcome, result.time_s, result.commit) == ("time_limit", 3.0, "abc")
    assert result.factor == result.time_s / result.cpu_s > 0.0
    assert result.peak_bytes > 2**24
    assert 0.0 < result.coverage < 1.0
    assert min(result.record_bytes, result.sent_bytes) > 0


def test_only_missions_of_this_version_are_judged_by_factor_and_memory() -> None:
    text = large_table([replace(RESULT, commit="old", cpu_s=1000.0), RESULT], [BEFORE, AFTER])
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines()]
    assert [row[:3] for row in rows[2:4]] == [
        ["200x200 m at 0.1 m, 50 robots", "before", "0.02"],
        ["200x200 m at 0.1 m, 50 robots", "after", "1.25"],
    ]
    assert [(each.criterion.limit(), each.verdict) for each in judge([RESULT])] == [
        (">= 1 x real time", "MET"),
        ("<= 1500 MB", "MISSED"),
    ]
    assert text.count("MET") + text.count("MISSED") == 2


def test_nothing_is_asked_of_sizes_that_have_no_target() -> None:
    assert judge([replace(RESULT, robots=16)]) == []


def test_missions_are_gone_on_with_unless_the_code_is_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ran: list[tuple[Size, str]] = []

    def fake(case: Large, commit: str) -> LargeResult:
        ran.append((case.size, case.version.commit))
        size = case.size._asdict()
        return replace(RESULT, **size, max_time=case.max_time, commit=case.version.commit)

    monkeypatch.setattr(bench_large, "run_large", fake)
    for commit, robots in (("one", "1"), ("one", "1,4"), ("two", "1")):
        monkeypatch.setattr(bench_large, "present", lambda commit=commit: replace(AFTER, commit=commit))
        options = ["--worlds", "30x20", "--resolutions", "0.1", "--robots", robots, "--jobs", "1"]
        done = CliRunner().invoke(bench_large.large, [*options, "--max-time", "20", "--out", str(tmp_path)])
        assert done.exit_code == 0
    one, four = Size(30, 20, 0.1, 1), Size(30, 20, 0.1, 4)
    assert ran == [(one, "one"), (four, "one"), (one, "two")]
    lines = (tmp_path / "large.jsonl").read_text(encoding="utf-8").splitlines()
    assert [valid("bench-large", line)["commit"] for line in lines] == ["one", "one", "two"]


def test_this_version_runs_by_the_python_that_runs_the_bench() -> None:
    assert present().python == Path(sys.executable)


def test_a_commit_that_there_is_not_is_refused() -> None:
    with pytest.raises(InputError, match="no-such-commit"):
        built("no-such-commit")


@pytest.mark.parametrize("options", [["--worlds", "60"], ["--resolutions", "fine"], ["--robots", "0"]])
def test_sizes_that_make_no_sense_are_refused(options: list[str], tmp_path: Path) -> None:
    refused = CliRunner().invoke(bench_large.large, [*options, "--out", str(tmp_path)])
    assert isinstance(refused.exception, InputError)
    assert options[0] in str(refused.exception)
