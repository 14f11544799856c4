"""Tests say what they would fail at: by relative errors unless told, and by what an error says."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from tests.support.places import ROOT

WIDE = {"ValueError", "TypeError", "KeyError", "RuntimeError", "AssertionError", "Exception"}


def calls() -> Iterator[tuple[Path, ast.Call]]:
    for path in (ROOT / "tests").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call):
                yield path, node


def test_arrays_are_compared_within_a_tolerance_that_is_told() -> None:
    """NumPy's ``allclose`` and ``isclose`` let 1e-8 pass for nothing unless they are told an ``atol``."""
    silent = [
        f"{path.relative_to(ROOT)}:{call.lineno}"
        for path, call in calls()
        if ast.unparse(call.func) in ("np.allclose", "np.isclose")
        and "atol" not in {word.arg for word in call.keywords}
        and path != ROOT / "tests/project/test_blunt.py"
    ]
    assert silent == []


def test_an_error_of_a_wide_kind_is_known_by_what_it_says() -> None:
    raised = [
        (path, call) for path, call in calls() if ast.unparse(call.func) == "pytest.raises" and call.args
    ]
    assert len(raised) > 100
    unsaid = [
        f"{path.relative_to(ROOT)}:{call.lineno}"
        for path, call in raised
        if ast.unparse(call.args[0]) in WIDE and "match" not in {word.arg for word in call.keywords}
    ]
    assert unsaid == []
