"""YAML files that people write: read within bounds, every mistake told in one line."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml

from vedette.errors import InputError

_MOST = 1_000_000  # [characters]
_MOST_REFERRED = 100_000  # values that all references of a file together may stand for
_FLOAT = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)[eE][-+]?\d+")


class _Refused(yaml.MarkedYAMLError):
    """YAML allows it, we do not."""


class _Loader(yaml.SafeLoader):
    """Reads 5e-2 as the number that it is, which YAML 1.1 takes for text; bounds what references stand for.

    With references (``*name``) a short text can stand for a huge one, and for one that holds itself.
    """

    def __init__(self, stream: str) -> None:
        super().__init__(stream)
        self._values = 0  # so far, those that references stand for included
        self._referred = 0  # of them by references
        self._sizes: dict[str, int] = {}  # values under each name that is complete

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        """Return the next node."""
        event: Any = self.peek_event()  # type: ignore[no-untyped-call]
        if isinstance(event, yaml.AliasEvent):
            self._refer(event)
            return super().compose_node(parent, index)
        before = self._values
        self._values += 1
        node = super().compose_node(parent, index)
        if event.anchor is not None:
            self._sizes[event.anchor] = self._values - before
        return node

    def _refer(self, event: Any) -> None:
        """Count what a reference stands for; one to a name that nobody has given is left to YAML."""
        size = self._sizes.get(event.anchor, 0)
        if event.anchor in self.anchors and size == 0:
            problem = f"'*{event.anchor}' stands for something that holds it; write it out"
            raise _Refused(problem=problem, problem_mark=event.start_mark)
        self._values += size
        self._referred += size
        if self._referred > _MOST_REFERRED:
            problem = f"references such as '*{event.anchor}' stand for more than {_MOST_REFERRED} values"
            raise _Refused(problem=f"{problem}; use fewer", problem_mark=event.start_mark)

    def construct_scalar(self, node: yaml.ScalarNode | yaml.MappingNode) -> str:
        """Return a scalar's text, unless it cannot be written down again."""
        text: str = super().construct_scalar(node)
        if any("\ud800" <= character <= "\udfff" for character in text):
            problem = f"{text!a} holds half a character; write the whole"
            raise _Refused(problem=problem, problem_mark=node.start_mark)
        return text


_Loader.add_implicit_resolver("tag:yaml.org,2002:float", _FLOAT, list("-+.0123456789"))


def read_yaml(path: Path, what: str, remedy: str) -> Any:
    """Return what a YAML file says, as plain data; None if it is empty.

    ``what`` the file should be, and a ``remedy`` that says how such files are written, go into messages.

    Raises:
        InputError: unreadable, longer than a million characters, or not YAML; or it holds half a character
            (``"\\ud800"``), or references (``*name``) that stand for very much or for themselves.
    """
    try:
        with path.open(encoding="utf-8") as file:
            text = file.read(_MOST + 1)
    except OSError as error:
        raise InputError(f"cannot read {what} {path}: {error.strerror or error}") from error
    except ValueError as error:
        raise InputError(f"{path}: not a YAML text; {remedy}") from error
    if len(text) > _MOST:
        raise InputError(f"{path}: more than {_MOST} characters; {remedy}")
    return _parsed(text, path, remedy)


def _parsed(text: str, path: Path, remedy: str) -> Any:
    try:
        return yaml.load(text, _Loader)
    except yaml.MarkedYAMLError as error:
        line = f", line {error.problem_mark.line + 1}" if error.problem_mark else ""
        problem = error.problem if isinstance(error, _Refused) else f"not valid YAML; {remedy}"
        raise InputError(f"{path}{line}: {problem}") from error
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a YAML text; {remedy}") from error
