"""Tests say what they would fail at: by relative errors unless told, by what an error says, by bounds."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.support.places import ROOT

WIDE = {"ValueError", "TypeError", "KeyError", "RuntimeError", "AssertionError", "Exception"}
OURS = {"InputError", "LookupError", "OSError"}  # are known by what they say, too, here or afterwards


@cache
def nodes() -> list[tuple[Path, ast.AST]]:
    """Return all that stands in the tests, with its file."""
    files = (ROOT / "tests").rglob("*.py")
    return [(path, node) for path in files for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))]


def calls() -> Iterator[tuple[Path, ast.Call]]:
    for path, node in nodes():
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


def test_an_input_error_is_known_by_what_it_says_or_looked_at_afterwards() -> None:
    blocks = [(path, item) for path, node in nodes() if isinstance(node, ast.With) for item in node.items]
    raised = [
        (path, item, item.context_expr)
        for path, item in blocks
        if isinstance(item.context_expr, ast.Call)
        and ast.unparse(item.context_expr.func) == "pytest.raises"
        and ast.unparse(item.context_expr.args[0]) in OURS
    ]
    assert len(raised) > 100
    unsaid = [
        f"{path.relative_to(ROOT)}:{call.lineno}"
        for path, item, call in raised
        if item.optional_vars is None and "match" not in {word.arg for word in call.keywords}
    ]
    assert unsaid == []


def is_a_count(node: ast.expr) -> bool:
    """Tell whether it is a length, a count, or a field of a summary, none of which is ever below 0."""
    if isinstance(node, ast.Call):
        return ast.unparse(node.func).rpartition(".")[2] in ("len", "count", "count_nonzero")
    return isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant)


def always_holds(less: ast.expr, more: ast.expr, or_equal: bool) -> bool:
    """Tell whether ``less < more``, or ``<=``, holds by construction: 0 <= a count, x < x + 1."""
    if isinstance(more, ast.BinOp) and isinstance(more.op, ast.Add):
        return ast.unparse(less) in (ast.unparse(more.left), ast.unparse(more.right))
    return or_equal and isinstance(less, ast.Constant) and less.value == 0 and is_a_count(more)


def held_by_construction(compare: ast.Compare) -> bool:
    sides = (compare.left, *compare.comparators)
    return any(
        always_holds(
            *((b, a) if isinstance(op, (ast.Gt, ast.GtE)) else (a, b)), isinstance(op, (ast.LtE, ast.GtE))
        )
        for a, op, b in zip(sides, compare.ops, sides[1:], strict=False)
        if isinstance(op, (ast.Lt, ast.LtE, ast.Gt, ast.GtE))
    )


@pytest.mark.parametrize(
    ("said", "blunt"),
    [
        ("summary['frontiers'] >= 0", True),
        ("0 <= len(found) < 3", True),
        ("alone < alone + 1e4 < faint", True),
        ("len(found) > 0", False),
        ("np.diff(times).min() >= 0", False),
        ("alone + 1e4 < faint", False),
        ("found <= best + 1e-9", False),
    ],
)
def test_what_holds_by_construction_can_be_told(said: str, blunt: bool) -> None:
    compare = ast.parse(said, mode="eval").body
    assert isinstance(compare, ast.Compare)
    assert held_by_construction(compare) is blunt


def test_no_bound_holds_by_construction() -> None:
    bounds = [
        (path, compare)
        for path, node in nodes()
        if isinstance(node, ast.Assert)
        for compare in ast.walk(node.test)
        if isinstance(compare, ast.Compare)
    ]
    assert len(bounds) > 1000
    assert [f"{path.relative_to(ROOT)}:{at.lineno}" for path, at in bounds if held_by_construction(at)] == []
