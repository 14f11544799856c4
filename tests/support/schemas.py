"""The JSON schemas that the documentation promises, and a validator that did not make them."""

from __future__ import annotations

import json
from typing import Any

from jsonschema import Draft202012Validator

from tests.support.places import ROOT

FOLDER = ROOT / "docs" / "schemas"


def validator(name: str) -> Draft202012Validator:
    """Return a validator by the schema of that name."""
    schema = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


def valid(name: str, text: str | bytes) -> dict[str, Any]:
    """Return what a JSON text holds, which is by the schema of that name, without NaN."""

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    value: dict[str, Any] = json.loads(text, parse_constant=refuse)
    assert [error.message for error in validator(name).iter_errors(value)] == []
    return value
