"""Cells of a section as bytes, in the two forms that the two ways of fusing need."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.planes import from_planes, planes
from vedette.fusion.snapshots import Delta, ValueT
from vedette.fusion.tiles import LEVELS, MOST_ROBOTS, contributors_of, sums_of
from vedette.kernels.tiles import CELLS


class PackedBody:
    """Hands out the inflated body piece by piece."""

    def __init__(self, data: bytes) -> None:
        self._data = np.frombuffer(data, dtype=np.uint8)
        self._at = 0

    def take(self, size: int) -> NDArray[np.uint8]:
        if self._at + size > len(self._data):
            raise ValueError("fusion payload: the body is too short")
        self._at += size
        return self._data[self._at - size : self._at]

    def finish(self) -> None:
        if self._at < len(self._data):
            raise ValueError("fusion payload: the body is too long")


class MapPacking(Protocol[ValueT]):
    """How the cells of a section stand in the body."""

    most_bytes: int  # a tile

    def pack(self, delta: Delta[ValueT]) -> bytes:
        """Return the section's masks and values."""
        ...

    def unpack(self, body: PackedBody, tiles: int) -> tuple[NDArray[np.bool_], NDArray[ValueT]]:
        """Return ``(tiles, 1024)`` mask and the masked cells' values, all in range; else ValueError."""
        ...


class CodePacking:
    """Codes 0..4, uint8: two cells a byte in base 6, where 0 is "not given" and 1..5 are codes plus one."""

    most_bytes = CELLS // 2

    def pack(self, delta: Delta[np.uint8]) -> bytes:
        """Return 512 bytes a tile."""
        symbols = np.zeros(delta.mask.shape, dtype=np.uint8)
        symbols[delta.mask] = delta.values + 1
        return (symbols[:, 0::2] * 6 + symbols[:, 1::2]).tobytes()

    def unpack(self, body: PackedBody, tiles: int) -> tuple[NDArray[np.bool_], NDArray[np.uint8]]:
        """Return mask and codes."""
        pairs = body.take(tiles * self.most_bytes).reshape(tiles, self.most_bytes)
        if pairs.size and pairs.max() >= 36:
            raise ValueError(f"fusion payload: cell pair {int(pairs.max())} is out of range 0..35")
        symbols = np.stack(np.divmod(pairs, 6), axis=-1).reshape(tiles, CELLS)
        mask = symbols > 0
        return mask, symbols[mask] - 1


class WordPacking:
    """Packed sums with a code in the top bits, int32: a bit mask a tile, then byte planes of the words."""

    most_bytes = CELLS // 8 + 4 * CELLS

    def pack(self, delta: Delta[np.int32]) -> bytes:
        """Return 128 bytes a tile and 4 bytes a given cell."""
        return np.packbits(delta.mask, axis=1).tobytes() + planes(delta.values, 4)

    def unpack(self, body: PackedBody, tiles: int) -> tuple[NDArray[np.bool_], NDArray[np.int32]]:
        """Return mask and words."""
        bits = body.take(tiles * CELLS // 8).reshape(tiles, CELLS // 8)
        mask = np.unpackbits(bits, axis=1).astype(np.bool_)
        given = int(mask.sum())
        words = from_planes(body.take(4 * given), given, 4).astype(np.int32)
        code, live = split_word(words)
        robots = contributors_of(live)
        if (code >= len(LEVELS)).any() or (robots > MOST_ROBOTS).any():
            raise ValueError("fusion payload: a cell's code or number of robots is out of range")
        if (np.abs(sums_of(live)) > 2 * robots).any():
            raise ValueError("fusion payload: a cell's sum is out of range for its number of robots")
        return mask, words


def join_word(code: NDArray[np.uint8], live: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return ``live + code * 2^28``: one int32 of an inherited code and a packed sum below 2^28."""
    return live + (code.astype(np.int32) << 28)


def split_word(words: NDArray[np.int32]) -> tuple[NDArray[np.uint8], NDArray[np.int32]]:
    """Return ``(code, packed sum)`` of joined words."""
    return (words >> 28).astype(np.uint8), words & ((1 << 28) - 1)
