"""A hash of everything that an object holds, to tell whether reading an input has changed it."""

from __future__ import annotations

import hashlib
from array import array
from collections import deque
from collections.abc import Mapping, Set
from types import FunctionType, MethodType
from typing import Any

import msgspec
import numpy as np

Digest = bytes
_PLAIN = (int, float, complex, str, bytes, bool, type(None), range)


def fingerprint(thing: object, leave_out: frozenset[str] = frozenset()) -> Digest:
    """Return a hash of an object and of all that it refers to, fields of the names left out excepted.

    Equal states give equal hashes, whatever is shared among them and in whatever order sets were filled.
    """
    return _of(thing, leave_out, {})


def _of(thing: Any, leave_out: frozenset[str], known: dict[int, Digest]) -> Digest:
    if isinstance(thing, _PLAIN):
        return _hash(type(thing).__name__, repr(thing).encode())
    if id(thing) in known:
        return known[id(thing)]
    known[id(thing)] = b"round"  # met again inside itself
    known[id(thing)] = digest = _hash(type(thing).__name__, *_parts(thing, leave_out, known))
    return digest


def _parts(thing: Any, leave_out: frozenset[str], known: dict[int, Digest]) -> list[bytes]:
    if isinstance(thing, np.ndarray):
        return [str((thing.dtype, thing.shape)).encode(), np.ascontiguousarray(thing).tobytes()]
    if isinstance(thing, bytearray | array):
        return [bytes(thing)]
    if isinstance(thing, np.generic | type | FunctionType):
        return [repr(getattr(thing, "__qualname__", thing)).encode()]
    if isinstance(thing, MethodType):
        return [thing.__qualname__.encode(), _of(thing.__self__, leave_out, known)]
    if isinstance(thing, Mapping):
        items = [(_of(k, leave_out, known), _of(v, leave_out, known)) for k, v in thing.items()]
        return [part for item in sorted(items) for part in item]
    if isinstance(thing, Set):
        return sorted(_of(item, leave_out, known) for item in thing)
    if isinstance(thing, list | tuple | deque):
        return [_of(item, leave_out, known) for item in thing]
    return _fields(thing, leave_out, known)


def _fields(thing: Any, leave_out: frozenset[str], known: dict[int, Digest]) -> list[bytes]:
    if isinstance(thing, msgspec.Struct):
        names = list(thing.__struct_fields__)
    else:
        slots = [name for kind in type(thing).__mro__ for name in getattr(kind, "__slots__", ())]
        names = sorted({*getattr(thing, "__dict__", {}), *slots})
    return [
        part
        for name in names
        if name not in leave_out and hasattr(thing, name)
        for part in (name.encode(), _of(getattr(thing, name), leave_out, known))
    ]


def _hash(kind: str, *parts: bytes) -> Digest:
    total = hashlib.blake2b(kind.encode(), digest_size=16)
    for part in parts:
        total.update(len(part).to_bytes(8, "little") + part)
    return total.digest()
