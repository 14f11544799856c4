"""One word a thing: a public class name is defined once, and a word stands once in a table of notation.md."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator

from tests.support.places import ROOT

SOURCES = ("src/vedette", "reproduction/vedette_reproduction")
TWICE: frozenset[str] = frozenset()  # names that two things may share; say why where one is added


def public_classes() -> dict[str, list[str]]:
    """Files that define each public class name at their top level."""
    found: defaultdict[str, list[str]] = defaultdict(list)
    for source in SOURCES:
        for path in sorted((ROOT / source).rglob("*.py")):
            for node in ast.parse(path.read_text(encoding="utf-8")).body:
                if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                    found[node.name].append(path.relative_to(ROOT).as_posix())
    return dict(found)


def words_by_table() -> Iterator[list[str]]:
    """First cells of the rows of each table of the notation."""
    table: list[str] = []
    for line in (ROOT / "docs" / "notation.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("|"):
            table.append(line.split("|")[1].strip())
        elif table:
            yield table[2:]
            table = []


def test_a_public_class_name_is_used_once() -> None:
    classes = public_classes()
    assert len(classes) > 300
    shared = {name: files for name, files in classes.items() if len(files) > 1 and name not in TWICE}
    assert shared == {}


def test_a_word_stands_once_in_a_table_of_the_notation() -> None:
    tables = list(words_by_table())
    assert len(tables) > 5
    for table in tables:
        assert sorted(table) == sorted(set(table))
