"""Scenario files: YAML, checked against the type that describes them, every mistake told in one line."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from reprlib import repr as repr_short
from typing import Annotated, Any, TypeVar

import msgspec
from msgspec import Meta, inspect

from vedette.errors import InputError, nearest_name
from vedette.yaml_file import read_yaml

T = TypeVar("T")

Name = Annotated[str, Meta(pattern=r"^[A-Za-z0-9._-]{0,64}$")]
Metre = Annotated[float, Meta(ge=-2.1e7, le=2.1e7)]  # a coordinate: UTM's northing reaches 1e7 m

_PLACE = re.compile(r"(?P<what>.*?)(?: - at `\$(?P<place>[^`]*)`)?")
_STEP = re.compile(r"\.([^.\[\]]+)|\[(\d+)\]")


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
        raise InputError(f"{where}: must be 'field: value' pairs; got {repr_short(content)}")
    if known is None and is_dataclass(kind):
        known = [field.name for field in fields(kind)]
    for name in content:
        if known is not None and name not in known:
            raise InputError(f"{where}: unknown field {repr_short(name)}; {nearest_name(str(name), known)}")
    _refuse_infinite(content, where, "")
    try:
        return msgspec.convert(content, kind)
    except msgspec.ValidationError as error:
        raise InputError(f"{where}: {_in_words(str(error), content, kind)}") from None


def as_one_of(kinds: Mapping[str, type[T]], content: Any, where: str) -> T:
    """Return plain data as a value of the kind that its ``type`` names; else as `as_scenario`."""
    if not isinstance(content, Mapping):
        raise InputError(f"{where}: must be 'field: value' pairs with a type; got {repr_short(content)}")
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


def _in_words(error: str, content: Any, kind: type[Any]) -> str:
    """Say what msgspec found, with the field, the value and the nearest valid name."""
    found = _PLACE.fullmatch(error)
    assert found is not None
    what, place = found["what"], found["place"] or ""
    schema: inspect.Type | None = inspect.type_info(kind)
    value = content
    for name, number in _STEP.findall(place):
        schema = _inside(schema, name, value)
        value = _item(value, name, number)
    field = f"{place.lstrip('.')}: " if place else ""
    if unknown := re.fullmatch(r"Object contains unknown field `(.*)`", what):
        return f"{field}unknown field {unknown[1]!r}; {nearest_name(unknown[1], _fields(schema, value))}"
    if re.match(r"Invalid (enum )?value", what):
        return f"{field}unknown {_last(place)} {value!r}; {nearest_name(str(value), _words(schema))}"
    what = what[0].lower() + what[1:]
    return f"{field}{what}" + ("" if isinstance(value, Mapping) else f"; it is {repr_short(value)}")


def _last(place: str) -> str:
    return re.sub(r"\[\d+\]", "", place).split(".")[-1] or "value"


def _item(value: Any, name: str, number: str) -> Any:
    try:
        return value[name] if name else value[int(number)]
    except (KeyError, IndexError, TypeError):
        return None


def _structs(schema: inspect.Type | None) -> list[inspect.StructType]:
    if isinstance(schema, inspect.UnionType):
        return [kind for kind in schema.types if isinstance(kind, inspect.StructType)]
    return [schema] if isinstance(schema, inspect.StructType) else []


def _chosen(schema: inspect.Type | None, value: Any) -> list[inspect.StructType]:
    """Return the structs that a value can be, by its tag if it has one."""
    structs = _structs(schema)
    tagged = [
        s for s in structs if s.tag_field and isinstance(value, dict) and value.get(s.tag_field) == s.tag
    ]
    return tagged or structs


def _inside(schema: inspect.Type | None, name: str, value: Any) -> inspect.Type | None:
    """Return the type of a field, or of an item if ``name`` is empty."""
    if not name:
        if isinstance(schema, inspect.UnionType):
            lists = [
                kind for kind in schema.types if isinstance(kind, inspect.ListType | inspect.VarTupleType)
            ]
            schema = lists[0] if lists else None
        return schema.item_type if isinstance(schema, inspect.ListType | inspect.VarTupleType) else None
    for struct in _chosen(schema, value):
        if name == struct.tag_field:
            return inspect.LiteralType(tuple(str(s.tag) for s in _structs(schema)))
        for field in struct.fields:
            if field.encode_name == name:
                return field.type
    return None


def _fields(schema: inspect.Type | None, value: Any) -> list[str]:
    structs = _chosen(schema, value)
    tags = [str(struct.tag_field) for struct in structs if struct.tag_field]
    return list(dict.fromkeys([*tags, *(field.encode_name for struct in structs for field in struct.fields)]))


def _words(schema: inspect.Type | None) -> list[str]:
    if isinstance(schema, inspect.LiteralType):
        return [str(word) for word in schema.values]
    return []
