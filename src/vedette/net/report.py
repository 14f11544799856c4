"""What a robot's process tells the operator: its condition, and what it knows of the map; as bytes."""

from __future__ import annotations

import zlib
from typing import Annotated, NamedTuple

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from vedette import wire
from vedette.maps import OCCUPIED

MOST_BYTES = 1 << 24
MOST_CELLS = 1 << 26
Count = Annotated[int, Meta(ge=0, le=2**53)]
Real = Annotated[float, Meta(ge=-1e9, le=1e9)]
PRINTABLE = r"^[^\x00-\x1f\x7f-\x9f\[\]]*\Z"  # what a terminal shows as it is, markup left out
Word = Annotated[str, Meta(max_length=64, pattern=PRINTABLE)]
Sentence = Annotated[str, Meta(max_length=500, pattern=PRINTABLE)]


class Spread(msgspec.Struct, frozen=True, array_like=True):
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


class Spot(NamedTuple):
    """A frontier that the robot has given up, as ``vedette.domains.mapping.platform.GivenUp``."""

    x: Real  # [m], team frame
    y: Real
    unknown: Count  # cells near it
    visited: bool


class Condition(msgspec.Struct, frozen=True, array_like=True, tag=1):
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
    epoch: Count
    number: Count  # the tree's stamp
    parent: Count | None
    neighbours: Annotated[tuple[Count, ...], Meta(max_length=1024)]  # on the tree
    size: Count  # of the tree
    age: Real  # of the tree, here [s]
    links: Annotated[tuple[LinkReport, ...], Meta(max_length=1024)]
    digest: int  # of its evidence: equal ones mean equal maps
    known: Annotated[float, Meta(ge=0.0, le=1.0)]  # share of the map's cells
    rounds: Count  # ended with a decision
    sweeps: Count
    cuts: Count  # children that did not answer in time
    bounded: Count  # rounds whose value had a bound
    bound_ratios: Real  # value over bound, summed over these
    travelled: Real  # [m]
    collisions: Count
    min_clearance: Real  # [m]
    messages: Annotated[dict[Word, Count], Meta(max_length=16)]  # sent, by kind
    bytes: Annotated[dict[Word, int], Meta(max_length=16)]
    dropped: Annotated[dict[Word, Count], Meta(max_length=16)]  # what failed a check, by where
    refusal: Sentence | None  # why it must start anew to join a team again
    planning_ms: Spread | None  # a round's preparation and answers
    answer_ms: Spread | None  # a negotiation message
    round_ms: Spread | None  # rounds that this robot began, as the root, from end to end
    decided: Real | None = None  # how long ago the latest round ended with a decision, in real time [s]
    given_up: Annotated[tuple[Spot, ...], Meta(max_length=1024)] = ()


class Report(msgspec.Struct, frozen=True, array_like=True, tag=2):
    """A robot's condition and its map."""

    condition: Condition
    rows: Annotated[int, Meta(ge=1, le=MOST_CELLS)]
    cols: Annotated[int, Meta(ge=1, le=MOST_CELLS)]
    classes: Annotated[bytes, Meta(max_length=MOST_BYTES)]  # its map, deflated
    seen: Annotated[bytes, Meta(max_length=MOST_BYTES)]  # bits of what its own sensor observed, deflated
    impact: Annotated[bytes, Meta(max_length=MOST_BYTES)] | None  # of its last decision


_CONDITIONS: msgspec.msgpack.Decoder[Condition] = msgspec.msgpack.Decoder(Condition)
_REPORTS: msgspec.msgpack.Decoder[Report] = msgspec.msgpack.Decoder(Report)
encode = msgspec.msgpack.Encoder().encode


def report(
    condition: Condition, classes: NDArray[np.uint8], seen: NDArray[np.bool_], impact: bytes | None
) -> bytes:
    """Return a report as bytes; ``classes`` and ``seen`` are ``(R, C)``."""
    rows, cols = classes.shape
    packed = zlib.compress(np.ascontiguousarray(classes).tobytes(), 1)
    return encode(
        Report(condition, rows, cols, packed, zlib.compress(np.packbits(seen).tobytes(), 1), impact)
    )


def read_condition(payload: bytes) -> Condition:
    """Return a robot's condition.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_CONDITIONS, payload, "report")


def read_report(payload: bytes) -> Report:
    """Return a robot's report; its grids are still packed.

    Raises:
        ValueError: malformed.
    """
    return wire.decode(_REPORTS, payload, "report")


def classes_of(report: Report) -> NDArray[np.uint8]:
    """Return ``(R, C)``: the map in a report.

    Raises:
        ValueError: not a map of that size.
    """
    classes = np.frombuffer(_inflated(report.classes, _cells(report)), np.uint8)
    if classes.max() > OCCUPIED:
        raise ValueError("report: a cell is neither unknown, free nor occupied")
    return classes.reshape(report.rows, report.cols)


def seen_of(report: Report) -> NDArray[np.bool_]:
    """Return ``(R, C)``: which cells the robot's own sensor has observed.

    Raises:
        ValueError: not of that size.
    """
    cells = _cells(report)
    bits = np.frombuffer(_inflated(report.seen, -(-cells // 8)), np.uint8)
    return np.unpackbits(bits, count=cells).astype(np.bool_).reshape(report.rows, report.cols)


def _cells(report: Report) -> int:
    cells = report.rows * report.cols
    if cells > MOST_CELLS:
        raise ValueError(f"report: a map of {cells} cells; at most {MOST_CELLS} are taken")
    return cells


def _inflated(packed: bytes, size: int) -> bytes:
    """Return exactly so many bytes, and never make more."""
    stream = zlib.decompressobj()
    try:
        plain = stream.decompress(packed, size + 1)
    except zlib.error as error:
        raise ValueError(f"report: a grid is not deflated: {error}") from None
    if len(plain) != size:
        raise ValueError(f"report: a grid holds {len(plain)} bytes or more, not {size}")
    return plain
