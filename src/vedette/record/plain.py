"""Figures as JSON text: fields in the order declared, floats to 6 decimals, what is not finite as null."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import msgspec
import numpy as np

DIGITS = 6


def plain(value: Any) -> Any:
    """Return ``value`` as JSON types: floats rounded, not finite ones ``None``, what has fields objects."""
    if is_dataclass(value) and not isinstance(value, type):
        return {f.name: plain(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, msgspec.Struct):
        return plain(msgspec.structs.asdict(value))
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return round(float(value), DIGITS) + 0.0 if math.isfinite(value) else None  # + 0.0: no "-0.0"
    return value if value is None else str(value)


def json_text(value: Any) -> str:
    """Return the text of a file of figures; NaN cannot be in it."""
    return json.dumps(plain(value), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
