"""Bytes of step evidence: payloads between neighbours, and the entries of a log."""

from __future__ import annotations

import struct
import zlib
from typing import Annotated, NamedTuple

import msgspec
from msgspec import Meta

from vedette import wire
from vedette.fusion.link import MOST_SECTIONS, MOST_STREAMS, Greeting, Payload

Number = Annotated[int, Meta(ge=0, le=2**62)]
Step = int  # counted from the mission's start; 0..2^32 - 1

MOST_STEP = (1 << 32) - 1
_ENTRY = struct.Struct("<II")  # step; twice the length, plus 1 if deflated


class Entries(NamedTuple):
    """What turns any version of a stream in ``[base, version)`` into ``version``."""

    base: int
    version: int
    data: bytes
    robots: int = 0  # that contributed to a sum

    @property
    def size(self) -> int:
        """Bytes."""
        return len(self.data)


_Have = tuple[Number, Number, Number]  # robot, nonce, version
_Section = tuple[Number, Number, Number, Number, bytes, Number]  # robot, nonce, entries
_Message = tuple[
    Number,  # nonce
    Greeting | None,
    Annotated[tuple[_Have, ...], Meta(max_length=MOST_STREAMS)],
    Annotated[tuple[_Section, ...], Meta(max_length=MOST_SECTIONS)],
]
_DECODER: msgspec.msgpack.Decoder[_Message] = msgspec.msgpack.Decoder(_Message)


def encode(payload: Payload[Entries]) -> bytes:
    """Return the payload's bytes."""
    have = [(*key, version) for key, version in payload.have.items()]
    sections = [(*key, *entries) for key, entries in payload.sections]
    return msgspec.msgpack.encode((payload.nonce, payload.greeting, have, sections))


def decode(data: bytes) -> Payload[Entries]:
    """Return the payload; ValueError if malformed."""
    nonce, greeting, have, sections = wire.decode(_DECODER, data, "step evidence")
    versions = {(robot, stream): version for robot, stream, version in have}
    return Payload(nonce, greeting, versions, [(s[:2], Entries(*s[2:])) for s in sections])


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


class LogEntry(NamedTuple):
    """One of the entries."""

    step: Step
    is_deflated: bool
    body: bytes
    entry: bytes  # all of it


def parts(entries: bytes) -> list[LogEntry]:
    """Return the entries one by one; ValueError if malformed."""
    at, found = 0, []
    while at < len(entries):
        if at + _ENTRY.size > len(entries):
            raise ValueError("step evidence: an entry is truncated")
        step, size = _ENTRY.unpack_from(entries, at)
        body = entries[at + _ENTRY.size : at + _ENTRY.size + size // 2]
        if len(body) < size // 2:
            raise ValueError("step evidence: an entry is truncated")
        end = at + _ENTRY.size + len(body)
        found.append(LogEntry(step, bool(size & 1), body, entries[at:end]))
        at = end
    return found


def unpack(entries: bytes, most_bytes: int) -> list[tuple[Step, bytes, bytes]]:
    """Return ``(step, element, the entry itself)`` of each entry; ValueError if malformed."""
    what = "step evidence: an entry"
    return [
        (step, wire.inflate(body, most_bytes, what) if is_deflated else body, entry)
        for step, is_deflated, body, entry in parts(entries)
    ]
