"""The sample of mutants: the seed says which, and what was tested is not tested again."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.mutants import __main__ as mutants

DIFFS = {f"rust/{k}": f"-{k}\n+{k + 1}\n" for k in range(30)} | {
    f"vedette.x_{k}__mutmut_1": "" for k in range(170)
}


def test_a_seed_draws_the_same_mutants_in_whatever_order_they_are_listed() -> None:
    one = mutants.draw(7, 40, "abc", DIFFS)
    other = mutants.draw(7, 40, "abc", dict(reversed(DIFFS.items())))
    assert one == other
    assert len(one.diffs) == 40 < one.of == 200
    assert one.diffs.items() <= DIFFS.items()
    assert mutants.draw(8, 40, "abc", DIFFS).diffs != one.diffs
    assert mutants.draw(7, 1000, "abc", DIFFS).diffs == DIFFS


def test_a_piece_goes_on_where_the_last_one_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mutants, "SAMPLE", tmp_path / "sample.json")
    monkeypatch.setattr(mutants.tree, "copy", lambda: "abc")
    monkeypatch.setattr(mutants.rust, "mutants", lambda: {k: d for k, d in DIFFS.items() if d})
    monkeypatch.setattr(mutants.python, "mutants", lambda: [k for k, d in DIFFS.items() if not d])
    tested: list[str] = []

    def some(names: list[str], seconds: float) -> dict[str, str]:
        tested.extend(names[:9])
        return dict.fromkeys(names[:9], "killed")

    def one(name: str, diff: str) -> str:
        assert DIFFS[name] == diff
        tested.append(name)
        return "survived"

    monkeypatch.setattr(mutants.rust, "run", one)
    monkeypatch.setattr(mutants.python, "run", some)
    pieces = 0
    while (sample := mutants.sample_of(3, 40)).left:
        mutants.go_on(sample, minutes=30.0)
        pieces += 1
    assert pieces > 2
    assert sorted(tested) == sorted(sample.diffs) == sorted(sample.verdicts)
    assert mutants.sample_of(None, 40).seed == 3
    assert mutants.sample_of(4, 40).left
