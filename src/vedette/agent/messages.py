"""What agents say to their neighbours on the tree, as bytes."""

from __future__ import annotations

from typing import Annotated, TypeAlias

import msgspec
from msgspec import Meta

Count = Annotated[int, Meta(ge=0, le=2**53)]
Place = Annotated[int, Meta(ge=-(2**31), le=2**31)]  # [cm]
GivenUp = tuple[Place, Place, Count]  # x, y [cm], and how much was unknown there when it was given up
Told = Annotated[tuple[GivenUp, ...], Meta(max_length=512)]
Offset = Annotated[int, Meta(ge=-2000, le=2000)]  # from the robot [cm]; its path's next metres are few


class Beacon(msgspec.Struct, frozen=True, array_like=True, tag=0):
    """Where a robot is and where it goes, in centimetres and milliradians; passed on to everybody."""

    robot: Annotated[int, Meta(ge=0, lt=2**16)]
    boot: Count
    sequence: Count
    x: Place
    y: Place
    heading: Place
    slowed: Count  # time without progress [0.1 s]
    radius: Annotated[int, Meta(ge=1, le=1000)]
    speed: Annotated[int, Meta(ge=1, le=10000)]  # at most [cm/s]
    path: Annotated[tuple[Offset, ...], Meta(max_length=1000)]  # x, y, x, y, ...: its next few metres


class Evidence(msgspec.Struct, frozen=True, array_like=True, tag=1):
    """A neighbour's news for the team map."""

    data: bytes


class Call(msgspec.Struct, frozen=True, array_like=True, tag=2):
    """To the root: somebody needs a plan."""

    epoch: Count


class Begin(msgspec.Struct, frozen=True, array_like=True, tag=3):
    """From the root: a round begins; send what you know up the tree."""

    epoch: Count
    sequence: Count


class Flushed(msgspec.Struct, frozen=True, array_like=True, tag=4):
    """To the root: all that this part of the tree knew has been sent ahead of this message."""

    epoch: Count
    sequence: Count
    given_up: Told = ()  # places that visits by this part of the tree did not change


class Freeze(msgspec.Struct, frozen=True, array_like=True, tag=5):
    """From the root: all that the team knew has been sent ahead of this message; plan on it."""

    epoch: Count
    sequence: Count
    digest: int  # of the root's belief
    given_up: Told = ()  # places that anybody's visit did not change


class Negotiate(msgspec.Struct, frozen=True, array_like=True, tag=6):
    """A negotiation message within a round."""

    epoch: Count
    sequence: Count
    data: bytes


Wire: TypeAlias = Beacon | Evidence | Call | Begin | Flushed | Freeze | Negotiate

_DECODER: msgspec.msgpack.Decoder[Wire] = msgspec.msgpack.Decoder(Wire)
encode = msgspec.msgpack.Encoder().encode


def decode(payload: bytes) -> Wire:
    """Return the message.

    Raises:
        ValueError: malformed.
    """
    try:
        return _DECODER.decode(payload)
    except msgspec.DecodeError as error:
        raise ValueError(f"agent message of {len(payload)} bytes is malformed: {error}") from None
