"""Bytes of step evidence: payloads between neighbours, and the entries of a log."""

from __future__ import annotations

import struct
import zlib
from typing import Annotated

import msgspec
from msgspec import Meta

from vedette import wire
from vedette.fusion.link import Greeting, Key

Number = Annotated[int, Meta(ge=0, le=2**62)]
Step = int  # counted from the mission's start; 0..2^32 - 1

MOST_STEP = (1 << 32) - 1
_ENTRY = struct.Struct("<II")  # step; twice the length, plus 1 if deflated


class Have(msgspec.Struct, frozen=True, array_like=True):
    """The version of one stream that the sender holds."""

    robot: Number
    nonce: Number
    version: Number


class Section(msgspec.Struct, frozen=True, array_like=True):
    """What turns any version of a stream in ``[base, version)`` into ``version``."""

    robot: Number
    nonce: Number
    base: Number
    version: Number
    entries: bytes
    robots: Number = 0  # that contributed to a sum


class Payload(msgspec.Struct, frozen=True, array_like=True):
    """What one robot tells one neighbour."""

    nonce: Number  # the sender's side of the link
    greeting: Greeting | None = None
    have: Annotated[tuple[Have, ...], Meta(max_length=4096)] = ()
    sections: Annotated[tuple[Section, ...], Meta(max_length=1024)] = ()

    @property
    def versions(self) -> dict[Key, int]:
        """What the sender holds."""
        return {(have.robot, have.nonce): have.version for have in self.have}


_DECODER = msgspec.msgpack.Decoder(Payload)
encode = msgspec.msgpack.Encoder().encode


def decode(data: bytes) -> Payload:
    """Return the payload; ValueError if malformed."""
    return wire.decode(_DECODER, data, "step evidence")


def check_step(step: Step) -> None:
    """Raise ValueError for a step that no payload can hold."""
    if not 0 <= step <= MOST_STEP:
        raise ValueError(f"step must lie in 0..2^32 - 1; got {step}")


def pack(step: Step, element: bytes) -> bytes:
    """Return one entry: an element's bytes, deflated where that is shorter, and its step."""
    deflate = zlib.compressobj(6, zlib.DEFLATED, -15, 9)
    short = deflate.compress(element) + deflate.flush()
    best, deflated = (short, 1) if len(short) < len(element) else (element, 0)
    return _ENTRY.pack(step, 2 * len(best) + deflated) + best


def unpack(entries: bytes, most_bytes: int) -> list[tuple[Step, bytes, bytes]]:
    """Return ``(step, element, the entry itself)`` of each entry; ValueError if malformed."""
    at, found = 0, []
    while at < len(entries):
        if at + _ENTRY.size > len(entries):
            raise ValueError("step evidence: an entry is truncated")
        step, size = _ENTRY.unpack_from(entries, at)
        body = entries[at + _ENTRY.size : at + _ENTRY.size + size // 2]
        if len(body) < size // 2:
            raise ValueError("step evidence: an entry is truncated")
        end = at + _ENTRY.size + len(body)
        found.append((step, _inflate(body, most_bytes) if size & 1 else body, entries[at:end]))
        at = end
    return found


def _inflate(data: bytes, most: int) -> bytes:
    """Inflate at most ``most`` bytes, so that a crafted payload cannot exhaust the memory."""
    stream = zlib.decompressobj(-15)
    try:
        body = stream.decompress(data, most + 1)
    except zlib.error as error:
        raise ValueError(f"step evidence: {error}") from None
    if len(body) > most or not stream.eof or stream.unused_data:
        raise ValueError("step evidence: an entry does not end where it should")
    return body
