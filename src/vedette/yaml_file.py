"""YAML files that people write: read within bounds, every mistake told in one line."""

from __future__ import annotations

import codecs
import re
from pathlib import Path
from typing import Any

import yaml

from vedette.errors import InputError
from vedette.file_kind import check_kind
from vedette.input_file import open_input

_MOST = 1_000_000  # [characters]
_MOST_REFERRED = 100_000  # values that all references of a file together may stand for
_FLOAT = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)[eE][-+]?\d+")


class _Refused(yaml.MarkedYAMLError):
    """YAML allows it, we do not."""


class _Loader(yaml.SafeLoader):
    """Reads 5e-2 as the number that it is, which YAML 1.1 takes for text; refuses a key that is given twice.

    What references stand for is bounded: with them (``*name``) a short text can stand for a huge one, and for
    one that holds itself.
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

    def compose_mapping_node(self, anchor: Any) -> yaml.MappingNode:
        """Return a mapping that gives no key twice; it may give what it merges (``<<``) gives as well."""
        mapping = super().compose_mapping_node(anchor)
        lines: dict[tuple[str, str], int] = {}
        for key, _ in mapping.value:
            if not isinstance(key, yaml.ScalarNode):
                continue
            if (key.tag, key.value) in lines:
                problem = f"{key.value!r} is given twice, first in line {lines[key.tag, key.value]}; keep one"
                raise _Refused(problem=problem, problem_mark=key.start_mark)
            lines[key.tag, key.value] = key.start_mark.line + 1
        return mapping

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


class _TextLoader(_Loader):
    """Leaves every scalar as it is written, but nothing for null; tags mean nothing."""

    def construct_undefined(self, node: yaml.Node) -> Any:
        """Return what the tag stands before."""
        if isinstance(node, yaml.ScalarNode):
            return self.construct_scalar(node)
        if isinstance(node, yaml.SequenceNode):
            return self.construct_sequence(node, deep=True)
        assert isinstance(node, yaml.MappingNode)
        return self.construct_mapping(node, deep=True)


for _kind in ("bool", "int", "float", "binary", "timestamp"):
    _TextLoader.add_constructor(f"tag:yaml.org,2002:{_kind}", _TextLoader.construct_scalar)
_TextLoader.add_constructor(None, _TextLoader.construct_undefined)


def read_yaml(path: Path, what: str, remedy: str) -> Any:
    """Return what a YAML file says, as plain data; None if it is empty.

    ``what`` the file should be, and a ``remedy`` that says how such files are written, go into messages.

    Raises:
        InputError: unreadable, no file, longer than a million characters, or not YAML; or it holds half a
            character (``"\\ud800"``), a key twice, a tag, a second document, or references (``*name``) that
            stand for very much or for themselves; or it is plainly another kind of file.
    """
    return _parsed(path, what, remedy, _Loader)


def read_yaml_texts(path: Path, what: str, remedy: str) -> Any:
    """Return what a YAML file says, each scalar as the text that stands there, as yaml-cpp takes it.

    A tag means nothing, and only the first document counts.

    Raises:
        InputError: as :func:`read_yaml`, but for tags and other documents.
    """
    return _parsed(path, what, remedy, _TextLoader)


def yaml_text(path: Path, what: str, remedy: str = "write less") -> str:
    """Return the text of a YAML file, whatever its encoding.

    Raises:
        InputError: unreadable, no file, or longer than a million characters.
    """
    with open_input(path, what) as file:
        try:
            raw = file.read(4 * _MOST + 4)
        except OSError as error:
            raise InputError(f"cannot read {what} {path}: {error.strerror or error}") from error
    text = _decoded(raw)
    if len(text) > _MOST:
        raise InputError(f"{path}: more than {_MOST} characters; {remedy}")
    return text


def _decoded(raw: bytes) -> str:
    """Return the text: UTF-16 with its mark, else UTF-8, else what Windows took Latin-1 for."""
    marked = raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        return raw.decode("utf-16" if marked else "utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def _parsed(path: Path, what: str, remedy: str, kind: type[_Loader]) -> Any:
    """Return what a file of the kind that was asked for says."""
    content = _content(yaml_text(path, what, remedy), path, remedy, kind)
    check_kind(content, what, path)
    return content


def _content(text: str, path: Path, remedy: str, kind: type[_Loader]) -> Any:
    try:
        loader: Any = kind(text)
        content = loader.get_data() if loader.check_data() else None
        if kind is _Loader and loader.check_data():
            mark = loader.peek_event().start_mark
            raise _Refused(problem="a second document begins here; keep one", problem_mark=mark)
        return content
    except yaml.MarkedYAMLError as error:
        line = f", line {error.problem_mark.line + 1}" if error.problem_mark else ""
        own = isinstance(error, _Refused)
        problem = error.problem if own else f"not valid YAML, {error.problem}; {remedy}"
        raise InputError(f"{path}{line}: {problem}") from error
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a YAML text; {remedy}") from error
