"""What a type takes, said to people: the field, the value it has, and what it must be."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from reprlib import repr as repr_short
from typing import Any, TypeAlias

from msgspec import inspect

from vedette.errors import nearest_name

_Fields: TypeAlias = inspect.StructType | inspect.DataclassType

_PLACE = re.compile(r"(?P<what>.*?)(?: - at `\$(?P<place>[^`]*)`)?", re.DOTALL)
_STEP = re.compile(r"\.([^.\[\]]+)|\[(\d+)\]|\[\.\.\.\]")
_OF_MSGSPEC = re.compile(r"Expected `|Invalid ")
_TIME = "a time with its zone, such as 2027-01-31T12:00:00Z"


def in_words(error: str, content: Any, kind: type[Any]) -> str:
    """Say what msgspec found in plain data that is to be of a ``kind``; what a type said itself is kept."""
    found = _PLACE.fullmatch(error)
    assert found is not None
    what, place = found["what"], (found["place"] or "").lstrip(".").removesuffix("[...]")
    schema: inspect.Type | None = inspect.type_info(kind)
    value = content
    for name, number in _STEP.findall(found["place"] or ""):
        schema, value = _inside(schema, name, number, value), _item(value, name, number)
    field = f"{place}: " if place else ""
    if unknown := re.fullmatch(r"Object contains unknown field `(.*)`", what):
        return f"{field}unknown field {unknown[1]!r}; {nearest_name(unknown[1], _names(schema, value))}"
    if missing := re.fullmatch(r"Object missing required field `(.*)`", what):
        return f"{field}{missing[1]} is missing; add it, {wanted(_inside(schema, missing[1], '', value))}"
    if isinstance(schema, inspect.LiteralType):
        known = nearest_name(str(value), [str(word) for word in schema.values])
        return f"{field}unknown {_last(place)} {shown(value)}; {known}"
    if what == "Number out of range":
        return f"{field}must be a number of at most 308 digits; got {shown(value)}"
    if _OF_MSGSPEC.match(what):
        return f"{field}must be {wanted(schema)}; got {shown(value)}"
    return f"{field}{what[0].lower()}{what[1:]}"


def _last(place: str) -> str:
    return re.sub(r"\[\d+\]", "", place).split(".")[-1] or "value"


def shown(value: Any) -> str:
    """Return a value as it may stand in a YAML file, shortened."""
    plain = {None: "nothing", True: "true", False: "false"}
    return plain[value] if value is None or isinstance(value, bool) else repr_short(value)


def wanted(schema: inspect.Type | None) -> str:
    """Say what values a type has."""
    match schema:
        case inspect.Metadata(type=inner, extra_json_schema=extra):
            return str((extra or {}).get("description") or wanted(inner))
        case inspect.UnionType():
            given = [kind for kind in schema.types if not isinstance(kind, inspect.NoneType)]
            return " or ".join(dict.fromkeys(map(wanted, given)))
        case inspect.LiteralType():
            return f"one of {', '.join(map(str, schema.values))}"
        case inspect.FloatType() | inspect.IntType():
            return " ".join(filter(None, (_KINDS[type(schema)][0], _span(schema))))
        case inspect.ListType() | inspect.VarTupleType():
            many = _KINDS.get(type(_bare(schema.item_type)), ("", "entries"))[1]
            return f"a list of {_count(schema.min_length, schema.max_length)}{many}"
        case inspect.TupleType():
            kinds = {type(_bare(item)) for item in schema.item_types}
            many = _KINDS.get(kinds.pop(), ("", "values"))[1] if len(kinds) == 1 else "values"
            return f"a list of {len(schema.item_types)} {many}"
        case inspect.StrType():
            length = _count(schema.min_length, schema.max_length)
            return f"text of {length}characters" if length else "text"
    return _KINDS.get(type(schema), ("something else", ""))[0]


_KINDS: Mapping[type[Any], tuple[str, str]] = {
    inspect.FloatType: ("a number", "numbers"),
    inspect.IntType: ("a whole number", "whole numbers"),
    inspect.StrType: ("text", "words"),
    inspect.LiteralType: ("a word", "words"),
    inspect.BoolType: ("true or false", "truths"),
    inspect.NoneType: ("nothing", ""),
    inspect.DateTimeType: (_TIME, "times"),
    inspect.DictType: ("'name: value' pairs", "entries"),
    inspect.StructType: ("'field: value' pairs", "entries"),
    inspect.DataclassType: ("'field: value' pairs", "entries"),
    inspect.ListType: ("a list", "lists"),
    inspect.VarTupleType: ("a list", "lists"),
    inspect.TupleType: ("a list", "lists"),
}


def _bare(schema: inspect.Type) -> inspect.Type:
    return schema.type if isinstance(schema, inspect.Metadata) else schema


def _span(schema: inspect.FloatType | inspect.IntType) -> str:
    """Return the limits of a number."""
    if schema.ge is not None and schema.le is not None:
        return f"from {_plain(schema.ge)} to {_plain(schema.le)}"
    limits = ((">", schema.gt), (">=", schema.ge), ("<", schema.lt), ("<=", schema.le))
    said = [f"{sign} {_plain(limit)}" for sign, limit in limits if limit is not None]
    return " and ".join(said)


def _plain(number: float) -> str:
    return f"{number:.0f}" if abs(number) < 1e7 and number == int(number) else f"{number:g}"


def _count(least: int | None, most: int | None) -> str:
    """Return how many there must be, and a space; nothing if there may be any number."""
    if least is not None and most is not None:
        return f"{least} to {most} "
    if least is not None:
        return f"{least} or more "
    return "" if most is None else f"at most {most} "


def _item(value: Any, name: str, number: str) -> Any:
    try:
        return value[name] if name else value[int(number)]
    except (KeyError, IndexError, TypeError, ValueError):
        return None


def _structs(schema: inspect.Type | None) -> list[_Fields]:
    kinds: Sequence[inspect.Type | None] = (
        schema.types if isinstance(schema, inspect.UnionType) else (schema,)
    )
    return [kind for kind in kinds if isinstance(kind, inspect.StructType | inspect.DataclassType)]


def _tag_field(schema: _Fields) -> str | None:
    return schema.tag_field if isinstance(schema, inspect.StructType) else None


def _chosen(schema: inspect.Type | None, value: Any) -> list[_Fields]:
    """Return the structs that a value can be, by its tag if it has one."""
    structs = _structs(schema)
    tagged = [
        struct
        for struct in structs
        if isinstance(struct, inspect.StructType)
        and struct.tag_field
        and isinstance(value, dict)
        and value.get(struct.tag_field) == struct.tag
    ]
    return [*tagged] or structs


def _inside(schema: inspect.Type | None, name: str, number: str, value: Any) -> inspect.Type | None:
    """Return the type of a field, or of an item if ``name`` is empty: by its number, if it has one."""
    if not name:
        kinds = schema.types if isinstance(schema, inspect.UnionType) else (schema,)
        for kind in kinds:
            match kind:
                case inspect.ListType() | inspect.VarTupleType():
                    return kind.item_type
                case inspect.TupleType():
                    return kind.item_types[int(number or 0)]
                case inspect.DictType():
                    return kind.value_type
        return None
    for struct in _chosen(schema, value):
        if name == _tag_field(struct):
            tags = tuple(str(each.tag) for each in _structs(schema) if isinstance(each, inspect.StructType))
            return inspect.LiteralType(tags)
        for field in struct.fields:
            if field.encode_name == name:
                return field.type
    return None


def _names(schema: inspect.Type | None, value: Any) -> list[str]:
    structs = _chosen(schema, value)
    tags = [tag for tag in map(_tag_field, structs) if tag]
    return list(dict.fromkeys([*tags, *(field.encode_name for each in structs for field in each.fields)]))
