"""What agents say to their neighbours on the tree, as bytes."""

from __future__ import annotations

from typing import Annotated, TypeAlias

import msgspec
from msgspec import Meta

from vedette import wire

Count = Annotated[int, Meta(ge=0, le=2**53)]
Place = Annotated[int, Meta(ge=-(2**31), le=2**31)]  # [cm]
Note = tuple[Place, Place, Count]  # x, y [cm], and a number to it: what they mean is the mission's
Notes = Annotated[tuple[Note, ...], Meta(max_length=512)]
Metre = Annotated[int, Meta(ge=-(2**31), le=2**31)]
Area = tuple[Metre, Metre, Metre, Metre]  # lowest x, lowest y, highest x, highest y
Areas = Annotated[tuple[Area, ...], Meta(max_length=8)]
MOST_TOLD = 64  # beacons in a message
MOST_ROBOTS = MOST_DEPTH = 1 << 16
Robot = Annotated[int, Meta(ge=0, lt=2**16)]
Halvings = Annotated[int, Meta(ge=0, le=7)]
Robots = Annotated[int, Meta(ge=1, le=MOST_ROBOTS)]
Offset = Annotated[int, Meta(ge=-2000, le=2000)]  # from the robot [cm]; its path's next metres are few


class Beacon(msgspec.Struct, frozen=True, array_like=True, tag=0):
    """Where a robot is and where it goes, in centimetres and milliradians; passed on to everybody."""

    robot: Robot
    boot: Count
    sequence: Count
    x: Place
    y: Place
    heading: Place
    slowed: Count  # time without progress [0.1 s]
    radius: Annotated[int, Meta(ge=1, le=1000)]
    speed: Annotated[int, Meta(ge=1, le=100_000)]  # at most [cm/s]
    path: Annotated[tuple[Offset, ...], Meta(max_length=1000)]  # x, y, x, y, ...: its next few metres


class Beacons(msgspec.Struct, frozen=True, array_like=True, tag=7):
    """Many robots' beacons over one link at once, each as its robot has sent it."""

    told: Annotated[tuple[bytes, ...], Meta(max_length=MOST_TOLD)]


class Evidence(msgspec.Struct, frozen=True, array_like=True, tag=1):
    """A neighbour's news of what the team has seen."""

    data: bytes


class Call(msgspec.Struct, frozen=True, array_like=True, tag=2):
    """To the root: somebody needs a plan."""

    epoch: Count


class Begin(msgspec.Struct, frozen=True, array_like=True, tag=3):
    """From the root: a round begins; send what you know up the tree."""

    epoch: Count
    sequence: Count
    depth: Annotated[int, Meta(ge=0, le=MOST_DEPTH)]  # of the receiver: links to the root


class Flushed(msgspec.Struct, frozen=True, array_like=True, tag=4):
    """To the root: all that this part of the tree knew has been sent ahead of this message."""

    epoch: Count
    sequence: Count
    robots: Robots  # in this part of the tree
    notes: Notes = ()  # of this part of the tree
    reach: Areas | None = None  # of this part of the tree; None: anywhere


class Freeze(msgspec.Struct, frozen=True, array_like=True, tag=5):
    """From the root: all that the team knew has been sent ahead of this message; plan on it."""

    epoch: Count
    sequence: Count
    t0: Annotated[int, Meta(ge=-(2**53), le=2**53)]  # the root's clock [ms]
    digest: Annotated[int, Meta(ge=0)]  # of the root's evidence; 64 bits
    robots: Robots  # that take part, in all
    notes: Notes = ()  # of the whole team
    reach: Areas | None = None  # of all but the receiver's part of the tree; None: anywhere


class FrameTold(msgspec.Struct, frozen=True, array_like=True):
    """Where a contributor's frame lies on the plane of a round: turned, then moved."""

    robot: Robot
    boot: Count
    part: Robot  # those of one part are joined
    x: Place  # [mm]
    y: Place
    angle: Annotated[int, Meta(ge=0, lt=1 << 16)]  # [2^-16 of a turn]


