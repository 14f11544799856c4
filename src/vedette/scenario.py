"""Scenario files: YAML, checked against the type that describes them, every mistake told in one line."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from reprlib import repr as repr_short
from typing import Annotated, Any, TypeVar

import msgspec
from msgspec import Meta

from vedette.errors import InputError, nearest_name
from vedette.schema import in_words, shown
from vedette.yaml_file import read_yaml

T = TypeVar("T")

Name = Annotated[
    str, Meta(pattern=r"^[A-Za-z0-9._-]{0,64}$", description="letters, digits, '.', '_' or '-', at most 64")
]
Metre = Annotated[float, Meta(ge=-2.1e7, le=2.1e7)]  # a coordinate: UTM's northing reaches 1e7 m


def load_scenario(path: Path | str, kind: type[T], what: str = "scenario") -> T:
    """Read a YAML file as a value of ``kind``, a ``msgspec.Struct`` that forbids unknown fields.

    ``what`` the file is goes into messages.

    Raises:
        InputError: unreadable, not YAML, a field that is unknown (with the nearest valid name), missing, of
            the wrong type or out of its range, or a number that is not finite; the line names file and field.
    """
    content = read_yaml(Path(path), what, f"a {what} is 'field: value' pairs")
    return as_scenario({} if content is None else content, kind, str(path))


def as_scenario(content: Any, kind: type[T], where: str, known: Sequence[str] | None = None) -> T:
    """Return plain data as a value of ``kind``; an `InputError` begins with ``where``.

    A dataclass, which does not forbid unknown fields, takes those that are ``known``: its own, if not told.
    """
    if not isinstance(content, Mapping):
        raise InputError(f"{where}: must be 'field: value' pairs; got {shown(content)}")
    if known is None and is_dataclass(kind):
        known = [field.name for field in fields(kind)]
    for name in content:
        if known is not None and name not in known:
            raise InputError(f"{where}: unknown field {repr_short(name)}; {nearest_name(str(name), known)}")
    _refuse_infinite(content, where, "")
    try:
        return msgspec.convert(content, kind)
    except msgspec.ValidationError as error:
        raise InputError(f"{where}: {in_words(str(error), content, kind)}") from None


def names_of(kind: str, given: Iterable[str]) -> list[str]:
    """Return what each is called: as given, ``kind-N`` where that is nothing."""
    return [name or f"{kind}-{i}" for i, name in enumerate(given, 1)]


def as_one_of(kinds: Mapping[str, type[T]], content: Any, where: str) -> T:
    """Return plain data as a value of the kind that its ``type`` names; else as `as_scenario`."""
    if not isinstance(content, Mapping):
        raise InputError(f"{where}: must be 'field: value' pairs with a type; got {shown(content)}")
    name = content.get("type")
    if not isinstance(name, str) or name not in kinds:
        raise InputError(f"{where}: unknown type {repr_short(name)}; {nearest_name(str(name), kinds)}")
    rest = {field: value for field, value in content.items() if field != "type"}
    return as_scenario(rest, kinds[name], where)


def _refuse_infinite(value: Any, where: str, place: str) -> None:
    if isinstance(value, Mapping):
        for key, item in value.items():
            _refuse_infinite(item, where, f"{place}.{key}")
    elif isinstance(value, list):
        for number, item in enumerate(value):
            _refuse_infinite(item, where, f"{place}[{number}]")
    elif isinstance(value, float) and not math.isfinite(value):
        raise InputError(f"{where}: {place.lstrip('.')}: must be a finite number; got {value}")
