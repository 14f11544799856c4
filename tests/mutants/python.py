"""Mutants of the Python code, by mutmut: it knows which tests come by which function."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

from tests.mutants.tree import TESTS, TREE, WORK

_MUTATED = (
    "problem/*", "negotiation/*", "fusion/*", "overlay/*", "agent/round.py", "agent/rounds.py",
    "domains/*", "kernels/*",
)  # fmt: skip
_LEFT = ("domains/mapping/baselines/*", "kernels/reference/*")  # yardsticks, and the tests' own oracle
_CONFIG = f"""
[tool.mutmut]
source_paths = ["src"]
only_mutate = {json.dumps([f"src/vedette/{each}" for each in _MUTATED])}
do_not_mutate = {json.dumps([f"src/vedette/{each}" for each in _LEFT])}
do_not_mutate_patterns = ['raise \\w+', 'assert ']
also_copy = ["bench", "docs", "examples", "tools", "README.md"]
pytest_add_cli_args = ["-p", "no:cacheprovider", "-p", "no:randomly", "--hypothesis-profile=ci"]
pytest_add_cli_args_test_selection = {json.dumps([*TESTS, "-m", "not slow"])}
use_git_change_detection = false
"""
_MAKE = """
from mutmut import __main__ as mutmut
from mutmut.mutation.trampoline import set_mutant_under_test
set_mutant_under_test("mutant_generation")
mutmut.copy_src_dir(); mutmut.copy_also_copy_files(); mutmut.setup_source_paths(); mutmut.create_mutants(1)
mutmut.collect_or_load_stats(mutmut.get_mutant_runner(1))
"""
_KILLED = {1, 3, 24, -24, 36, 152, 255, -11, -9}  # exit codes: a failed test, no end, a crash
_NO_TESTS = {5, 33}


def mutants() -> list[str]:
    """Make all mutants in the copy, run all tests once to see which come by what, and return the names."""
    pyproject = TREE / "pyproject.toml"
    pyproject.write_text(pyproject.read_text(encoding="utf-8") + _CONFIG, encoding="utf-8")
    with (WORK / "make.log").open("w", encoding="utf-8") as log:
        subprocess.run(
            [sys.executable, "-c", _MAKE], cwd=TREE, env=_env(), check=True, stdout=log, stderr=log
        )
    return sorted(_codes())


def run(names: list[str], seconds: float) -> dict[str, str]:
    """Test these for so long; return what became of those that were."""
    process = subprocess.Popen([_tool(), "run", "--max-children", "1", *names], cwd=TREE, env=_env())
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT)
        process.wait()
    codes = _codes()
    return {name: _verdict(codes[name]) for name in names if codes[name] is not None}


def shown(name: str) -> str:
    """Return a mutant as a diff."""
    return subprocess.run(
        [_tool(), "show", name], cwd=TREE, env=_env(), check=True, capture_output=True, text=True
    ).stdout


def _verdict(code: int | None) -> str:
    return "killed" if code in _KILLED else "no tests" if code in _NO_TESTS else "survived"


def _codes() -> dict[str, int | None]:
    """Return the exit code of each mutant's tests, None where they have not run."""
    found: dict[str, int | None] = {}
    for path in (TREE / "mutants").rglob("*.meta"):
        found |= json.loads(path.read_text(encoding="utf-8"))["exit_code_by_key"]
    return found


def _tool() -> str:
    return str(Path(sys.executable).with_name("mutmut"))


def _env() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": ""}
