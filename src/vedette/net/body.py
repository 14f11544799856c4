"""Where simulated bodies are, told among the processes that simulate them; real robots need none of it."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from vedette.sim.own_body import Seen

Metre = Annotated[float, Meta(ge=-1e6, le=1e6)]


class BodyReport(msgspec.Struct, frozen=True, array_like=True, tag=1):
    """A body's place and motion, as ``vedette.sim.own_body.Seen``."""

    x: Metre
    y: Metre
    heading: Metre
    vx: Metre
    vy: Metre
    radius: Annotated[float, Meta(gt=0.0, le=10.0)]


_DECODER: msgspec.msgpack.Decoder[BodyReport] = msgspec.msgpack.Decoder(BodyReport)


def encode(seen: Seen) -> bytes:
    """Return a body's place as bytes."""
    return msgspec.msgpack.encode(BodyReport(seen.x, seen.y, seen.heading, seen.vx, seen.vy, seen.radius))


def decode(payload: bytes) -> Seen:
    """Return a body's place.

    Raises:
        ValueError: malformed.
    """
    try:
        body = _DECODER.decode(payload)
    except msgspec.DecodeError as error:
        raise ValueError(f"body report of {len(payload)} bytes is malformed: {error}") from None
    return Seen(body.x, body.y, body.heading, body.vx, body.vy, body.radius)
