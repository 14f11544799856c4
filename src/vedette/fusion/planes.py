"""Numbers as bytes: all lowest bytes, then all second bytes, and so on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def planes(numbers: NDArray[np.int64] | NDArray[np.int32], width: int) -> bytes:
    """Return so many bytes of each number, the lowest first: small numbers leave long runs to deflate."""
    return numbers.astype("<i8").view(np.uint8).reshape(-1, 8)[:, :width].T.tobytes()


def from_planes(data: bytes | NDArray[np.uint8], number: int, width: int) -> NDArray[np.int64]:
    """Undo ``planes`` for so many numbers; bytes that are not given are 0."""
    wide = np.zeros((number, 8), dtype=np.uint8)
    wide[:, :width] = np.frombuffer(data, dtype=np.uint8).reshape(width, number).T
    return wide.view("<i8").reshape(number).astype(np.int64)
