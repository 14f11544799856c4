"""Bytes of a fusion payload: varint headers, then every changed cell in one deflated body."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette import wire
from vedette.fusion.link import MOST_SECTIONS, MOST_STREAMS, Greeting, Key, Payload
from vedette.fusion.packing import MapPacking, PackedBody
from vedette.fusion.planes import from_planes, planes
from vedette.fusion.seals import MOST_CERTIFICATE, SIGNATURE_BYTES, Seal
from vedette.fusion.snapshots import Delta, ValueT, Voucher
from vedette.kernels.tiles import Tiling

MOST_TILES = 2048  # in a payload; one section may exceed it, up to the whole map
NUMBER_BITS = 63
MOST_COUNT = 1 << 53

_FORMAT, _SEALED = 1, 2
MOST_PARTICULARS, MOST_PLACE = 1 << 14, 64  # [bytes]
_GREETING, _WANTS, _BODY = 16, 32, 64


@dataclass(frozen=True)
class EvidenceCodec(Generic[ValueT]):
    """Encodes and decodes the payloads of one team: same map shape, counts size and packing."""

    tiling: Tiling
    counts_size: int
    packing: MapPacking[ValueT]
    sealed: bool = False  # sections are signed

    @property
    def _format(self) -> int:
        return _SEALED if self.sealed else _FORMAT

    def encode(self, payload: Payload[Delta[ValueT]]) -> bytes:
        """Return the payload's bytes."""
        head, body = bytearray(), bytearray()
        flags = _BODY if payload.sections else 0
        if payload.greeting is not None:
            flags |= _GREETING | (_WANTS if payload.greeting.wants else 0)
        head.append(self._format | flags)
        _put(head, [payload.nonce])
        if payload.greeting is not None:
            _put(head, [payload.greeting.echo + 1])
        _put(head, [len(payload.have)])
        for (robot, nonce), version in payload.have.items():
            _put(head, [robot, nonce ^ payload.nonce, version])
        if not payload.sections:
            return bytes(head)
        _put(head, [len(payload.sections)])
        for (robot, nonce), delta in payload.sections:
            size = 2 * len(delta.tiles) + (delta.counts is not None)
            _put(head, [robot, nonce ^ payload.nonce, delta.base, delta.version - delta.base, size])
            _put(head, np.diff(delta.tiles, prepend=0).tolist())
            if delta.voucher is not None:
                _put_voucher(head, delta.voucher)
            body += self.packing.pack(delta)
            if delta.counts is not None:
                body += planes(delta.counts, 8)
        deflate = zlib.compressobj(6, zlib.DEFLATED, -15, 9)
        return bytes(head) + deflate.compress(bytes(body)) + deflate.flush()

    def decode(self, data: bytes) -> Payload[Delta[ValueT]]:
        """Return the payload; ValueError if anything in it is malformed or out of range."""
        head = _Head(data)
        flags = head.byte()
        if flags & 0x8F != self._format:
            raise ValueError(f"fusion payload: unknown format byte {flags}")
        own = head.number()
        greeting = Greeting(head.number() - 1, bool(flags & _WANTS)) if flags & _GREETING else None
        have = {head.key(own): head.number() for _ in range(head.number(MOST_STREAMS + 1))}
        if not flags & _BODY:
            if head.rest():
                raise ValueError("fusion payload: bytes are left over")
            return Payload(own, greeting, have)
        outlines = self._outlines(head, own)
        most = sum(self.packing.most_bytes * len(o.tiles) + 8 * self.counts_size * o.counts for o in outlines)
        body = PackedBody(wire.inflate(head.rest(), most, "fusion payload"))
        sections = [(outline.key, self._delta(outline, body)) for outline in outlines]
        body.finish()
        return Payload(own, greeting, have, sections)

    def _outlines(self, head: _Head, own: int) -> list[_Outline]:
        number = head.number()
        if number > MOST_SECTIONS:
            raise ValueError(f"fusion payload: {number} sections; at most {MOST_SECTIONS} are taken")
        outlines: list[_Outline] = []
        total = 0
        for _ in range(number):
            key, base, ahead = head.key(own), head.number(), head.number()
            tiles, counts = divmod(head.number(), 2)
            total += tiles
            if tiles > self.tiling.count or total > MOST_TILES + self.tiling.count:
                raise ValueError(f"fusion payload: {total} tiles, more than fit the map")
            if ahead == 0 or (base + ahead) >> NUMBER_BITS:
                raise ValueError("fusion payload: a section's versions do not advance")
            ids = np.cumsum([head.number(self.tiling.count) for _ in range(tiles)], dtype=np.int64)
            if tiles and (ids[-1] >= self.tiling.count or (np.diff(ids) <= 0).any()):
                raise ValueError("fusion payload: tile ids must increase and lie in the map")
            voucher = head.voucher(tiles) if self.sealed else None
            outlines.append(_Outline(key, base, base + ahead, ids, bool(counts), voucher))
        return outlines

    def _delta(self, outline: _Outline, body: PackedBody) -> Delta[ValueT]:
        mask, values = self.packing.unpack(body, len(outline.tiles))
        if (mask & ~self.tiling.inside(outline.tiles)).any():
            raise ValueError("fusion payload: a cell lies outside the map")
        counts = None
        if outline.counts:
            counts = from_planes(body.take(8 * self.counts_size), self.counts_size, 8)
            if (counts > MOST_COUNT).any() or (counts < -MOST_COUNT).any():
                raise ValueError("fusion payload: a count is out of range")
        return Delta(outline.base, outline.version, outline.tiles, mask, values, counts, outline.voucher)


