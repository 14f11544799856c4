"""Where a simulated body is, as told among the processes that each simulate one; real robots need none."""

from __future__ import annotations

from math import hypot
from typing import Annotated

import msgspec
from msgspec import Meta

from vedette import wire
from vedette.scenario import Metre

TOUCH = 0.01  # bodies that overlap by more are in one place [m]
Number = Annotated[float, Meta(ge=-1e6, le=1e6)]


class ShownBody(msgspec.Struct, frozen=True, array_like=True, tag=1):
    """A body's place and motion."""

    x: Metre  # [m], team frame
    y: Metre
    heading: Number  # [rad]
    vx: Number  # [m/s], team frame
    vy: Number
    radius: Annotated[float, Meta(gt=0.0, le=10.0)]  # [m]

    def inside(self, other: ShownBody) -> bool:
        """Tell whether two bodies are in one place: each drove there while nobody told it of the other.

        They must pass through each other until they are apart again; else neither could ever move.
        """
        gap = hypot(self.x - other.x, self.y - other.y) - self.radius - other.radius
        return gap < -TOUCH


_DECODER: msgspec.msgpack.Decoder[ShownBody] = msgspec.msgpack.Decoder(ShownBody)
encode = msgspec.msgpack.Encoder().encode


def decode(payload: bytes) -> ShownBody:
    """Return a body's place.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_DECODER, payload, "body report")
