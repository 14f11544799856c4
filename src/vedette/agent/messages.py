"""What agents say to their neighbours on the tree, as bytes."""

from __future__ import annotations

from typing import TypeAlias

import msgspec


class Beacon(msgspec.Struct, frozen=True, array_like=True, tag=0):
    """Where a robot is and where it goes, in centimetres and milliradians; passed on to everybody."""

    robot: int
    boot: int
    sequence: int
    x: int
    y: int
    heading: int
    slowed: int  # time without progress [0.1 s]
    path: tuple[int, ...]  # x, y, x, y, ... relative to the robot: its next few metres


class Evidence(msgspec.Struct, frozen=True, array_like=True, tag=1):
    """A neighbour's news for the team map."""

    data: bytes


class Call(msgspec.Struct, frozen=True, array_like=True, tag=2):
    """To the root: somebody needs a plan."""

    epoch: int


class Begin(msgspec.Struct, frozen=True, array_like=True, tag=3):
    """From the root: a round begins; send what you know up the tree."""

    epoch: int
    sequence: int


class Flushed(msgspec.Struct, frozen=True, array_like=True, tag=4):
    """To the root: all that this part of the tree knew has been sent ahead of this message."""

    epoch: int
    sequence: int


class Freeze(msgspec.Struct, frozen=True, array_like=True, tag=5):
    """From the root: all that the team knew has been sent ahead of this message; plan on it."""

    epoch: int
    sequence: int
    digest: int  # of the root's belief


class Negotiate(msgspec.Struct, frozen=True, array_like=True, tag=6):
    """A negotiation message within a round."""

    epoch: int
    sequence: int
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
