"""Reading a message that anybody may have sent."""

from __future__ import annotations

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