class _Outline(NamedTuple):
    key: Key
    base: int
    version: int
    tiles: NDArray[np.int64]  # (T,) their numbers, increasing
    counts: bool  # whether there are any
    voucher: Voucher | None


class _Head:
    """Reads the header's numbers: little-endian base 128."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    def byte(self) -> int:
        if self._at >= len(self._data):
            raise ValueError("fusion payload: truncated")
        self._at += 1
        return self._data[self._at - 1]

    def number(self, limit: int = 1 << NUMBER_BITS) -> int:
        value = shift = 0
        while True:
            byte = self.byte()
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
            if shift >= NUMBER_BITS:
                raise ValueError("fusion payload: a number is too long")
        if value >= limit:
            raise ValueError(f"fusion payload: number {value} is out of range 0..{limit - 1}")
        return value

    def key(self, own: int) -> Key:
        return self.number(), self.number() ^ own

    def take(self, size: int) -> bytes:
        if self._at + size > len(self._data):
            raise ValueError("fusion payload: truncated")
        self._at += size
        return self._data[self._at - size : self._at]

    def voucher(self, tiles: int) -> Voucher:
        """Read what ``_put_voucher`` wrote."""
        time = self.number()
        ages = np.array([self.number(time + 1) for _ in range(2 * tiles)], np.int64).reshape(-1, 2)
        told = self.number(MOST_PARTICULARS + 2)
        particulars = self.take(told - 1) if told else None
        size = self.number(MOST_PLACE + 2)
        place = self.take(size - 1) if size else None
        certificate = self.take(self.number(MOST_CERTIFICATE + 1))
        seal = Seal(time, self.take(SIGNATURE_BYTES))
        return Voucher(time - ages, particulars, place, seal, certificate)

    def rest(self) -> bytes:
        return self._data[self._at :]


def _put(head: bytearray, numbers: Iterable[int]) -> None:
    for number in numbers:
        while number > 127:
            head.append(number & 127 | 128)
            number >>= 7
        head.append(number)


def _put_voucher(head: bytearray, voucher: Voucher) -> None:
    time = voucher.seal.time
    _put(head, [time, *(time - voucher.times).ravel().tolist()])
    _put(head, [0 if voucher.particulars is None else len(voucher.particulars) + 1])
    head += voucher.particulars or b""
    _put(head, [0 if voucher.place is None else len(voucher.place) + 1])
    head += voucher.place or b""
    _put(head, [len(voucher.certificate)])
    head += voucher.certificate + voucher.seal.signature
