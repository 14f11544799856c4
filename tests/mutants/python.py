"""Mutants of the Python code: mutmut's operators on what functions do, decorated ones too."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import libcst as cst
from libcst.metadata import MetadataWrapper, PositionProvider
from mutmut.mutation.mutators import mutation_operators

from tests.mutants import tree

if TYPE_CHECKING:
    from collections.abc import Iterator

_MUTATED = (
    "problem/", "negotiation/", "fusion/", "overlay/", "agent/round.py", "agent/rounds.py",
    "domains/", "kernels/",
)  # fmt: skip
_LEFT = ("domains/mapping/baselines/", "kernels/reference/")  # yardsticks, and the tests' own oracle
_NOTHING_AT_RUN_TIME = (cst.Annotation, cst.Decorator, cst.Raise, cst.Assert)  # what raise says is prose
_PLAIN = {"len", "isinstance", "cast"}  # calls that hold for types alone, or break at once


class Mutant(NamedTuple):
    """One node of a file, and what takes its place."""

    name: str  # file:line:column: before -> after
    node: cst.CSTNode
    other: cst.CSTNode


def mutants() -> list[str]:
    """Return the names of all mutants of the copy."""
    return [each.name for path in _files() for each in _of(path)[1]]


def put(copy: Path, name: str) -> bool:
    """Put one mutant into a worker's copy; return whether what comes of it is Python."""
    path = copy / name.split(":")[0]
    mutated = shown(name)
    try:
        compile(mutated, path.name, "exec")
    except SyntaxError:
        return False
    path.write_text(mutated, encoding="utf-8")
    return True


def shown(name: str) -> str:
    """Return a mutant's file as it would be."""
    module, mutant = _named(name)
    return module.deep_replace(mutant.node, mutant.other).code  # type: ignore[attr-defined]


def lines_of(name: str) -> range:
    """Return the lines that a mutant's node covers."""
    module, mutant = _named(name)
    position = MetadataWrapper(module, unsafe_skip_copy=True).resolve(PositionProvider)[mutant.node]
    return range(position.start.line, position.end.line + 1)


def _named(name: str) -> tuple[cst.Module, Mutant]:
    module, found = _of(tree.TREE / name.split(":")[0])
    return module, next(each for each in found if each.name == name)


def _files() -> list[Path]:
    source = tree.TREE / "src/vedette"
    return sorted(
        path
        for path in source.rglob("*.py")
        if (name := str(path.relative_to(source))).startswith(_MUTATED) and not name.startswith(_LEFT)
    )


def _of(path: Path) -> tuple[cst.Module, list[Mutant]]:
    """Return a file and its mutants in the order of the file, no two alike."""
    wrapper = MetadataWrapper(cst.parse_module(path.read_text(encoding="utf-8")))
    visitor = _Visitor(str(path.relative_to(tree.TREE)))
    module = wrapper.visit(visitor)
    return module, list(visitor.found.values())


class _Visitor(cst.CSTVisitor):
    """Collects what the operators make of each node within a function."""

    METADATA_DEPENDENCIES = (PositionProvider,)

    def __init__(self, file: str) -> None:
        super().__init__()
        self.found: dict[str, Mutant] = {}
        self._file = file
        self._depth = 0

    def on_visit(self, node: cst.CSTNode) -> bool:
        if isinstance(node, _NOTHING_AT_RUN_TIME) or _is_plain(node):
            return False
        if self._depth:
            for other in _others(node):
                self._add(node, other)
        self._depth += isinstance(node, cst.FunctionDef)
        return True

    def on_leave(self, original_node: cst.CSTNode) -> None:
        self._depth -= isinstance(original_node, cst.FunctionDef)

    def _add(self, node: cst.CSTNode, other: cst.CSTNode) -> None:
        start = self.get_metadata(PositionProvider, node).start
        name = f"{self._file}:{start.line}:{start.column + 1}: {_text(node)} -> {_text(other)}"
        self.found.setdefault(name, Mutant(name, node, other))


def _is_plain(node: cst.CSTNode) -> bool:
    return isinstance(node, cst.Call) and isinstance(node.func, cst.Name) and node.func.value in _PLAIN


def _others(node: cst.CSTNode) -> Iterator[cst.CSTNode]:
    for kind, operator in mutation_operators:
        if isinstance(node, kind):
            yield from operator(node)


def _text(node: cst.CSTNode) -> str:
    return " ".join(cst.Module([]).code_for_node(node).split())
