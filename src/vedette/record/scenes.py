"""What stays the same all through a mission of vehicles, as a line of its record."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.record.flights import FlightScene

KIND, SCENE = "kind", "scene"  # facts of a record: of which mission it is, and this line
SceneT = TypeVar("SceneT", bound=FlightScene)


def facts_of_scene(kind: str, scene: FlightScene) -> dict[str, str]:
    """Return what a record says of a mission of a kind."""
    return {KIND: kind, SCENE: msgspec.json.encode(asdict(scene), enc_hook=_packed).decode()}


def scene_in(facts: Mapping[str, str], kind: type[SceneT], path: Path) -> SceneT:
    """Return the scene that a record tells of.

    Raises:
        InputError: it tells of none, or of one that cannot be.
    """
    try:
        told: dict[str, Any] = msgspec.json.decode(facts[SCENE])
        return kind(**{each.name: _value(each.name, told[each.name]) for each in fields(kind)})
    except (KeyError, TypeError, ValueError, zlib.error, msgspec.DecodeError) as error:
        raise InputError(f"{path}: what it tells of its mission makes no sense: {error}") from error


def _value(name: str, told: Any) -> Any:
    if name == "frame":
        return GridFrame(**told)
    if name == "blocked":
        return _unpacked(told)
    return tuple(told) if isinstance(told, list) else told


def _packed(mask: NDArray[np.bool_]) -> dict[str, Any]:
    bits = base64.b64encode(zlib.compress(np.packbits(mask).tobytes())).decode()
    return {"shape": mask.shape, "bits": bits}


def _unpacked(told: Mapping[str, Any]) -> NDArray[np.bool_]:
    rows, cols = told["shape"]
    bits = np.frombuffer(zlib.decompress(base64.b64decode(told["bits"])), np.uint8)
    return np.unpackbits(bits, count=rows * cols).reshape(rows, cols).astype(np.bool_)
