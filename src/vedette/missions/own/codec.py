"""How impacts travel that are arrays of numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class FloatsCodec:
    """Arrays of one shape, every number in a range, to the bit."""

    shape: tuple[int, ...]
    low: float = -np.inf  # of every number
    high: float = np.inf

    def encode(self, impact: NDArray[np.float64]) -> bytes:
        """Return the array as bytes."""
        return np.asarray(impact, "<f8").tobytes()

    def decode(self, data: bytes) -> NDArray[np.float64]:
        """Return the array; ValueError for another shape, or a number that is none or out of range."""
        if len(data) != 8 * int(np.prod(self.shape)):
            raise ValueError(f"{len(data)} bytes are no array {self.shape}")
        numbers = np.frombuffer(data, "<f8").reshape(self.shape).astype(np.float64)
        if not (np.isfinite(numbers).all() and (numbers >= self.low).all() and (numbers <= self.high).all()):
            raise ValueError(f"a number is none, or not {self.low:g} to {self.high:g}")
        return numbers
