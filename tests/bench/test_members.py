"""Teams with a member that misbehaves, as the bench judges them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from bench import members
from bench.journal import append
from bench.members import ALL, MemberResult, measure, modes_of, results, sizes_of, table
from tests.support.small_missions import room_with_a_wall
from vedette.errors import InputError


def result(mode: str, **changes: object) -> MemberResult:
    """A team of three that is good enough in everything."""
    good = {"robots": 3, "time_s": 140.0, "known": 0.995, "wrong": 0.004, "named_s": 12.0, "rounds": 9}
    return MemberResult(**{"mode": mode, **good, "load": 1.0, "commit": "abc", **changes})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("changes", "verdict"),
    [
        ({}, "MET"),
        ({"time_s": 151.0}, "MISSED: late"),
        ({"known": 0.98}, "MISSED: known"),
        ({"wrong": 0.006}, "MISSED: wrong"),
        ({"named_s": 31.0}, "MISSED: not named"),
        ({"named_s": None, "known": 0.5}, "MISSED: known, not named"),
    ],
)
def test_a_team_is_held_against_the_one_whose_member_is_dead(
    changes: dict[str, object], verdict: str, tmp_path: Path
) -> None:
    for each in (result("mute", **changes), result("dead", time_s=100.0, named_s=None)):
        append(tmp_path / "members.jsonl", each)
    *_, dead, mute = table(tmp_path / "members.jsonl").splitlines()
    assert dead.split("|")[-2].strip() == "MET"
    assert mute.split("|")[-2].strip() == verdict


def test_what_has_been_run_is_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran = []

    def run(mode: str, robots: int, *_: object) -> MemberResult:
        ran.append((mode, robots))
        return result(mode, robots=robots)

    monkeypatch.setattr(members, "measure", run)
    path = tmp_path / "members.jsonl"
    assert len(list(results(path, ["mute"], [3], 4.0, "abc"))) == 2
    assert len(list(results(path, ["mute", "echo"], [3, 5], 4.0, "abc"))) == 6
    assert ran == [("dead", 3), ("mute", 3), ("echo", 3), ("dead", 5), ("mute", 5), ("echo", 5)]
    assert len([json.loads(line) for line in path.read_text().splitlines()]) == 6


def test_modes_and_sizes_are_named() -> None:
    assert modes_of("all") == ALL
    assert modes_of("hung,double") == ("hung", "double")
    with pytest.raises(InputError, match="unknown mode 'hang'; did you mean 'hung'"):
        modes_of("hang")
    assert sizes_of("3,5") == (3, 5)
    for wrong in ("2", "3,", "many"):
        with pytest.raises(InputError, match="numbers from 3 on"):
            sizes_of(wrong)


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["dead", "mute", "double"])
def test_the_others_finish_and_name_it(mode: str) -> None:
    found = measure(mode, 3, room_with_a_wall(0.1), 5.0, "abc")
    print(f"\n{found}")
    assert found.outcome == "done"
    assert found.known >= 0.99
    assert (found.named_s is None) == (mode == "dead")
