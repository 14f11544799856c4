"""Copies of a whole state, quick to take and to bring back."""

from __future__ import annotations

import io
import pickle
from types import FunctionType
from typing import Any


class Kept:
    """A state as it was; each ``copy`` is a new one. Functions are shared, and so is what they enclose."""

    def __init__(self, state: object) -> None:
        """Keep a state as it is now."""
        self._functions: list[FunctionType] = []
        buffer = io.BytesIO()
        pickler = pickle.Pickler(buffer, pickle.HIGHEST_PROTOCOL)
        pickler.persistent_id = self._number  # type: ignore[method-assign]
        pickler.dump(state)
        self._data = buffer.getvalue()

    def copy(self) -> Any:
        """Return the state anew."""
        unpickler = pickle.Unpickler(io.BytesIO(self._data))
        unpickler.persistent_load = self._functions.__getitem__  # type: ignore[method-assign]
        return unpickler.load()

    def _number(self, thing: Any) -> int | None:
        if not isinstance(thing, FunctionType) or "<" not in thing.__qualname__:
            return None
        self._functions.append(thing)
        return len(self._functions) - 1
