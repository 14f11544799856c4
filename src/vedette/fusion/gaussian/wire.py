"""What two neighbours tell each other of their tracks."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from vedette import wire

Number = Annotated[int, Meta(ge=0, le=2**62)]


class TrackMessage(msgspec.Struct, frozen=True, array_like=True):
    """Tracks as one robot holds them at a step, or (no data) an acknowledgement alone."""

    nonce: Number  # the sender's side of the edge
    echo: Annotated[int, Meta(ge=-1, le=2**62)]  # the receiver's, as far as the sender has heard; -1: not yet
    sent: Number  # number of the sender's latest tracks; of these here, if there are any
    heard: Number  # number of the receiver's latest tracks that the sender has merged
    included: Number  # number of the receiver's latest tracks that went into these
    step: Annotated[int, Meta(ge=0, lt=2**32)]
    data: bytes


_DECODER = msgspec.msgpack.Decoder(TrackMessage)
encode = msgspec.msgpack.Encoder().encode


def decode(payload: bytes) -> TrackMessage:
    """Return the message; ValueError if malformed."""
    return wire.decode(_DECODER, payload, "track payload")
