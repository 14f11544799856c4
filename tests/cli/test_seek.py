"""``vedette search --unknown-map``: its files, its status, and one clear line for whatever is wrong."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.support.commands import FILES, Command, refused
from tests.support.schemas import valid
from tests.support.small_missions import small_maze


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command, run in a folder with a maze."""
    monkeypatch.chdir(tmp_path)
    Path("maze").mkdir()
    small_maze().save(Path("maze"))
    return Command(monkeypatch, capsys, "search")


def test_a_search_in_an_unknown_map_leaves_its_files_and_says_who_found_whom(vedette: Command) -> None:
    ran = vedette("--unknown-map", "maze/map.yaml", "--robots", 2, "--seed", 5, "--out", "out")
    assert ran.status == 0, ran.err
    assert {path.name for path in Path("out").iterdir()} >= FILES["explore"]
    summary = valid("seek-summary", Path("out/summary.json").read_bytes())
    assert (summary["outcome"], summary["order"], summary["reach_m"]) == ("found", "map-first", 3.0)
    told = f"found after {summary['time_s']:.0f} s by {summary['found_by']}: somebody at "
    assert told in ran.out


def test_json_prints_the_summary_alone_and_a_time_limit_is_not_found(vedette: Command) -> None:
    ran = vedette("--unknown-map", "maze/map.yaml", "--robots", 1, "--reach", 0.5, "--max-time", 2, "--json")
    assert ran.status == 1, ran.err
    summary = json.loads(ran.out)
    assert (summary["outcome"], summary["found_s"], summary["found_by"]) == ("time_limit", None, None)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            ("--unknown-map", "--trials", 3),
            "--trials is of vehicles in a known area; leave it, or --unknown-map",
        ),
        (("--unknown-map", "--no-compare"), "--no-compare is of vehicles in a known area"),
        (("--unknown-map", "--coordination", "none"), "--coordination is of vehicles in a known area"),
        (("--robots", 2), "--robots is of searches with --unknown-map"),
        (("--order", "map-first"), "--order is of searches with --unknown-map"),
        (("--unknown-map", "--order", "togther"), "unknown order 'togther'; did you mean 'together'?"),
        (("--unknown-map", "--reach", 0), "--reach must be above 0 and at most 100 m; got '0'"),
        (("--unknown-map", "--robots", 0), "--robots must be at least 1; got 0"),
        (("--unknown-map", "nowhere.yaml"), "nowhere.yaml"),
        (("--unknown-map", "--resolution", 0.1), "--resolution goes with a MAP that is an image"),
        (("--unknown-map", "maze/map.yaml", "--kill", "4@3"), "there is no robot 4 in a team of 3"),
    ],
)
def test_what_does_not_go_together_is_one_line(
    vedette: Command, arguments: tuple[object, ...], said: str
) -> None:
    refused(vedette(*arguments), said)
