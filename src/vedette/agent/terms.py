"""What a team has to agree on before its members use links to each other, and how they tell."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from typing import Annotated

import msgspec
from msgspec import Meta

from vedette import wire

Word = Annotated[str, Meta(max_length=200, pattern=r"^[^\x00-\x1f\x7f-\x9f\[\]]*\Z")]
Fields = Annotated[dict[Word, Word], Meta(max_length=4096)]
Terms = Mapping[str, str]  # name of a field, and its value


class Introduction(msgspec.Struct, frozen=True, array_like=True, tag=1):
    """One robot's terms, from neighbour to neighbour; the tag is the format's version."""

    boot: Annotated[int, Meta(ge=0, lt=1 << 38)]
    asks: bool  # for the receiver's in turn
    clock: Annotated[int, Meta(ge=-(2**53), le=2**53)]  # the sender's time of day [ms]
    fields: Fields


_DECODER: msgspec.msgpack.Decoder[Introduction] = msgspec.msgpack.Decoder(Introduction)
encode = msgspec.msgpack.Encoder().encode


def decode(payload: bytes) -> Introduction:
    """Return what a neighbour tells; ValueError if it is malformed."""
    return wire.decode(_DECODER, payload, "terms")


def flat(name: str, value: object) -> Iterator[tuple[str, str]]:
    """Yield the fields of a struct, dataclass, mapping or list as ``name.field``, each with its value."""
    plain = msgspec.to_builtins(value)
    if isinstance(plain, dict):
        for key, item in plain.items():
            yield from flat(f"{name}.{key}", item)
    elif isinstance(plain, list | tuple):
        for index, item in enumerate(plain):
            yield from flat(f"{name}.{index + 1}", item)
    else:
        yield name, "none" if plain is None else str(plain)


def fingerprint_of(terms: Terms) -> int:
    """Return 63 bits that are equal iff the terms are."""
    packed = msgspec.msgpack.encode(sorted(terms.items()))
    return int.from_bytes(hashlib.blake2b(packed, digest_size=8).digest(), "little") >> 1


def difference(theirs: Terms, ours: Terms) -> str | None:
    """Return the first field in which two robots' terms differ, and both values; None: they agree."""
    for name in [*ours, *(name for name in theirs if name not in ours)]:
        there, here = theirs.get(name, "nothing"), ours.get(name, "nothing")
        if there != here:
            return f"{name}: {there} there, {here} here"
    return None
