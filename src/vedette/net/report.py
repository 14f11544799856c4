"""What a robot's process tells the operator: its condition, and what its domain has to tell; as bytes."""

from __future__ import annotations

import zlib
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from vedette import wire
from vedette.agent.orders import MOST_ORDERS, Order
from vedette.missions.explore.expected import Expected

MOST_BYTES = 1 << 24
Count = Annotated[int, Meta(ge=0, le=2**53)]
FARTHEST = 1e9
Real = Annotated[float, Meta(ge=-FARTHEST, le=FARTHEST)]
Ending = Literal[
    "complete", "unreached", "enclosed", "ordered", "spent"
]  # words of ``vedette.outcome.Outcome``
PRINTABLE = r"^[^\x00-\x1f\x7f-\x9f\[\]]*\Z"  # what a terminal shows as it is, markup left out
Word = Annotated[str, Meta(max_length=64, pattern=PRINTABLE)]
MOST_WORDS = 500  # characters of a sentence
Sentence = Annotated[str, Meta(max_length=MOST_WORDS, pattern=PRINTABLE)]


class SpreadReport(msgspec.Struct, frozen=True, array_like=True):
    """Order statistics of wall-clock durations [ms]."""

    count: Count
    p50: Real
    p95: Real
    most: Real


class LinkReport(msgspec.Struct, frozen=True, array_like=True):
    """A neighbour, as ``vedette.overlay.LinkStatus``."""

    robot: Count
    role: Word
    loss: Annotated[float, Meta(ge=0.0, le=1.0)]
    round_trip: Real | None
    offset: Real | None
    silent: Real | None


class Complaint(msgspec.Struct, frozen=True, array_like=True):
    """What is wrong with a neighbour, or with this robot's own number."""

    robot: Count
    what: Sentence


class OrderReport(msgspec.Struct, frozen=True, array_like=True):
    """An order that a robot holds: whoever gave it knows by that who has heard of it."""

    counter: Annotated[int, Meta(ge=0, le=2**62)]
    operator: Word
    order: Order


class Condition(msgspec.Struct, frozen=True, array_like=True, tag=2):
    """A robot's state, all but the map; the tag is the format's version."""

    robot: Count
    boot: Count
    name: Word
    time: Real  # the mission's, as this robot counts it [s]
    began: Real | None  # when it began to map, likewise; None: it waits for others
    state: Word
    x: Real  # [m], team frame
    y: Real
    heading: Real  # [rad]
    path: Annotated[tuple[Real, ...], Meta(max_length=2000)]  # x, y, x, y, ...: what is ahead [m]
    root: Count
    epoch: Annotated[int, Meta(ge=0, le=2**63 - 1)]
    number: Count  # the name of the tree's stamp
    parent: Count | None
    neighbours: Annotated[tuple[Count, ...], Meta(max_length=1024)]  # on the tree
    size: Count  # of the tree
    age: Real  # of the tree, here [s]
    links: Annotated[tuple[LinkReport, ...], Meta(max_length=1024)]
    digest: int  # of its evidence: equal ones mean equal maps
    known: Annotated[float, Meta(ge=0.0, le=1.0)] | None  # share of the ground; None: nobody knows it
    rounds: Count  # ended with a decision
    sweeps: Count
    cuts: Count  # children that did not answer in time
    bounded: Count  # rounds whose value had a bound
    bound_ratios: Real  # value over bound, summed over these
    travelled: Real  # [m]
    collisions: Count
    min_clearance: Real | None  # [m]; None: not known
    messages: Annotated[dict[Word, Count], Meta(max_length=16)]  # sent, by kind
    bytes: Annotated[dict[Word, int], Meta(max_length=16)]
    dropped: Annotated[dict[Word, Count], Meta(max_length=16)]  # what failed a check, by where
    complaints: Annotated[tuple[Complaint, ...], Meta(max_length=1024)]  # what is wrong with whom
    planning_ms: SpreadReport | None  # a round's preparation and answers
    answer_ms: SpreadReport | None  # a negotiation message
    round_ms: SpreadReport | None  # rounds that this robot began, as the root, from end to end
    decided: Real | None = None  # how long ago the latest round ended with a decision, in real time [s]
    ending: Ending = "complete"  # how the mission ends for it, once it is done
    known_m2: Real | None = None  # [m^2]; None: no map is made
    frontiers: Count | None = None  # of the latest round's map; None: there has been none
    beyond: Count = 0  # beams, or cells of its own map, that told of ground where there is no room for any
    mission: Word = ""  # that orders have to be for; empty: it takes none
    orders: Annotated[tuple[OrderReport, ...], Meta(max_length=MOST_ORDERS)] = ()  # in force, oldest first
    signs: bool = False  # what its evidence says, so that others need not believe it
    out: Annotated[tuple[Count, ...], Meta(max_length=1024)] = ()  # robots that it does not believe
    alerts: Annotated[tuple[Sentence, ...], Meta(max_length=16)] = ()  # of its own computer: a full disk
    expected: Expected | None = (
        None  # how an exploration goes on, from ``began`` on; None: nobody can say yet
    )
    pose_error: Real | None = None  # farthest from where it was that it took itself to be [m]


class Report(msgspec.Struct, frozen=True, array_like=True, tag=3):
    """A robot's condition and what it has to tell of its mission."""

    condition: Condition
    content: Annotated[bytes, Meta(max_length=MOST_BYTES)]  # in the domain's own terms


_CONDITIONS: msgspec.msgpack.Decoder[Condition] = msgspec.msgpack.Decoder(Condition)
_REPORTS: msgspec.msgpack.Decoder[Report] = msgspec.msgpack.Decoder(Report)
encode = msgspec.msgpack.Encoder().encode


def read_condition(payload: bytes) -> Condition:
    """Return a robot's condition.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_CONDITIONS, payload, "report")


def read_report(payload: bytes) -> Report:
    """Return a robot's report; its content is still packed.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_REPORTS, payload, "report")


def inflated(packed: bytes, size: int) -> bytes:
    """Return exactly so many bytes, and never make more.

    Raises:
        ValueError: not deflated, or of another size.
    """
    stream = zlib.decompressobj()
    try:
        plain = stream.decompress(packed, size + 1)
    except zlib.error as error:
        raise ValueError(f"report: a grid is not deflated: {error}") from None
    if len(plain) != size:
        raise ValueError(f"report: a grid holds {len(plain)} bytes or more, not {size}")
    return plain
