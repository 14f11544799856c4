"""What neighbours tell each other of the tree and of the link between them, as bytes."""

from __future__ import annotations

from typing import Annotated, Final, NamedTuple

import msgspec
from msgspec import Meta

from vedette import wire
from vedette.overlay.stamp import BOOT_BITS, EPOCH_BITS, ROBOT_BITS, Stamp

VERSION = 7
TICKS = 10_000  # a second
MOST_DISTANCE = 1 << 16
MOST_BYTES = 128

PARENT: Final = 1  # you are my parent
UP: Final = 2  # I would use this link
BYE: Final = 4  # I am leaving
ASK: Final = 8  # I have not heard you for long: answer at once
TWICE: Final = 16  # somebody else sends under your number, and was started later

Boot = Annotated[int, Meta(ge=0, lt=1 << BOOT_BITS)]
Sequence = Annotated[int, Meta(ge=1, le=2**53)]
Clock = Annotated[int, Meta(ge=-(2**53), le=2**53)]  # [0.1 ms]


class Echo(NamedTuple):
    """The receiver's latest hello that the sender has heard."""

    boot: Boot
    sequence: Sequence
    hold: Annotated[int, Meta(ge=0, lt=2**32)]  # how long ago [0.1 ms]


class Hello(msgspec.Struct, frozen=True, array_like=True, tag=VERSION):
    """From one robot to one neighbour; the tag is the version of all that agents say to each other."""

    boot: Boot
    sequence: Sequence  # of hellos on this link
    time: Clock  # the sender's clock
    epoch: Annotated[int, Meta(ge=1, le=(1 << EPOCH_BITS) - 1)]
    root: Annotated[int, Meta(ge=0, lt=1 << ROBOT_BITS)]
    root_boot: Boot
    distance: Annotated[int, Meta(ge=0, le=MOST_DISTANCE)]  # costs of the links to the root
    flags: Annotated[int, Meta(ge=0, lt=32)]
    size: Annotated[int, Meta(ge=1, le=1 << ROBOT_BITS)]  # robots: to a parent its part of the tree, else all
    loss: Annotated[int, Meta(ge=0, le=100)]  # hellos of the receiver that did not arrive [%]
    to_root: Clock  # the root's clock minus the sender's
    terms: Annotated[
        int, Meta(ge=0, le=2**63 - 1)
    ]  # fingerprint of what the sender takes the team to agree on
    echo: Echo | None = None  # None: not heard within the lease

    @property
    def stamp(self) -> Stamp:
        """Return the stamp of the tree that the sender is on."""
        return Stamp(self.epoch, self.root, self.root_boot)


_DECODER: msgspec.msgpack.Decoder[Hello] = msgspec.msgpack.Decoder(Hello)
encode = msgspec.msgpack.Encoder().encode


class OtherVersion(ValueError):
    """A hello of another version."""


def decode(sender: int, payload: bytes) -> Hello:
    """Return a neighbour's hello.

    Raises:
        ValueError: malformed, out of range, or at odds with itself.
        OtherVersion: it speaks another version.
    """
    if len(payload) > 1 and payload[0] >> 4 == 9 and payload[1] < 128 and payload[1] != VERSION:
        raise OtherVersion(f"hello: version {payload[1]}, not {VERSION}")
    if len(payload) > MOST_BYTES:
        raise ValueError(f"hello of {len(payload)} bytes; at most {MOST_BYTES} are taken")
    hello = wire.decode(_DECODER, payload, "hello")
    is_root = (hello.root, hello.root_boot) == (sender, hello.boot)
    if is_root != (hello.distance == 0) or (hello.root == sender and not is_root):
        raise ValueError(f"hello: root {hello.root} at distance {hello.distance}, told by robot {sender}")
    if hello.stamp.is_alone and not is_root:
        raise ValueError(f"hello: robot {sender} is alone in epoch {hello.epoch}, but not its own root")
    if is_root and hello.flags & PARENT:
        raise ValueError(f"hello: robot {sender} is the root and has a parent")
    return hello
