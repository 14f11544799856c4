"""Mutants: drawn alike by a seed, tested once each, and told by the tests that come by them."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.mutants import __main__ as mutants
from tests.mutants import python, rust, tree
from tests.mutants.cover import Cover
from tests.mutants.sample import Sample, draw
from tests.mutants.trial import Trial, run
from tests.mutants.worker import Worker

DIFFS = {f"rust/src/a.rs:{k}: a": f"-{k}\n+{k + 1}\n" for k in range(30)} | {
    f"src/vedette/a.py:{k}:1: a -> b": "" for k in range(170)
}
TOY = '''"""A toy."""


def larger(a: int, b: int) -> int:
    """The larger of two."""
    if a < 0:
        raise ValueError("a < 0")
    return a if a > b else b


def until(n: int) -> int:
    k = 0
    while k < n:
        k += 1
    return k
'''
TESTS = """import vedette.problem.toy as toy

def test_the_larger():
    assert toy.larger(2, 1) == 2 and toy.larger(1, 2) == 2

def test_until():
    assert toy.until(3) == 3
"""
FILE = "src/vedette/problem/toy.py"
TOY_TESTS = "tests/problem/test_toy.py"


def test_a_seed_draws_the_same_mutants_in_whatever_order_they_are_listed() -> None:
    one, other = draw(7, 40, "abc", DIFFS), draw(7, 40, "abc", dict(reversed(DIFFS.items())))
    assert one == other
    assert len(one.diffs) == 40 < one.of == 200
    assert one.diffs.items() <= DIFFS.items()
    assert draw(8, 40, "abc", DIFFS).diffs != one.diffs
    assert draw(7, 1000, "abc", DIFFS).diffs == DIFFS


def test_a_piece_goes_on_where_the_last_one_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mutants, "SAMPLE", tmp_path / "sample.json")
    monkeypatch.setattr(tree, "copy", lambda: "abc")
    monkeypatch.setattr(rust, "mutants", lambda: {k: d for k, d in DIFFS.items() if d})
    monkeypatch.setattr(python, "mutants", lambda: [k for k, d in DIFFS.items() if not d])
    tested: list[str] = []

    def test(name: str, diff: str) -> Trial:
        assert DIFFS[name] == diff
        tested.append(name)
        if len(tested) == 13:
            raise KeyboardInterrupt
        return Trial("survived" if len(tested) % 3 else "killed", "a test")

    with pytest.raises(KeyboardInterrupt):
        mutants.go_on(mutants.sample_of(3, 40), [test], minutes=30.0)
    assert len(mutants.sample_of(None, 40).left) == 28
    mutants.go_on(mutants.sample_of(None, 40), [test, test], minutes=30.0)
    sample = mutants.sample_of(None, 40)
    assert (sample.seed, sample.left) == (3, [])
    assert sorted({*tested}) == sorted(sample.diffs)
    assert len(tested) == 41  # the one that was stopped at, twice
    assert mutants.sample_of(4, 40).left


def test_who_is_interrupted_in_the_middle_of_writing_has_what_was_written_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def half(path: Path, text: str, **_: Any) -> None:
        path.write_bytes(text[: len(text) // 2].encode())
        raise KeyboardInterrupt

    path = tmp_path / "sample.json"
    draw(7, 40, "abc", DIFFS).save(path)
    monkeypatch.setattr(Path, "write_text", half)
    with pytest.raises(KeyboardInterrupt):
        draw(8, 40, "abc", DIFFS).save(path)
    assert Sample.load(path).seed == 7


def test_only_what_a_trial_says_something_of_counts() -> None:
    verdicts = ("killed", "endless", "survived", "no tests", "unbuildable", "unended")
    sample = Sample(1, "abc", 10, dict.fromkeys(verdicts, ""), {each: Trial(each) for each in verdicts})
    assert sorted(sample.tested) == ["endless", "killed", "no tests", "survived"]
    assert sample.alive == ["survived", "no tests"]
    assert "4 tested, 2 killed (the rate is between 15.0% and 85.0%)" in mutants.told(sample)


@pytest.fixture
def toy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of a project of one file."""
    root = tmp_path / "tree"
    for name, text in {
        FILE: TOY,
        "src/vedette/__init__.py": "",
        "src/vedette/problem/__init__.py": "",
        TOY_TESTS: TESTS,
        tree.KERNELS: "",
        "pytest.ini": "[pytest]\n",
    }.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")
    shutil.copytree(Path(__file__).parent, root / "tests/mutants", ignore=shutil.ignore_patterns("test_*"))
    monkeypatch.setattr(tree, "WORK", tmp_path)
    monkeypatch.setattr(tree, "TREE", root)
    return root


def test_every_node_of_a_function_that_does_something_is_mutated_and_nothing_else(toy: Path) -> None:
    names = python.mutants()
    assert f"{FILE}:8:19: > b -> >= b" not in names
    changed = {name.split(": ", 1)[1] for name in names}
    assert {"> b -> >= b", "< n -> <= n", "k += 1 -> k -= 1", "1 -> 2", "k = 0 -> k = None"} <= changed
    assert not [each for each in changed if "a < 0" in each and "ValueError" in each]
    assert len(names) == len(set(names)) > 10


def test_a_mutant_is_killed_by_what_comes_by_it_survives_or_has_no_end(toy: Path) -> None:
    subprocess.run(
        [sys.executable, "-m", "tests.mutants.cover", "cover.json", "-q", "tests/problem"],
        cwd=toy, env={"PYTHONPATH": "src"}, check=True, capture_output=True,
    )  # fmt: skip
    cover = Cover.load(toy / "cover.json")
    assert cover.by(FILE, 8) == {f"{TOY_TESTS}::test_the_larger"}
    worker = Worker(tree.of_worker(0), cover)
    names = {name.split(": ", 1)[1]: name for name in python.mutants()}
    assert worker.test(names["> b -> >= b"], "") == Trial("survived")
    assert worker.test(names["k = 0 -> k = None"], "") == Trial("killed", f"{TOY_TESTS}::test_until")
    assert (worker.tree / FILE).read_text(encoding="utf-8") == TOY  # taken out again


def test_a_kernels_mutant_concerns_the_calls_of_its_topic_and_of_those_that_use_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(tree, "TREE", tree.ROOT)
    search = rust.calls_of("rust/src/search/paths.rs:1: a")
    lines = (tree.ROOT / "src/vedette/kernels/search.py").read_text(encoding="utf-8").splitlines()
    calls = [k for k, line in enumerate(lines, 1) if "_kernels." in line and "import" not in line]
    assert search == [("src/vedette/kernels/search.py", k) for k in calls]
    planes = {Path(file).stem for file, _ in rust.calls_of("rust/src/planes.rs:1: a")}
    assert planes == {"coverage", "distance", "visibility"}


def test_what_has_no_end_is_stopped(toy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.mutants.trial._AT_LEAST", 2.0)
    (toy / FILE).write_text(TOY.replace("k += 1", "k -= 1"), encoding="utf-8")
    test = f"{TOY_TESTS}::test_until"
    assert run(toy, [test], 0.0) == Trial("endless", test)
