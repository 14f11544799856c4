"""Where simulated bodies are, told among the processes that simulate them; real robots need none of it."""

from __future__ import annotations

from math import hypot
from typing import Annotated

import msgspec
from msgspec import Meta

from vedette import wire
from vedette.sim.own_body import Seen

TOUCH = 0.01  # bodies that overlap by more are in one place [m]
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
    body = wire.decode(_DECODER, payload, "body report")
    return Seen(body.x, body.y, body.heading, body.vx, body.vy, body.radius)


def inside(body: Seen, other: Seen) -> bool:
    """Tell whether two bodies are in one place: each drove there while nobody told it of the other.

    They must pass through each other until they are apart again; else neither could ever move.
    """
    gap = hypot(body.x - other.x, body.y - other.y) - body.radius - other.radius
    return gap < -TOUCH
