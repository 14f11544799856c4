"""What a monitoring vehicle tells: its evidence, of which everything else can be worked out."""

from __future__ import annotations

import zlib
from dataclasses import replace
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from vedette.domains.monitoring.belief import FieldBelief

_MOST = 1 << 24  # bytes
Packed = Annotated[bytes, Meta(max_length=_MOST)]  # (spots,) little-endian floats, deflated


class FieldContent(msgspec.Struct, frozen=True, array_like=True, tag=1):
    """A vehicle's belief of the field."""

    step: Annotated[int, Meta(ge=0, le=2**53)]
    information: Packed  # [1 / unit^2]
    vector: Packed  # [1 / unit]


def content_of(known: FieldBelief) -> FieldContent:
    """Return a belief as it is told."""
    return FieldContent(known.step, _packed(known.information), _packed(known.vector))


def belief_of(content: FieldContent, prior: FieldBelief) -> FieldBelief:
    """Return the belief that is told.

    Raises:
        ValueError: it is of another field, or no evidence.
    """
    information, vector = (
        _unpacked(each, prior.spots.count) for each in (content.information, content.vector)
    )
    return replace(prior, information=information, vector=vector, step=content.step)


def check_content(content: FieldContent, spots: int) -> None:
    """Raise ValueError for what is no evidence of a field with so many spots."""
    if (_unpacked(content.information, spots) < 0.0).any():
        raise ValueError("report of information below 0")
    _unpacked(content.vector, spots)


def _packed(numbers: NDArray[np.float64]) -> bytes:
    return zlib.compress(numbers.astype("<f8").tobytes(), 1)


def _unpacked(packed: bytes, count: int) -> NDArray[np.float64]:
    stream = zlib.decompressobj()
    try:
        plain = stream.decompress(packed, 8 * count + 1)
    except zlib.error as error:
        raise ValueError(f"report: not deflated: {error}") from None
    if len(plain) != 8 * count:
        raise ValueError(f"report: {len(plain)} bytes or more, not {8 * count}")
    numbers = np.frombuffer(plain, "<f8")
    if not np.isfinite(numbers).all():
        raise ValueError("report of numbers that are not finite")
    return numbers
