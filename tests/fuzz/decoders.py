"""Targets without state: what one message or part of one means, and that it can be told again."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import msgspec
import numpy as np

from tests.fuzz.fingerprint import fingerprint
from tests.fuzz.mutation import mutate_message
from tests.fuzz.target import Broken, Target
from vedette.agent import messages as agent_messages
from vedette.agent import orders
from vedette.domains.mapping.impact import Impact as Misses
from vedette.domains.mapping.impact import MapImpactCodec as MappingCodec
from vedette.domains.search.impact import SearchImpactCodec as SearchCodec
from vedette.domains.tracking.codec import TrackImpactCodec as TrackingCodec
from vedette.domains.tracking.impact import impact_of
from vedette.fusion import contradictions
from vedette.fusion.codec import EvidenceCodec as FusionCodec
from vedette.fusion.contradictions import Accounted, Histories, SignedWord, Twice
from vedette.fusion.gaussian import Information, TrackPacking
from vedette.fusion.gaussian import wire as track_wire
from vedette.fusion.link import Greeting, Payload
from vedette.fusion.packing import CodePacking, WordPacking
from vedette.fusion.seals import Seal
from vedette.fusion.snapshots import Delta, Voucher
from vedette.fusion.steps import SparseIntegers
from vedette.fusion.steps import wire as step_wire
from vedette.fusion.steps.sealed import SealedEntries
from vedette.kernels.tiles import CELLS, Tiling
from vedette.maps import GridFrame
from vedette.negotiation import messages as negotiation_messages
from vedette.negotiation.messages import Down, Gather, RoundOutcome, Stop, Tally, Token, Up
from vedette.net import report
from vedette.net.explore import content as map_content
from vedette.net.gather import status_of
from vedette.overlay import hello, packet
from vedette.sim import shown

Decode = Callable[[bytes], Any]
Encode = Callable[[Any], bytes]
CELLS_PLANNED, LAYERS = 600, 6
TARGETS, HORIZON = 5, 3
TILES = Tiling(50, 70)
FRAME = GridFrame(0.1, 20, 30)
COUNTS = 3
SHOWN = shown.ShownBody(1.0, 2.0, 0.5, 0.3, -0.2, 0.25)
STREAM = 3  # bytes that an entry of step evidence may inflate to, for each of its numbers


def _decoder(name: str, decode: Decode, encode: Encode, values: Callable[[], list[Any]]) -> Target:
    """A target that decodes: what is taken means the same once it is encoded anew."""

    def read(data: bytes) -> None:
        try:
            value = decode(data)
        except ValueError:
            return
        if fingerprint(decode(encode(value))) != fingerprint(value):
            raise Broken(f"{name}: {value} comes back as something else")

    return Target(name, lambda: [encode(value) for value in values()], read, mutate_message)


def _agent_messages() -> list[Any]:
    return [
        agent_messages.Beacon(2, 1, 9, 150, -30, 3141, 5, 20, 50, (10, 0, 20, 5)),
        agent_messages.Beacons((b"one", b"another")),
        agent_messages.Evidence(b"evidence"),
        agent_messages.Call(3),
        agent_messages.Begin(3, 7, 1),
        agent_messages.Flushed(3, 7, 2, ((1, 2, 3),), ((0, 0, 9, 9),)),
        agent_messages.Freeze(3, 7, 12_000, 1 << 60, 4, ((1, 2, 3), (4, 5, 6)), ((0, 0, 9, 9),)),
        agent_messages.Orders((b"one", b"another")),
        agent_messages.Audit(3, 7),
        agent_messages.Account(2, 1, 3, 7, b"impact", ((1, 2, b"sum"),), ((1, bytes(16)),), bytes(64)),
        agent_messages.Vouched(b"beacon", bytes(64), b"certificate"),
        agent_messages.Proof(2, b"certificate", b"proof"),
        agent_messages.Proven((1, 2)),
        agent_messages.Negotiate(3, 7, msgspec.msgpack.encode([4, [1.0, 2.0, 1, True, 0], None])),
    ]


def _orders() -> list[Any]:
    square = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))
    said = [
        orders.Pause(robot=2),
        orders.Resume(),
        orders.Stay(robot=1),
        orders.Recall(to=(1.0, 2.0)),
        orders.LookThere(at=(1.0, 2.0)),
        orders.End(),
        orders.NoGo(area="lab", corners=square),
        orders.Priority(area="lab", corners=square, factor=3.0),
        orders.Remove(area="lab"),
        orders.Exclude(robot=3),
        orders.Reinstate(robot=3),
    ]
    return [orders.Given(k, "operator", each) for k, each in enumerate(said)]


def _hellos() -> list[Any]:
    echo = hello.Echo(12, 40, 900)
    return [
        hello.Hello(12, 1, 0, 1, 3, 12, 0, 0, 1, 0, 0, 5),
        hello.Hello(12, 41, 123_456, 9, 1, 5, 400, 3, 4, 10, -777, 1 << 62, echo),
    ]


def _packets() -> list[Any]:
    return [
        packet.Packet(7, 3),
        packet.Packet(7, 3, 5, 4, (b"one", b"two" * 9)),
    ]


def _misses(codec: MappingCodec | SearchCodec) -> list[Any]:
    rng = np.random.default_rng(1)
    impacts = []
    for size in (0, 3, 200):
        keys = np.sort(rng.choice(CELLS_PLANNED * LAYERS, size, replace=False)).astype(np.uint32)
        impacts.append(Misses(keys, rng.integers(1, 60, size).astype(np.uint8)))
    if isinstance(codec, MappingCodec):
        impacts.append(Misses(*impacts[1].sparse, 1 << 30))
    return [codec.decode(codec.encode(impact)) for impact in impacts]


def _information() -> list[Any]:
    rng = np.random.default_rng(2)
    root = rng.normal(size=(TARGETS, HORIZON, 2, 2))
    full = np.einsum("tkij,tkil->tkjl", root, root)
    blocks = np.stack([full[..., 0, 0], full[..., 0, 1], full[..., 1, 1]], axis=-1)
    return [impact_of(blocks[:0], np.arange(0)), impact_of(blocks[1:3], np.array([1, 4])), impact_of(blocks)]


def _negotiation(codec: MappingCodec) -> list[Any]:
    mu = _misses(codec)[1]
    tally = Tally(3, 1, 12.5, 0.25, 4, 99.0)
    outcome = RoundOutcome(12.5, 13.0, 2, True)
    return [
        Gather(mu, 2, 40.0, 12.0),
        Token(None, tally),
        Token(mu, tally),
        Up(mu, 40.0, 1.0, (0, 1, 3)),
        Down(mu),
        Stop(outcome, 1),
        Stop(outcome),
    ]


def _map_payloads(dtype: type[np.uint8] | type[np.int32]) -> list[Any]:
    rng = np.random.default_rng(3)
    tiles = np.array([0, 2, 5])
    mask = (rng.random((3, CELLS)) < 0.1) & TILES.inside(tiles)
    one = (1 << 20) + 1 if dtype is np.int32 else 1
    values = np.full(int(mask.sum()), one, dtype) if dtype is np.uint8 else np.zeros(int(mask.sum()), dtype)
    delta = Delta(0, 3, tiles, mask, values, np.arange(COUNTS))
    return [
        Payload(77, Greeting(-1, True), {}, []),
        Payload(77, Greeting(12, False), {(1, 77): 3, (2, 90): 1}, [((1, 77), delta)]),
        Payload(77, None, {(1, 77): 3}, []),
    ]


def _map_codec(words: bool) -> FusionCodec:
    return FusionCodec(TILES, COUNTS, WordPacking() if words else CodePacking())


def _step_payloads() -> list[Any]:
    entries = step_wire.Entries(0, 1, step_wire.pack(4, b"body" * 9))
    return [Payload(5, Greeting(-1, True)), Payload(5, None, {(1, 5): 2}, [((1, 5), entries)])]


def _sealed_payloads() -> list[Any]:
    plain = _map_payloads(np.uint8)
    times = np.array([(90, 95), (90, 100), (1, 2)])
    voucher = Voucher(times, b"particulars", b"place", Seal(100, bytes(64)), b"certificate")
    return [
        replace(each, sections=[(key, replace(delta, voucher=voucher)) for key, delta in each.sections])
        for each in plain
    ]


def _sealed_entries() -> list[Any]:
    return [SealedEntries(0, 1, step_wire.pack(4, b"body" * 9), Seal(100, bytes(64)), b"certificate")]


def _unsealed(data: bytes) -> SealedEntries:
    return SealedEntries.unpacked(step_wire.Entries(0, 1, data))


def _contradictions() -> list[Any]:
    one, other = (SignedWord(("evidence", 2, 1, 3, 100, root), bytes(64)) for root in (b"a", b"b"))
    return [Twice(one, other), Histories(one, other, b"entries"), Accounted(b"account")]


def _entries() -> list[Any]:
    return [[(3, b"abc" * 9)], [(0, b""), (7, b"x")]]


def _unpacked(data: bytes) -> list[tuple[int, bytes]]:
    return [(step, element) for step, element, _ in step_wire.unpack(data, STREAM * 100)]


def _packed(entries: list[tuple[int, bytes]]) -> bytes:
    return b"".join(step_wire.pack(step, element) for step, element in entries)


def _vectors(elements: SparseIntegers) -> list[Any]:
    index = np.array([2, 7, 290])
    return [elements.zero(), elements.of(index, np.array([1, -300, 1 << 40]))]


def _tracks() -> list[Any]:
    matrix = np.stack([np.diag([1.0, 2.0, 0.5, 0.25]) + 0.1 * k for k in range(3)])
    return [Information(matrix, np.arange(12.0).reshape(3, 4))]


def conditions() -> list[Any]:
    """A robot's condition as it reports it."""
    link = report.LinkReport(1, "child", 0.25, 0.003, -1.5, None)
    counts = {"negotiation": 12, "beacons": 40}
    place = [0, 3, 40, None, (1, 2), 3, 12.5]
    figures = [
        7,
        9,
        0,
        5,
        4.2,
        31.0,
        0,
        0.4,
        counts,
        counts,
        {"agent": 1},
        (report.Complaint(2, "rounds go on without it"),),
    ]
    return [
        report.Condition(
            0, 99, "robot-1", 20.0, 1.5, "driving", 1.0, 2.0, 0.5, (1.0, 2.0, 1.5, 2.0),
            *place, (link,), 1 << 60, 0.5, *figures,
            report.SpreadReport(7, 30.0, 50.0, 80.0), None, None, 0.5,
            signs=True, out=(2,), alerts=("disk full: 3 MB left for kept",),
        )
    ]  # fmt: skip


