"""The comment beside a field (its shape, unit, frame) stands in the API reference too."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from functools import cache

from sphinx.application import Sphinx
from sphinx.pycode import ModuleAnalyzer

FOR_TOOLS = ("noqa", "type: ", "fmt: ")


def setup(app: Sphinx) -> dict[str, bool]:
    """Let Sphinx find such a comment as it finds those that begin with ``#:``."""
    analyze = ModuleAnalyzer.analyze

    def analyze_all(analyzer: ModuleAnalyzer) -> None:
        analyze(analyzer)
        for place, comment in comments(analyzer.code).items():
            analyzer.attr_docs.setdefault(place, [re.sub(r"([*`|_\\])", r"\\\1", comment), ""])

    ModuleAnalyzer.analyze = analyze_all  # type: ignore[method-assign]
    # Before napoleon, which takes what stands before a field's first colon for its type.
    app.connect("autodoc-process-docstring", keep_whole, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def keep_whole(app: Sphinx, what: str, name: str, value: object, options: object, lines: list[str]) -> None:
    """Give a field's text a first line that has no colon and shows nothing."""
    if what in ("attribute", "data", "property"):
        lines[:0] = ["..", ""]


@cache
def comments(source: str) -> dict[tuple[str, str], str]:
    """Return the comments beside a module's names and its classes' fields, by class (or "") and name."""
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    found = [token for token in tokens if token.type == tokenize.COMMENT]
    by_line = {token.start[0]: token.string.lstrip("# ") for token in found}
    return dict(_named(ast.parse(source).body, "", by_line))


def _named(
    body: list[ast.stmt], scope: str, by_line: dict[int, str]
) -> Iterator[tuple[tuple[str, str], str]]:
    for statement in body:
        if isinstance(statement, ast.ClassDef):
            yield from _named(statement.body, f"{scope}.{statement.name}".lstrip("."), by_line)
        elif isinstance(statement, ast.AnnAssign | ast.Assign):
            targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
            comment = by_line.get(statement.end_lineno or 0, "")
            for target in targets:
                if isinstance(target, ast.Name) and comment and not comment.startswith(FOR_TOOLS):
                    yield (scope, target.id), comment
