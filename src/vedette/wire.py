"""Reading a message that anybody may have sent."""

from __future__ import annotations

import zlib
from typing import TypeVar

import msgspec

MessageT = TypeVar("MessageT")


def decode(decoder: msgspec.msgpack.Decoder[MessageT], payload: bytes, what: str) -> MessageT:
    """Return the message that the bytes are, by a decoder that checks its type and ranges.

    Raises:
        ValueError: malformed or out of range, text that is no UTF-8, or nested too deep; the line begins with
            ``what`` the bytes should have been.
    """
    try:
        return decoder.decode(payload)
    except (msgspec.DecodeError, UnicodeError, RecursionError) as error:
        raise ValueError(f"{what} of {len(payload)} bytes is malformed: {error}") from None


def inflate(data: bytes, most: int, what: str) -> bytes:
    """Return what raw deflate has packed, at most ``most`` bytes: nothing crafted exhausts the memory.

    Raises:
        ValueError: no deflated data, cut short, followed by more, or larger; the line begins with ``what``.
    """
    stream = zlib.decompressobj(wbits=-15)
    try:
        body = stream.decompress(data, most + 1)
    except zlib.error as error:
        raise ValueError(f"{what} does not inflate: {error}") from None
    if len(body) > most or not stream.eof or stream.unused_data:
        raise ValueError(f"{what} is cut short or too large")
    return body
