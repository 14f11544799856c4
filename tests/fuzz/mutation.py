"""Changing an input a little, with an eye to what it is made of."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterator
from typing import Any, TypeAlias

import msgspec
import numpy as np

Mutate: TypeAlias = Callable[[bytes, np.random.Generator], bytes]

_INTEGERS = [0, 1, 2, 3, 15, 63, 64, 127, 128, 255, 256, 511, 512, 1023, 1024, 4095, 65535, 65536]
_INTEGERS += [(1 << bits) + more for bits in (24, 31, 32, 37, 38, 50, 53, 60, 62, 63) for more in (-1, 0, 1)]
INTEGERS = [value for value in (*_INTEGERS, (1 << 64) - 1, *(-v for v in _INTEGERS)) if value >= -(1 << 63)]
SWEPT = [-1, 0, 1, 1 << 20, 1 << 50, 1 << 53, 1 << 62, (1 << 64) - 1]
FLOATS = [0.0, -0.0, 1.0, -1.0, 0.5, 1e-300, -1e300, 1e16, 1.7e308, float("inf"), -float("inf"), float("nan")]
MOST = 1 << 16  # [bytes] no input grows beyond it
_DEEP = 6  # messages within messages


def mutate_message(data: bytes, rng: np.random.Generator) -> bytes:
    """Return a message with a part of it changed: a MessagePack field, a deflated body, or plain bytes."""
    if rng.random() < 0.2:
        return mutate_bytes(data, rng)
    if rng.random() < 0.01:
        return _nested(data, rng)
    for _ in range(int(rng.integers(1, 4))):
        data = _mutate_whole(data, rng, 0)
    return data[:MOST]


def mutate_text(data: bytes, rng: np.random.Generator) -> bytes:
    """Return a YAML text with a line repeated, dropped or moved, or a word replaced by an awkward one."""
    lines = data.split(b"\n")
    i, j = (int(rng.integers(len(lines))) for _ in range(2))
    match rng.integers(7):
        case 0:
            lines.insert(j, lines[i])
        case 1:
            del lines[i]
        case 2:
            lines[i] = b" " * int(rng.integers(5)) + lines[i].lstrip()
        case 3 | 4 | 5:
            lines[i] = _replace_word(lines[i], rng)
        case _:
            return mutate_bytes(data, rng)
    return b"\n".join(lines)[:MOST]


def mutate_bytes(data: bytes, rng: np.random.Generator) -> bytes:
    """Return the bytes with a few flipped, dropped, repeated or replaced by awkward ones."""
    new = bytearray(data)
    for _ in range(int(rng.integers(1, 4))):
        at = int(rng.integers(len(new) + 1))
        size = int(min(rng.geometric(0.2), 64))
        match rng.integers(6):
            case 0 if at < len(new):
                new[at] ^= 1 << int(rng.integers(8))
            case 1 if at < len(new):
                new[at] = int(rng.choice([0, 1, 127, 128, 255, int(rng.integers(256))]))
            case 2:
                del new[at : at + size]
            case 3:
                new[at:at] = new[at : at + size]
            case 4:
                new[at:at] = rng.bytes(size)
            case _:
                del new[at:]
    return bytes(new[:MOST])


def sweep(data: bytes) -> Iterator[bytes]:
    """Yield a message with one field after another at each awkward value, those of messages within too."""
    tree = _parsed(data)
    for changed in _swept(tree) if tree is not None else ():
        yield msgspec.msgpack.encode(changed)


# -- messages: MessagePack within MessagePack, and deflated bodies behind a head -------------------------


def _mutate_whole(data: bytes, rng: np.random.Generator, deep: int) -> bytes:
    tree = _parsed(data) if deep < _DEEP else None
    if tree is not None:
        return msgspec.msgpack.encode(_mutate_tree(tree, rng, deep))
    if rng.random() < 0.5:
        for at in range(min(len(data), 48)):
            body = _inflated(data[at:])
            if body:
                deflate = zlib.compressobj(1, zlib.DEFLATED, -15)
                return data[:at] + deflate.compress(mutate_bytes(body, rng)) + deflate.flush()
    return mutate_bytes(data, rng)


def _nested(data: bytes, rng: np.random.Generator) -> bytes:
    """Return an array with one item more, arrays within arrays; a field that nobody asked for is read too."""
    if not data or not 0x90 <= data[0] < 0x9F:
        return data + b"\x91" * 2000
    return bytes([data[0] + 1]) + data[1:] + b"\x91" * int(rng.integers(100, 4000)) + b"\x00"


def _parsed(data: bytes) -> list[Any] | None:
    """Return the array that the bytes are, or None."""
    try:
        tree = msgspec.msgpack.decode(data)
    except (msgspec.DecodeError, ValueError, RecursionError):
        return None
    return tree if isinstance(tree, list) and tree else None


def _inflated(data: bytes) -> bytes | None:
    stream = zlib.decompressobj(-15)
    try:
        body = stream.decompress(data, MOST)
    except zlib.error:
        return None
    return body if stream.eof and not stream.unused_data else None


def _mutate_tree(tree: list[Any], rng: np.random.Generator, deep: int) -> list[Any]:
    tree = list(tree)
    i = int(rng.integers(len(tree)))
    if rng.random() < 0.1:
        j = int(rng.integers(len(tree)))
        match rng.integers(3):
            case 0:
                tree.insert(j, tree[i])
            case 1:
                del tree[i]
            case _:
                tree[i], tree[j] = tree[j], tree[i]
        return tree
    tree[i] = _mutate_item(tree[i], rng, deep)
    return tree


def _swept(tree: list[Any]) -> Iterator[list[Any]]:
    for i, item in enumerate(tree):
        for new in _item_swept(item):
            yield [*tree[:i], new, *tree[i + 1 :]]


def _item_swept(item: Any) -> Iterator[Any]:
    if isinstance(item, list):
        yield from _swept(item)
        yield []
    elif isinstance(item, bytes):
        yield from sweep(item)
        yield b""
    elif isinstance(item, float):
        yield from FLOATS
    elif isinstance(item, int) and not isinstance(item, bool):
        yield from (*SWEPT, item + 1)


def _mutate_item(item: Any, rng: np.random.Generator, deep: int) -> Any:
    if isinstance(item, list) and item and rng.random() < 0.9:
        return _mutate_tree(item, rng, deep)
    if isinstance(item, bytes) and rng.random() < 0.9:
        return _mutate_whole(item, rng, deep + 1)
    if isinstance(item, int) and not isinstance(item, bool) and rng.random() < 0.3:
        return max(min(item + int(rng.integers(-3, 4)), (1 << 64) - 1), -(1 << 63))
    if isinstance(item, float) and rng.random() < 0.8:
        return FLOATS[int(rng.integers(len(FLOATS)))]
    others: list[Any] = [None, True, b"", "", [], item, 0.5, FLOATS[int(rng.integers(len(FLOATS)))]]
    if isinstance(item, int) or rng.random() < 0.3:
        return INTEGERS[int(rng.integers(len(INTEGERS)))]
    return others[int(rng.integers(len(others)))]


# -- text ------------------------------------------------------------------------------------------------

_WORDS = (
    b"0 -1 1 1e400 -1e400 1e308 5e-324 .nan .inf 1_000 0x7fffffffffffffff 99999999999999999999999 null true "
    b"[] {} [[]] - ~ 1e9 1000000 0.5 2001-01-01 12:30:45 !!binary_aGk= !!python/none_x &a *a <<: {<<:_*a} "
    b"&b_[*b,*b] ? | > ' \" % @ ` \x00 \xff \xe2\x80\xa8 -------- name start mean sigma uniform static "
    b'"\\ud800"'
).split()


def _replace_word(line: bytes, rng: np.random.Generator) -> bytes:
    words = line.replace(b",", b" , ").replace(b"[", b" [ ").replace(b"]", b" ] ").split(b" ")
    new = _WORDS[int(rng.integers(len(_WORDS)))].replace(b"_", b" ")
    words[int(rng.integers(len(words)))] = new
    return b" ".join(words)
