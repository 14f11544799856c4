"""What evidence of one step is made of: integers, so that sums agree to the last bit in any order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.errors import InputError
from vedette.fusion.planes import from_planes, planes

E = TypeVar("E")

MOST_ENTRY = 1 << 50  # largest absolute entry of one robot's contribution
MOST_SUM = 1 << 60  # largest absolute entry that a payload may hold: sums over 1024 robots
_HEAD = 6  # bytes: number of entries, width of a gap, width of a value


class Elements(Protocol[E]):
    """An abelian group of elements, exact (floats are not), and how they stand in bytes."""

    most_bytes: int  # that an encoded element may have

    def zero(self) -> E:
        """Return the element that says nothing."""
        ...

    def add(self, a: E, b: E) -> E:
        """Return ``a + b``: exactly associative and commutative."""
        ...

    def subtract(self, a: E, b: E) -> E:
        """Return ``a - b``."""
        ...

    def is_zero(self, element: E) -> bool:
        """Tell whether the element says nothing."""
        ...

    def encode(self, element: E) -> bytes:
        """Return the element's bytes: equal elements have equal bytes."""
        ...

    def decode(self, data: bytes) -> E:
        """Return the element; ValueError if malformed or out of range."""
        ...


@dataclass(frozen=True, eq=False)
class Sparse:
    """A vector of integers that is zero but for some entries."""

    index: NDArray[np.int64]  # (M,) increasing
    value: NDArray[np.int64]  # (M,) none of them 0


class SparseIntegers:
    """Elements are vectors of ``size`` 64-bit integers, mostly zero; ``*`` is addition, entry by entry.

    In bytes: the gaps between indices and the zigzagged values, each at the least common width, in planes of
    equal significance.
    """

    def __init__(self, size: int) -> None:
        """Vectors have ``size`` entries, at most 2^32 - 1."""
        self.size = size
        self.most_bytes = _HEAD + 12 * size
        self._zero = Sparse(np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64))

    def of(self, index: NDArray[np.int64], value: NDArray[np.int64]) -> Sparse:
        """Return the element with these values at these distinct indices, in any order.

        Raises ValueError for indices outside the vector and absolute values above 2^50.
        """
        order = np.argsort(index)
        index, value = index[order].astype(np.int64), value[order].astype(np.int64)
        if len(index) and (index[0] < 0 or index[-1] >= self.size or (np.diff(index) == 0).any()):
            raise ValueError(f"indices must be distinct and lie in 0..{self.size - 1}")
        if (np.abs(value) > MOST_ENTRY).any():
            raise ValueError(f"values must lie within +-2^50; got {int(np.abs(value).max())}")
        some = value != 0
        return Sparse(index[some], value[some])

    def dense(self, element: Sparse) -> NDArray[np.int64]:
        """Return the whole ``(size,)`` vector."""
        vector = np.zeros(self.size, dtype=np.int64)
        vector[element.index] = element.value
        return vector

    def zero(self) -> Sparse:
        """Return the vector of zeros."""
        return self._zero

    def add(self, a: Sparse, b: Sparse) -> Sparse:
        """Return ``a + b``."""
        if not len(a.index) or not len(b.index):
            return a if len(a.index) else b
        index = np.concatenate([a.index, b.index])
        order = np.argsort(index, kind="stable")
        index, value = index[order], np.concatenate([a.value, b.value])[order]
        first = np.flatnonzero(np.diff(index, prepend=-1))
        sums = np.add.reduceat(value, first)
        some = sums != 0
        return Sparse(index[first][some], sums[some])

    def subtract(self, a: Sparse, b: Sparse) -> Sparse:
        """Return ``a - b``."""
        return self.add(a, Sparse(b.index, -b.value))

    def is_zero(self, element: Sparse) -> bool:
        """Tell whether all entries are zero."""
        return len(element.index) == 0

    def encode(self, element: Sparse) -> bytes:
        """Return the element's bytes."""
        gaps = np.diff(element.index, prepend=-1) - 1
        zigzag = (element.value << 1) ^ (element.value >> 63)
        widths = bytes([_width(gaps), _width(zigzag)])
        head = len(gaps).to_bytes(4, "little") + widths
        return head + planes(gaps, widths[0]) + planes(zigzag, widths[1])

    def decode(self, data: bytes) -> Sparse:
        """Return the element; ValueError if it is not the encoding of one."""
        if len(data) < _HEAD:
            raise ValueError("step evidence: an element is truncated")
        number, gap_width, value_width = int.from_bytes(data[:4], "little"), data[4], data[5]
        split = _HEAD + number * gap_width
        if gap_width > 4 or value_width > 8 or len(data) != split + number * value_width:
            raise ValueError("step evidence: an element has the wrong length")
        if number > self.size:
            raise ValueError(f"step evidence: {number} entries; the vector has {self.size}")
        index = np.cumsum(from_planes(data[_HEAD:split], number, gap_width) + 1) - 1
        zigzag = from_planes(data[split:], number, value_width)
        value = (zigzag >> 1) ^ -(zigzag & 1)
        if number and index[-1] >= self.size:
            raise ValueError(f"step evidence: index {int(index[-1])} lies outside the vector")
        if (zigzag < 0).any() or (value == 0).any() or (np.abs(value) > MOST_SUM).any():
            raise ValueError("step evidence: a value is zero or out of range")
        return Sparse(index, value)


@dataclass(frozen=True, eq=False)
class FixedPoint:
    """Real numbers as whole multiples of a unit, ``largest * 2^-50`` rounded up to a power of two.

    Rounded once, when a robot publishes: from then on sums are sums of integers, the same for everybody (as
    the log-misses of theory (V20)). A number is off by at most half a unit, ``2^-50`` of the largest.
    """

    unit: NDArray[np.float64]  # powers of two, one or one for each entry

    @classmethod
    def holding(cls, largest: ArrayLike) -> FixedPoint:
        """Return the scale for absolute values up to ``largest`` > 0 (one number, or one for each entry)."""
        most = np.asarray(largest, dtype=np.float64)
        if not (np.isfinite(most).all() and (most > 0.0).all()):
            raise InputError(f"largest must be finite and > 0; got {most}")
        return cls(np.exp2(np.ceil(np.log2(most)) - 50))

    def quantise(self, numbers: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the nearest whole multiples; InputError if a number exceeds the largest or is NaN."""
        scaled = numbers / self.unit
        if not (np.abs(scaled) <= MOST_ENTRY).all():
            worst = numbers.flat[int(np.argmax(np.nan_to_num(np.abs(scaled), nan=np.inf)))]
            raise InputError(f"evidence of {worst} exceeds the largest stated; state a larger one")
        return np.rint(scaled).astype(np.int64)

    def numbers(self, whole: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the numbers that whole multiples stand for."""
        return whole * self.unit


def _width(numbers: NDArray[np.int64]) -> int:
    """Return the bytes that the largest of non-negative numbers needs."""
    return -(-int(numbers.max()).bit_length() // 8) if len(numbers) else 0