class FramedFreeze(Freeze, frozen=True, array_like=True, tag=14):
    """From the root of a team that shares no frame: plan on the plane that these lie on."""

    frames: Annotated[tuple[FrameTold, ...], Meta(max_length=1024)] = ()


class Negotiate(msgspec.Struct, frozen=True, array_like=True, tag=6):
    """A negotiation message within a round."""

    epoch: Count
    sequence: Count
    data: bytes


class Audit(msgspec.Struct, frozen=True, array_like=True, tag=8):
    """Something is wrong: everybody signs what it has claimed in a round."""

    epoch: Count
    sequence: Count


Heard = tuple[Robot, Halvings, bytes]  # the sum that came over a link, and how much it counted
MOST_LINKS, MOST_ANSWERED = 1024, 16  # of a robot, and sums that it answers for: who checks adds up each
PRINT_BYTES = 16
Print = Annotated[bytes, Meta(min_length=PRINT_BYTES, max_length=PRINT_BYTES)]
Told = tuple[Robot, Print]  # a fingerprint of the sum of all else, as it went over a link


class Account(msgspec.Struct, frozen=True, array_like=True, tag=9):
    """What one robot has claimed in a round; passed on to everybody."""

    robot: Robot
    boot: Count
    epoch: Count
    sequence: Count
    impact: bytes
    links: Annotated[tuple[Heard, ...], Meta(max_length=MOST_LINKS)]  # what it added up
    told: Annotated[tuple[Told, ...], Meta(max_length=MOST_ANSWERED)]  # sums of that, where it told them last
    signature: bytes = b""  # under the same without it


class Vouched(msgspec.Struct, frozen=True, array_like=True, tag=10):
    """A beacon that may be passed on, for its robot has signed it."""

    beacon: bytes
    signature: bytes
    certificate: bytes = b""  # in a robot's first ones; later it has come with the evidence


class Proof(msgspec.Struct, frozen=True, array_like=True, tag=11):
    """What a robot has signed that cannot both be so; passed on to everybody."""

    robot: Robot
    certificate: bytes  # the robot's
    data: bytes


class Proven(msgspec.Struct, frozen=True, array_like=True, tag=12):
    """Of whom the sender has proofs."""

    robots: Annotated[tuple[Robot, ...], Meta(max_length=MOST_ROBOTS)]


class Orders(msgspec.Struct, frozen=True, array_like=True, tag=13):
    """Orders of the operator, each as it has been signed; passed on to everybody."""

    told: Annotated[tuple[bytes, ...], Meta(max_length=256)]


Wire: TypeAlias = (
    Beacon
    | Beacons
    | Evidence
    | Call
    | Begin
    | Flushed
    | Freeze
    | FramedFreeze
    | Negotiate
    | Audit
    | Account
    | Vouched
    | Proof
    | Proven
    | Orders
)

_DECODER: msgspec.msgpack.Decoder[Wire] = msgspec.msgpack.Decoder(Wire)
_BEACON_DECODER: msgspec.msgpack.Decoder[Beacon] = msgspec.msgpack.Decoder(Beacon)
_ACCOUNT_DECODER: msgspec.msgpack.Decoder[Account] = msgspec.msgpack.Decoder(Account)
_TOLD_DECODER: msgspec.msgpack.Decoder[Beacon | Vouched] = msgspec.msgpack.Decoder(Beacon | Vouched)
encode = msgspec.msgpack.Encoder().encode


def decode_beacon(payload: bytes) -> Beacon:
    """Return an unsigned beacon.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_BEACON_DECODER, payload, "beacon")


def decode_account(payload: bytes) -> Account:
    """Return an account.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_ACCOUNT_DECODER, payload, "account")


def decode_told(payload: bytes) -> Beacon | Vouched:
    """Return one of `Beacons`, signed or not.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_TOLD_DECODER, payload, "beacon")


def decode(payload: bytes) -> Wire:
    """Return the message.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_DECODER, payload, "agent message")
