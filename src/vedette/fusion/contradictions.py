"""What a robot has signed that cannot both be so: proof of a lie to everybody, whoever passes it on."""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import msgspec
from msgspec import Meta, structs

from vedette import wire
from vedette.fusion.seals import SIGNATURE_BYTES, Notary

MOST_BYTES = 1 << 17  # of a proof

Signature = Annotated[bytes, Meta(min_length=SIGNATURE_BYTES, max_length=SIGNATURE_BYTES)]
Words = tuple[Any, ...]  # numbers, bytes and text, as they are signed


class SignedWord(msgspec.Struct, frozen=True, array_like=True):
    """What a robot has signed, and how."""

    what: Words
    signature: Signature

    def check(self, notary: Notary, robot: int) -> None:
        """Raise ValueError unless the robot has signed it."""
        notary.check(robot, self.signature, *self.what)


class Twice(msgspec.Struct, frozen=True, array_like=True, tag=0):
    """Two words about one thing, of which a robot says one at most."""

    first: SignedWord
    second: SignedWord


class Histories(msgspec.Struct, frozen=True, array_like=True, tag=1):
    """A signed version of a log, and a later one that does not begin with it."""

    early: SignedWord
    late: SignedWord
    entries: bytes  # up to the later one


class Accounted(msgspec.Struct, frozen=True, array_like=True, tag=2):
    """An account by which a robot has told another sum than what it says to have added up."""

    account: bytes


Contradiction = Twice | Histories | Accounted
_DECODER: msgspec.msgpack.Decoder[Contradiction] = msgspec.msgpack.Decoder(Contradiction)
encode = msgspec.msgpack.Encoder().encode


def decode(data: bytes) -> Contradiction:
    """Return the contradiction; ValueError if it is malformed."""
    if len(data) > MOST_BYTES:
        raise ValueError(f"a proof of {len(data)} bytes; at most {MOST_BYTES} are taken")
    proof = wire.decode(_DECODER, data, "proof")
    for word in structs.astuple(proof):
        if isinstance(word, SignedWord) and not all(
            isinstance(each, int | bytes | str) for each in word.what
        ):
            raise ValueError("proof: a word of something else than numbers, bytes and text")
    return proof


class ProvenLie(NamedTuple):
    """A contradiction that this robot has come upon."""

    robot: int
    proof: Contradiction
