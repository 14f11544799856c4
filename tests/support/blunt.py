"""A plugin for pytest that tells of what nothing could have failed; ``make blunt`` runs the tests with it.

By the line where they stand: numbers that lie within the tolerance of 0 each time that they are compared, so
that 0 would pass as well; ``all(...)`` that was true each time because there was nothing; and asserts that no
case of a test came by, in a loop over nothing or behind a condition that is never met.
"""

from __future__ import annotations

import ast
import builtins
import sys
from collections import defaultdict
from collections.abc import Callable, Generator, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from _pytest.approx import ApproxScalar

_root = Path()  # of the project whose tests run
_sharp: dict[str, bool] = defaultdict(bool)  # by line: whether it could have failed at any time
_passed: dict[Path, set[int]] = defaultdict(set)  # lines of asserts that held, by file
_run: dict[Path, set[str]] = defaultdict(set)  # functions of which all cases passed so far, by file
_not_run: dict[Path, set[str]] = defaultdict(set)


def pytest_configure(config: pytest.Config) -> None:
    """Look at what is compared from now on."""
    global _root
    _root = config.rootpath
    if not config.getini("enable_assertion_pass_hook"):
        raise pytest.UsageError("tests.support.blunt needs -o enable_assertion_pass_hook=true")
    same = ApproxScalar.__eq__

    def equals(expected: ApproxScalar, actual: object) -> bool:
        if isinstance(expected.expected, (int, float)):
            _note(expected.expected == 0 or not abs(expected.expected) <= expected.tolerance)
        return same(expected, actual)

    ApproxScalar.__eq__ = equals  # type: ignore[method-assign]
    np.testing.assert_allclose = _arrays(np.testing.assert_allclose, atol=0.0)
    np.allclose = _arrays(np.allclose, atol=1e-8)
    np.isclose = _arrays(np.isclose, atol=1e-8)


def pytest_collection_finish(session: pytest.Session) -> None:
    """Let the tests' modules, and what they share, take our ``all`` for the builtin."""
    shared = [module for name, module in sys.modules.items() if name.startswith("tests.")]
    for module in (*shared, *(item.module for item in session.items if isinstance(item, pytest.Function))):
        module.__dict__.setdefault("all", _all)


def pytest_assertion_pass(item: pytest.Item, lineno: int) -> None:
    """Note that an assert held."""
    _passed[item.path].add(lineno)


def pytest_deselected(items: Sequence[pytest.Item]) -> None:
    """Note of which functions not all cases are run."""
    for item in items:
        _not_run[item.path].add(_function(item))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Note which functions ran."""
    report = yield
    (_run if report.passed else _not_run)[item.path].add(_function(item))
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Tell the lines at which nothing could have failed."""
    blunt = [f"{line}: nothing could have failed it" for line, sharp in _sharp.items() if not sharp]
    for path, functions in _run.items():
        name = path.relative_to(_root)
        blunt += [f"{name}:{line}: never ran" for line in _idle(path, functions - _not_run[path])]
    for line in sorted(blunt):
        terminalreporter.write_line(f"BLUNT {line}")


def _idle(path: Path, functions: set[str]) -> list[int]:
    """Return the lines of the asserts in these functions that no case came by."""
    return [
        node.lineno
        for function in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(function, ast.FunctionDef) and function.name in functions
        for node in ast.walk(function)
        if isinstance(node, ast.Assert) and node.lineno not in _passed[path]
    ]


def _function(item: pytest.Item) -> str:
    return getattr(item, "originalname", item.name)


def _arrays(compare: Callable[..., Any], atol: float) -> Callable[..., Any]:
    """Return a comparison of arrays that notes whether 0 would have passed."""

    def compared(actual: Any, expected: Any, *args: Any, **words: Any) -> Any:
        size = np.abs(np.asarray(expected, dtype=float))
        absolute = np.broadcast_to(args[1] if len(args) > 1 else words.get("atol", atol), size.shape)
        _note(not ((size <= absolute) & np.isfinite(size)).all() or not size.any())
        return compare(actual, expected, *args, **words)

    return compared


def _all(truths: Iterable[object]) -> bool:
    """Do as the builtin does, and note whether there was anything."""
    found = list[object]()
    for truth in truths:
        found.append(truth)
        if not truth:
            break
    _note(bool(found))
    return builtins.all(found)


def _note(sharp: bool) -> None:
    """Note of the line of a test that is being run whether it could have failed."""
    frame = sys._getframe(2)
    while frame is not None:
        file = Path(frame.f_code.co_filename)
        if file.is_relative_to(_root / "tests") and file != Path(__file__):
            _sharp[f"{file.relative_to(_root)}:{frame.f_lineno}"] |= sharp
            return
        frame = frame.f_back
