"""What travels between the two ends of a reliable link, as bytes."""

from __future__ import annotations

import hashlib
import struct
from typing import Annotated

import msgspec
from msgspec import Meta

from vedette import wire

MOST_MESSAGES = 64  # in a packet
WINDOW = 256  # messages that may be under way
REPORTED = 62  # messages beyond the first gap that an acknowledgement tells of
MOST_BYTES = 1 << 24  # of a message, and of a packet but for its head

Session = Annotated[int, Meta(ge=0, lt=2**32)]
Sequence = Annotated[int, Meta(ge=0, le=2**53)]


class Packet(msgspec.Struct, frozen=True, array_like=True, tag=1):
    """Messages in a row and what has arrived of the other end's; the tag is the format's version."""

    session: Session  # whose link this is, in which of their lives, on which tree
    ack: Sequence  # all messages before this one have arrived
    more: Annotated[int, Meta(ge=0, lt=1 << REPORTED)] = 0  # bit k: so has message ack + 1 + k
    first: Sequence = 0  # of the messages
    messages: Annotated[
        tuple[Annotated[bytes, Meta(max_length=MOST_BYTES)], ...], Meta(max_length=MOST_MESSAGES)
    ] = ()


_DECODER: msgspec.msgpack.Decoder[Packet] = msgspec.msgpack.Decoder(Packet)
encode = msgspec.msgpack.Encoder().encode


def decode(payload: bytes) -> Packet:
    """Return the packet.

    Raises:
        ValueError: malformed or out of range.
    """
    if len(payload) > MOST_BYTES + 64:
        raise ValueError(f"packet of {len(payload)} bytes; at most {MOST_BYTES + 64} are taken")
    return wire.decode(_DECODER, payload, "packet")


def session_of(sender_boot: int, receiver_boot: int, stamp: int) -> int:
    """Return the name that packets of one direction of a link bear: 32 bits of a hash."""
    name = struct.pack("<QQQ", sender_boot, receiver_boot, stamp)
    return int.from_bytes(hashlib.blake2b(name, digest_size=4).digest(), "little")