def _reports() -> list[bytes]:
    """A map with a strip of free cells, on which another robot's impact lies."""
    classes = np.zeros(FRAME.shape, np.uint8)
    classes[4:9] = 1
    impact = MappingCodec(FRAME.size).encode(Misses(np.arange(3, dtype=np.uint32), np.ones(3, np.uint8)))
    (condition,) = conditions()
    grids = (slice(0, FRAME.rows), slice(0, FRAME.cols)), classes, classes > 0
    return [
        report.encode(report.Report(condition, map_content.content(FRAME, *grids, told)))
        for told in (impact, None)
    ]


def _read_report(data: bytes) -> None:
    """Take a report as the operator does; its grids, deflated, need not be told in the same bytes again."""
    with contextlib.suppress(ValueError):
        told = report.read_report(data)
        status_of(told.condition)
        map_content.view_of(told.condition, told.content, FRAME, MappingCodec(FRAME.size), "robot-1")
    with contextlib.suppress(ValueError):
        map_content.seen_of(map_content.read_content(report.read_report(data).content))


def decoders() -> list[Target]:
    """Return them all."""
    mapping, searching = MappingCodec(CELLS_PLANNED), SearchCodec(CELLS_PLANNED, LAYERS)
    tracking, vectors, packing = TrackingCodec(TARGETS, HORIZON), SparseIntegers(300), TrackPacking(3, 4)
    say = partial(negotiation_messages.encode, codec=mapping)
    hear = partial(negotiation_messages.decode, codec=mapping)
    codes, words = _map_codec(words=False), _map_codec(words=True)
    sealed = replace(codes, sealed=True)
    message = track_wire.TrackMessage(9, -1, 2, 1, 0, 14, b"tracks")
    return [
        _decoder("decode-agent", agent_messages.decode, agent_messages.encode, _agent_messages),
        _decoder("decode-order", orders.decode, orders.encode, _orders),
        _decoder("decode-hello", partial(hello.decode, 3), hello.encode, _hellos),
        _decoder("decode-packet", packet.decode, packet.encode, _packets),
        _decoder("decode-negotiation", hear, say, partial(_negotiation, mapping)),
        _decoder("decode-impact-mapping", mapping.decode, mapping.encode, partial(_misses, mapping)),
        _decoder("decode-impact-search", searching.decode, searching.encode, partial(_misses, searching)),
        _decoder("decode-impact-tracking", tracking.decode, tracking.encode, _information),
        _decoder("decode-map-codes", codes.decode, codes.encode, partial(_map_payloads, np.uint8)),
        _decoder("decode-map-sealed", sealed.decode, sealed.encode, _sealed_payloads),
        _decoder("decode-steps-sealed", _unsealed, lambda told: told.packed().data, _sealed_entries),
        _decoder("decode-proof", contradictions.decode, contradictions.encode, _contradictions),
        _decoder("decode-map-words", words.decode, words.encode, partial(_map_payloads, np.int32)),
        _decoder("decode-steps", step_wire.decode, step_wire.encode, _step_payloads),
        _decoder("decode-entries", _unpacked, _packed, _entries),
        _decoder("decode-vector", vectors.decode, vectors.encode, partial(_vectors, vectors)),
        _decoder("decode-track-message", track_wire.decode, track_wire.encode, lambda: [message]),
        _decoder("decode-tracks", packing.decode, packing.encode, _tracks),
        _decoder("decode-body", shown.decode, shown.encode, lambda: [SHOWN]),
        _decoder("decode-condition", report.read_condition, report.encode, conditions),
        Target("decode-report", _reports, _read_report, mutate_message),
    ]
